// Motion messages: what comes in is checked here once.
#pragma once

#include <waymark/velocity_t.hpp>

#include <string>

namespace waymark {

// False, with *reason (what, value, allowed range), where the time is not
// positive or a speed is not finite or beyond 100 m/s or rad/s. `reason` must
// not be null.
[[nodiscard]] bool CheckVelocity(const velocity_t& message,
                                 std::string* reason);

}  // namespace waymark
