// `waymark-log import`: recordings by others become LCM logs.
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace waymark {

// Declares the command with its options; its callback runs it.
void AddImportCommand(CLI::App* app, int* exit_code);

}  // namespace waymark
