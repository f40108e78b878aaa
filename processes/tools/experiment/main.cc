#include "processes/tools/experiment/corridor_experiment.h"
#include "processes/tools/experiment/drive_experiment.h"
#include "processes/tools/experiment/experiment_tool.h"
#include "processes/tools/experiment/ram_experiment.h"

#include <memory>

int main(int argc, char** argv) {
  using waymark::CorridorExperiment;
  using waymark::DriveExperiment;
  using waymark::RamExperiment;
  return waymark::RunExperimentTool(
      argc,
      argv,
      {{"corridor",
        "The tasks of the corridor system, by its lines",
        [] { return std::make_unique<CorridorExperiment>(); }},
       {"drive",
        "To random goals in a world, without vision",
        [] { return std::make_unique<DriveExperiment>(); }},
       {"ram", "Into whatever there is, through collision_guard", [] {
          return std::make_unique<RamExperiment>();
        }}});
}
