// Motion messages: what comes in is checked here once.
#pragma once

#include "planner/control/velocity_guard.h"

#include <waymark/planar_lidar_t.hpp>
#include <waymark/velocity_t.hpp>

#include <optional>
#include <string>

namespace waymark {

// False, with *reason (what, value, allowed range), where the time is not
// positive or a speed is not finite or beyond 100 m/s or rad/s. `reason` must
// not be null.
[[nodiscard]] bool CheckVelocity(const velocity_t& message,
                                 std::string* reason);

// nullopt, with *reason, where the time is not positive, the angles are not
// finite or go round more than once, or there are more than 100 000 ranges.
// Ranges themselves may be anything.
[[nodiscard]] std::optional<RangeScan> RangeScanFromMessage(
    const planar_lidar_t& message, std::string* reason);

}  // namespace waymark
