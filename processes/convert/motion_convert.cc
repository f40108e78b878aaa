#include "processes/convert/motion_convert.h"

#include "processes/convert/message_check.h"

#include <cmath>

namespace waymark {
namespace {

// No indoor robot; products with times and lengths stay far from overflow.
constexpr double kMaxSpeed = 100.0;
// More than any sensor has, and no burden to check each against every way.
constexpr int kMaxRanges = 100'000;
// Once around, with a few more of the first directions.
constexpr double kMaxSweep = 7.0;  // rad.

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

std::optional<RangeScan> RangeScanFromMessage(const planar_lidar_t& message,
                                              std::string* reason) {
  if (!CheckTime("utime", message.utime, reason)) return std::nullopt;
  if (message.nranges > kMaxRanges) {
    Refuse(reason, "nranges: ", message.nranges, " is above ", kMaxRanges);
    return std::nullopt;
  }
  const double first = message.rad0;
  const double step = message.radstep;
  if (!(std::abs(first) <= kMaxSweep) ||
      !(std::abs(step) * message.nranges <= kMaxSweep)) {
    Refuse(reason,
           "rad0: ",
           first,
           ", radstep: ",
           step,
           " with ",
           message.nranges,
           " ranges go round more than once");
    return std::nullopt;
  }
  return RangeScan{TimeFromMicroseconds(message.utime),
                   first,
                   step,
                   {message.ranges.begin(), message.ranges.end()}};
}

}  // namespace waymark
