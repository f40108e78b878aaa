#include "logs/import/import_command.h"
#include "logs/log_tool/commands.h"
#include "logs/report/evaluation_commands.h"
#include "processes/support/run_tool.h"

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  return waymark::RunTool(
      argc,
      argv,
      "waymark-log",
      "Looks into, mends, cuts and converts LCM logs, by any program.",
      [](CLI::App* app, int* exit_code) {
        app->require_subcommand(1);
        waymark::AddInfoCommand(app, exit_code);
        waymark::AddCheckCommand(app, exit_code);
        waymark::AddRepairCommand(app, exit_code);
        waymark::AddCutCommand(app, exit_code);
        waymark::AddExportCommand(app, exit_code);
        // Commands that live in folders of their own:
        waymark::AddImportCommand(app, exit_code);
        waymark::AddEvaluateCommand(app, exit_code);
        waymark::AddReportCommand(app, exit_code);
      });
}
