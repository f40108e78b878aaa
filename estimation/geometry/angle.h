// The one place where angles are wrapped.
#pragma once

#include <cmath>

namespace waymark {

inline constexpr double kPi = 3.14159265358979323846;

// The equivalent angle in (-pi, pi]. Non-finite input stays non-finite. Exact
// (the input itself) where it already lies inside.
inline double WrapAngle(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  // remainder() returns [-pi, pi]; the convention excludes -pi.
  return wrapped <= -kPi ? kPi : wrapped;
}

constexpr double RadiansFromDegrees(double degrees) {
  return degrees * (kPi / 180.0);
}
constexpr double DegreesFromRadians(double radians) {
  return radians * (180.0 / kPi);
}

}  // namespace waymark
