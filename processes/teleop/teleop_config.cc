#include "processes/teleop/teleop_config.h"

namespace waymark {

void TeleopConfig::Describe(Describer& d) {
  d.Number("max_speed", &max_speed, {0.01, 10.0}, "At full speed, m/s");
  d.Degrees("max_turn_rate_deg",
            &max_turn_rate,
            {1.0, 1000.0},
            "At full speed, per second");
  d.Number("share", &share, {0.1, 1.0}, "Of full speed, at first");
  d.Number("hold_s",
           &hold_s,
           {0.05, 1.0},
           "A key counts for so long; with more than the delay of the "
           "keyboard's repetition (often 0.25 to 0.6 s) the robot does not "
           "pause after the first stroke");
}

}  // namespace waymark
