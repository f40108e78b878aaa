// Every process of this build.
#pragma once

#include "processes/support/process_class.h"

#include <vector>

namespace waymark {

// In the order in which the build declares them. Generated from the calls of
// waymark_add_process: folder x_y holds x_y_process.h with class XYProcess.
[[nodiscard]] std::vector<ProcessClass> KnownProcesses();

}  // namespace waymark
