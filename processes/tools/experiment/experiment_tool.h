// waymark-experiment: closed loops over many seeds, counted.
#pragma once

#include "processes/tools/experiment/experiment.h"

#include <functional>
#include <memory>
#include <vector>

namespace waymark {

struct ExperimentClass {
  std::string name;
  std::string help;  // One line.
  std::function<std::unique_ptr<Experiment>()> make;
};

// The whole tool; returns the exit code.
//
//   waymark-experiment NAME [--seeds N] [--jobs N] [--out DIR]
//                      [--config FILE] [--set key=value] [--json FILE]
//
// Results are in DIR: runs.jsonl, report.json, and the logs of the worst runs.
// Called again it runs what is missing.
[[nodiscard]] int RunExperimentTool(
    int argc, char** argv, const std::vector<ExperimentClass>& experiments);

}  // namespace waymark
