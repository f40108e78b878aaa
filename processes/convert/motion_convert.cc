#include "processes/convert/motion_convert.h"

#include "processes/convert/message_check.h"

#include <cmath>

namespace waymark {
namespace {

// No indoor robot; products with times and lengths stay far from overflow.
constexpr double kMaxSpeed = 100.0;

bool CheckSpeed(const char* key, double value, std::string* reason) {
  return std::abs(value) <= kMaxSpeed ||
         Refuse(reason, key, ": ", value, " must be within +-", kMaxSpeed);
}

}  // namespace

bool CheckVelocity(const velocity_t& message, std::string* reason) {
  return CheckTime("utime", message.utime, reason) &&
         CheckSpeed("forward", message.forward, reason) &&
         CheckSpeed("turn_rate", message.turn_rate, reason);
}

}  // namespace waymark
