// Tasks and their states to values and back. What comes in is checked here
// once.
#pragma once

#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"
#include "planner/control/path_tracker.h"

#include <waymark/pose_t.hpp>
#include <waymark/task_status_t.hpp>
#include <waymark/task_t.hpp>
#include <waymark/truth_t.hpp>

#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct Task {
  Time time;
  std::string source;
  std::string kind;
  double max_speed = 0.0;  // m/s; 0: the follower's own.
  std::vector<Waypoint> waypoints;
};

// Each returns nullopt and sets *reason (what, value, allowed range) where the
// content cannot be used. `reason` must not be null.

// The kind is one of task_t's; where it is "none" nothing else is taken. Else
// there are 1 to 10 000 way-points within 10 000 km, and a speed from 0 to 100.
[[nodiscard]] std::optional<Task> TaskFromMessage(const task_t& message,
                                                  std::string* reason);
[[nodiscard]] task_t ToMessage(const Task& task, std::int64_t seq);

[[nodiscard]] task_status_t ToMessage(const TrackReport& report,
                                      Time time,
                                      std::int64_t seq);

// Of messages that are_known, and of those with a heading.
[[nodiscard]] std::optional<Pose2> PoseFromMessage(const pose_t& message,
                                                   std::string* reason);
[[nodiscard]] std::optional<Pose2> PoseFromMessage(const truth_t& message,
                                                   std::string* reason);

}  // namespace waymark
