// The commands of waymark-log that score estimates against a reference.
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace waymark {

// Each declares its command and options; its callback runs it.
void AddEvaluateCommand(CLI::App* app, int* exit_code);
void AddReportCommand(CLI::App* app, int* exit_code);

}  // namespace waymark
