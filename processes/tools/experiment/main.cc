#include "processes/tools/experiment/drive_experiment.h"
#include "processes/tools/experiment/experiment_tool.h"
#include "processes/tools/experiment/ram_experiment.h"

#include <memory>

int main(int argc, char** argv) {
  using waymark::DriveExperiment;
  using waymark::RamExperiment;
  return waymark::RunExperimentTool(
      argc,
      argv,
      {{"drive",
        "To random goals in a world, without vision",
        [] { return std::make_unique<DriveExperiment>(); }},
       {"ram", "Into whatever there is, through collision_guard", [] {
          return std::make_unique<RamExperiment>();
        }}});
}
