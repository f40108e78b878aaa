// Configuration of teleop.
#pragma once

#include "estimation/geometry/angle.h"
#include "processes/support/describer.h"

namespace waymark {

struct TeleopConfig {
  double max_speed = 0.4;                           // m/s.
  double max_turn_rate = RadiansFromDegrees(60.0);  // rad/s.
  double share = 0.5;                               // Of both, at first.
  double first_hold_s = 0.6;
  double hold_s = 0.25;

  void Describe(Describer& d);
};

}  // namespace waymark
