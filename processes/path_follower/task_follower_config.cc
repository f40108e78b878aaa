#include "processes/path_follower/task_follower_config.h"

namespace waymark {

void TaskFollowerConfig::Describe(Describer& d) {
  d.Number("max_speed",
           &tracker.max_speed,
           {0.05, 10.0},
           "m/s; a task may ask for less");
  d.Degrees(
      "max_turn_rate_deg", &tracker.max_turn_rate, {5.0, 1000.0}, "Per second");
  d.Number("acceleration",
           &tracker.acceleration,
           {0.01, 10.0},
           "Also before corners and the goal, m/s^2");
  d.Degrees("turn_acceleration_deg",
            &tracker.turn_acceleration,
            {1.0, 1e4},
            "On the spot, per s^2");
  d.Number("lookahead",
           &tracker.lookahead,
           {0.1, 5.0},
           "It heads for the point this far ahead on the way, m");
  d.Degrees("max_corner_deg",
            &tracker.max_corner,
            {1.0, 90.0},
            "It stops and turns on the spot at corners sharper than this");
  d.Degrees("align_above_deg",
            &tracker.align_above,
            {1.0, 179.0},
            "While driving, it stops and turns where it is aligned worse");
  d.Degrees("align_start_deg",
            &tracker.align_start,
            {1.0, 179.0},
            "The same before it starts");
  d.Degrees("align_done_deg",
            &tracker.align_done,
            {0.5, 90.0},
            "It drives on where it is aligned better");
  d.Number("position_tolerance",
           &tracker.position_tolerance,
           {0.03, 5.0},
           "Of every way-point, m");
  d.Degrees("heading_tolerance_deg",
            &tracker.heading_tolerance,
            {0.5, 90.0},
            "Where a way-point has a heading");
  d.Number("wait_after_s",
           &tracker.wait_after_s,
           {0.5, 3600.0},
           "Without progress for so long it says 'waiting'");
  d.Number("pose_timeout_s",
           &pose_timeout_s,
           {0.05, 60.0},
           "Without a pose for so long it stands");
  d.Text("task_file",
         &task_file,
         "Keeps the task over a restart; empty: it does not");
  d.Number("resume_within_s",
           &resume_within_s,
           {0.0, 1e6},
           "A task older than this, by the poses, is not taken up again");
}

void TaskFollowerConfig::Check() const {
  tracker.Check();
}

}  // namespace waymark
