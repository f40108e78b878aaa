// waymark-replay: several processes on one recorded log, offline.
#pragma once

#include "processes/support/process_class.h"

#include <vector>

namespace waymark {

// The whole tool, for the processes in `known`; returns the exit code.
//
//   waymark-replay --process pose_filter=mine.yaml --process batch_refiner
//                  --set pose_filter.window_s=1 IN OUT
//
// Processes handle each event in the order in which they are named. Without
// "=FILE" a process takes the configuration that is shipped with it.
[[nodiscard]] int RunReplayTool(const std::vector<ProcessClass>& known,
                                int argc,
                                char** argv);

}  // namespace waymark
