// What a log says of where the robot was, for a plan.
#pragma once

#include "processes/tools/world/plan_drawing.h"

#include <string>
#include <vector>

namespace waymark {

// Driven (TRUTH), dead reckoning (ODOMETRY) and believed (POSE). Lost or
// unknown poses make no gap. ODOMETRY knows only how it moved since its first
// message: it begins where the robot was then, by TRUTH or else by POSE. Throws
// InputError where the log cannot be read, or has neither of these.
[[nodiscard]] std::vector<PlanPath> PathsOf(const std::string& log);

}  // namespace waymark
