#include "processes/convert/task_convert.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/message_check.h"

#include <array>
#include <cmath>
#include <string_view>

namespace waymark {
namespace {

// As for poses: farther than a quarter of the earth.
constexpr double kMaxCoordinate = 1e7;
constexpr double kMaxSpeed = 100.0;
constexpr std::int32_t kMaxWaypoints = 10'000;

bool CheckNumber(const char* key,
                 double value,
                 double max,
                 std::string* reason) {
  return std::abs(value) <= max ||
         Refuse(reason, key, ": ", value, " must be within +-", max);
}

bool CheckKind(const std::string& kind, std::string* reason) {
  constexpr std::array<std::string_view, 3> kKinds{"waypoints", "tour", "none"};
  for (const std::string_view known : kKinds) {
    if (kind == known) return true;
  }
  return Refuse(reason, "kind: '", kind, "' is none of waypoints, tour, none");
}

bool CheckPose(double x, double y, double heading, std::string* reason) {
  return CheckNumber("x", x, kMaxCoordinate, reason) &&
         CheckNumber("y", y, kMaxCoordinate, reason) &&
         CheckNumber("heading", heading, kMaxCoordinate, reason);
}

}  // namespace

std::optional<Task> TaskFromMessage(const task_t& message,
                                    std::string* reason) {
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckKind(message.kind, reason)) {
    return std::nullopt;
  }
  Task task;
  task.time = TimeFromMicroseconds(message.utime);
  task.source = message.source;
  task.kind = message.kind;
  if (task.kind == "none") return task;
  if (message.max_speed < 0.0) {
    Refuse(reason, "max_speed: ", message.max_speed, " is below 0");
    return std::nullopt;
  }
  if (!CheckNumber("max_speed", message.max_speed, kMaxSpeed, reason)) {
    return std::nullopt;
  }
  task.max_speed = message.max_speed;
  if (message.num_waypoints < 1 || message.num_waypoints > kMaxWaypoints) {
    Refuse(reason,
           "num_waypoints: ",
           message.num_waypoints,
           " is not in 1 to ",
           kMaxWaypoints);
    return std::nullopt;
  }
  for (const waypoint_t& w : message.waypoints) {
    const double heading = w.has_heading != 0 ? w.heading : 0.0;
    if (!CheckPose(w.x, w.y, heading, reason)) return std::nullopt;
    Waypoint waypoint{{w.x, w.y}, {}};
    if (w.has_heading != 0) waypoint.heading = WrapAngle(heading);
    task.waypoints.push_back(waypoint);
  }
  return task;
}

task_t ToMessage(const Task& task, std::int64_t seq) {
  task_t message;
  message.utime = Microseconds(task.time);
  message.seq = static_cast<std::int32_t>(seq);
  message.source = task.source;
  message.kind = task.kind;
  message.max_speed = task.max_speed;
  for (const Waypoint& waypoint : task.waypoints) {
    waypoint_t w;
    w.x = waypoint.p_W.x();
    w.y = waypoint.p_W.y();
    w.has_heading = waypoint.heading ? 1 : 0;
    w.heading = waypoint.heading.value_or(0.0);
    message.waypoints.push_back(w);
  }
  message.num_waypoints = static_cast<std::int32_t>(message.waypoints.size());
  return message;
}

task_status_t ToMessage(const TrackReport& report,
                        Time time,
                        std::int64_t seq) {
  task_status_t message;
  message.utime = Microseconds(time);
  message.seq = static_cast<std::int32_t>(seq);
  message.state = NameOf(report.state);
  message.reason = report.reason;
  message.num_reached = report.num_reached;
  message.num_waypoints = report.num_waypoints;
  message.distance_left = report.distance_left;
  return message;
}

std::optional<Pose2> PoseFromMessage(const pose_t& message,
                                     std::string* reason) {
  const auto& [x, y, heading] = message.pose_W;
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckPose(x, y, heading, reason)) {
    return std::nullopt;
  }
  return Pose2{x, y, WrapAngle(heading)};
}

std::optional<Pose2> PoseFromMessage(const truth_t& message,
                                     std::string* reason) {
  const auto& [sensor_x, sensor_y, sensor_heading] = message.sensor_R;
  if (!CheckTime("utime", message.utime, reason) ||
      !CheckPose(message.x, message.y, message.heading, reason) ||
      !CheckPose(sensor_x, sensor_y, sensor_heading, reason)) {
    return std::nullopt;
  }
  // The heading is the robot's, the place that of the sensor on it.
  const Pose2 at_sensor{message.x, message.y, WrapAngle(message.heading)};
  const Eigen::Vector2d p_WR =
      at_sensor * Eigen::Vector2d(-sensor_x, -sensor_y);
  return Pose2{p_WR.x(), p_WR.y(), at_sensor.heading};
}

}  // namespace waymark
