#include "processes/collision_guard/collision_guard_config.h"

namespace waymark {

void CollisionGuardConfig::Describe(Describer& d) {
  d.Number("radius", &guard.radius, {0.01, 5.0}, "Of the round robot, m");
  d.Number("margin", &guard.margin, {0.0, 5.0}, "Kept free around it, m");
  d.Number("margin_time_s",
           &guard.margin_time,
           {0.0, 5.0},
           "And so much more per speed, m per m/s");
  d.Number("max_speed", &guard.max_speed, {0.01, 10.0}, "m/s");
  d.Degrees(
      "max_turn_rate_deg", &guard.max_turn_rate, {1.0, 1000.0}, "Per second");
  d.Number("request_timeout_s",
           &request_timeout_s,
           {0.05, 10.0},
           "A MOTION_REQUEST that is not renewed counts for so long");
  d.Text("preferred_source",
         &preferred_source,
         "Whose requests to move come before all others'");
  d.Text("stop_file",
         &stop_file,
         "Keeps STOP over a restart; empty: it does not. A broken file is a "
         "stop");
  d.Number("contact_hold_s",
           &guard.contact_hold_s,
           {0.0, 60.0},
           "Only backwards so long after a bumper was pressed");
  d.Group(
      "base", [&] { DescribeBase(d); }, "How the robot follows commands");
  d.Group(
      "ranges", [&] { DescribeRanges(d); }, "What it sees of obstacles");
}

void CollisionGuardConfig::DescribeBase(Describer& d) {
  DriveRates& rates = guard.rates;
  d.Number(
      "acceleration", &rates.acceleration, {0.01, 100.0}, "At most, m/s^2");
  d.Number("braking", &rates.braking, {0.01, 100.0}, "At least, m/s^2");
  d.Degrees("turn_acceleration_deg",
            &rates.turn_acceleration,
            {1.0, 1e5},
            "At most, per s^2");
  d.Degrees(
      "turn_braking_deg", &rates.turn_braking, {1.0, 1e5}, "At least, per s^2");
  d.Number("max_latency_s",
           &guard.max_latency_s,
           {0.0, 2.0},
           "From an input's time stamp until the wheels obey, at most");
}

void CollisionGuardConfig::DescribeRanges(Describer& d) {
  d.Choice("use",
           &guard.ranges,
           {{"required", RangeUse::kRequired}, {"none", RangeUse::kNone}},
           "required: without new RANGES nothing moves; none: the robot has no "
           "such sensor");
  d.Number("x", &guard.X_RS.x, {-10.0, 10.0}, "Where the sensor is on R, m");
  d.Number("y", &guard.X_RS.y, {-10.0, 10.0}, "m");
  d.Degrees("yaw_deg",
            &guard.X_RS.heading,
            {-360.0, 360.0},
            "Direction of its angle 0");
  d.Number("min_range",
           &guard.min_range,
           {0.0, 10.0},
           "What is not above it is no measurement, m");
  d.Degrees("beam_width_deg",
            &guard.beam_width,
            {0.0, 90.0},
            "An echo may come from anywhere in it; at least what beams are "
            "apart");
  d.Number("max_age_s",
           &guard.max_range_age,
           {0.05, 10.0},
           "RANGES count for so long");
  d.Number("unseen_speed",
           &guard.unseen_speed,
           {0.0, 10.0},
           "At most, to where no range looks, m/s");
  // A command is looked at again by the timer, or by the next request.
}

void CollisionGuardConfig::Check() const {
  guard.Check();
}

}  // namespace waymark
