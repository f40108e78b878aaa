// The commands of waymark-log that look at a log as it is.
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace waymark {

// Each declares its command and options; its callback runs it.
void AddInfoCommand(CLI::App* app, int* exit_code);
void AddCheckCommand(CLI::App* app, int* exit_code);
void AddRepairCommand(CLI::App* app, int* exit_code);
void AddCutCommand(CLI::App* app, int* exit_code);
void AddExportCommand(CLI::App* app, int* exit_code);

}  // namespace waymark
