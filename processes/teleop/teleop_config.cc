#include "processes/teleop/teleop_config.h"

namespace waymark {

void TeleopConfig::Describe(Describer& d) {
  d.Number("max_speed", &max_speed, {0.01, 10.0}, "At full speed, m/s");
  d.Degrees("max_turn_rate_deg",
            &max_turn_rate,
            {1.0, 1000.0},
            "At full speed, per second");
  d.Number("share", &share, {0.1, 1.0}, "Of full speed, at first");
  d.Number("first_hold_s",
           &first_hold_s,
           {0.05, 1.0},
           "The first stroke of a key counts for so long: longer than the "
           "keyboard waits before it repeats (often 0.25 to 0.6 s), or the "
           "robot pauses there");
  d.Number("hold_s",
           &hold_s,
           {0.05, 1.0},
           "A stroke that comes at most so long after one of the same key is "
           "its repetition, and counts for so long: who lets go stops the "
           "robot after it");
}

}  // namespace waymark
