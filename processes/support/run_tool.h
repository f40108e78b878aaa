// The frame of every command-line tool: help, one line per error, exit codes.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace waymark {

// Lets `add` declare options, commands and their callbacks, then parses and
// runs. A callback sets *exit_code where success (0) does not fit.
//
// Returns 0 on success and for --help; 2 after one line on stderr where flags
// or input are bad (InputError); 1 where anything else throws.
int RunTool(int argc,
            char** argv,
            const std::string& name,
            const std::string& description,
            const std::function<void(CLI::App* app, int* exit_code)>& add);

// The option takes numbers from `min` to `max` only. CLI::Range takes NaN too.
CLI::Option* RequireRange(CLI::Option* option, double min, double max);

}  // namespace waymark
