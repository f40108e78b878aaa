#include "processes/convert/corridor_convert.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/message_check.h"
#include "processes/convert/odometry_convert.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

constexpr std::size_t kMaxLines = 500;

std::vector<corridor_line_t> MessagesOfLines(
    const std::vector<CorridorLine>& lines) {
  std::vector<CorridorLine> sent = lines;
  std::stable_partition(sent.begin(), sent.end(), [](const CorridorLine& l) {
    return l.edge != CorridorEdge::kNone;
  });
  sent.resize(std::min(sent.size(), kMaxLines));
  std::vector<corridor_line_t> messages;
  messages.reserve(sent.size());
  for (const CorridorLine& l : sent) {
    corridor_line_t message;
    message.ax = static_cast<float>(l.line.a.x());
    message.ay = static_cast<float>(l.line.a.y());
    message.bx = static_cast<float>(l.line.b.x());
    message.by = static_cast<float>(l.line.b.y());
    message.edge = static_cast<std::int8_t>(l.edge);
    message.is_used = l.is_used ? 1 : 0;
    messages.push_back(message);
  }
  return messages;
}

Pose2 PoseFrom(const double (&v)[3]) {
  return {v[0], v[1], WrapAngle(v[2])};
}

void CopyPose(const Pose2& X, double (&v)[3]) {
  v[0] = X.x;
  v[1] = X.y;
  v[2] = X.heading;
}

void SetCorridor(const std::optional<CorridorGeometry>& corridor,
                 corridor_pose_t* message) {
  // Without one: an unnamed one of no size in the origin.
  CorridorGeometry sent;
  sent.name.clear();
  if (corridor) sent = *corridor;
  message->corridor = sent.name;
  CopyPose(sent.X_WL, message->corridor_W);
  message->width = sent.width.value_or(0.0);
  message->height = sent.height.value_or(0.0);
  message->skirting_height = sent.skirting_height.value_or(0.0);
  message->skirting_depth = sent.skirting_depth;
}

std::optional<double> LengthFrom(double value) {
  return value == 0.0 ? std::nullopt : std::optional(value);
}

bool CorridorFrom(const corridor_pose_t& message,
                  std::optional<CorridorGeometry>* corridor,
                  std::string* reason) {
  if (message.corridor.empty()) return true;
  for (const double value : message.corridor_W) {
    if (!std::isfinite(value)) {
      return Refuse(reason, "corridor_W: ", value, " must be finite");
    }
  }
  CorridorGeometry geometry;
  geometry.name = message.corridor;
  geometry.X_WL = PoseFrom(message.corridor_W);
  geometry.width = LengthFrom(message.width);
  geometry.height = LengthFrom(message.height);
  geometry.skirting_height = LengthFrom(message.skirting_height);
  geometry.skirting_depth = message.skirting_depth;
  try {
    geometry.Check();
  } catch (const std::invalid_argument& error) {
    Refuse(reason, error.what());
    return false;
  }
  *corridor = geometry;
  return true;
}

// The robot's pose in L, without its x.
position_fix_t FixOfRobot(const corridor_pose_t& message) {
  position_fix_t fix;
  fix.utime = message.utime;
  fix.seq = message.seq;
  fix.source = "corridor " + message.source;
  fix.has_x = 0;
  fix.has_y = message.has_y;
  fix.has_heading = message.has_heading;
  fix.x = 0.0;
  fix.y = message.y_L;
  fix.heading = message.heading_L;
  std::fill(std::begin(fix.covariance), std::end(fix.covariance), 0.0);
  fix.covariance[4] = message.covariance[0];
  fix.covariance[5] = message.covariance[1];
  fix.covariance[7] = message.covariance[2];
  fix.covariance[8] = message.covariance[3];
  std::copy(std::begin(message.corridor_W),
            std::end(message.corridor_W),
            std::begin(fix.frame_W));
  std::copy(std::begin(message.sensor_R),
            std::end(message.sensor_R),
            std::begin(fix.sensor_R));
  return fix;
}

// The same of the sensor: X_LS = X_LR * X_RS.
void MoveToSensor(AbsoluteFix* fix) {
  const Pose2 X_LR = Pose2::FromVector(fix->value);
  // Its y and heading, and their derivatives, do not depend on X_LR's x.
  const Pose2 X_LS = X_LR * fix->X_RS;
  const Eigen::Matrix3d J = JacobiansOfCompose(X_LR, fix->X_RS).d_AB;
  fix->covariance = (J * fix->covariance * J.transpose()).eval();
  fix->value = X_LS.vector();
  for (int i = 0; i < 3; ++i) {
    if (fix->has[static_cast<std::size_t>(i)]) continue;
    fix->value(i) = 0.0;
    fix->covariance.row(i).setZero();
    fix->covariance.col(i).setZero();
  }
}

}  // namespace

corridor_pose_t ToMessage(const CorridorAnswer& answer) {
  const CorridorEstimate& estimate = answer.estimate;
  corridor_pose_t message;
  message.utime = Microseconds(answer.time);
  message.seq = static_cast<std::int32_t>(answer.seq);
  message.source = answer.source;
  message.status = NameOf(estimate.status);
  message.reason = estimate.reason;
  message.has_heading = estimate.heading ? 1 : 0;
  message.has_y = estimate.y ? 1 : 0;
  message.y_L = estimate.y.value_or(0.0);
  message.heading_L = estimate.heading.value_or(0.0);
  for (int i = 0; i < 4; ++i) {
    message.covariance[i] = estimate.covariance(i / 2, i % 2);
  }
  message.p_regular = estimate.p_regular;
  SetCorridor(answer.corridor, &message);
  message.lines_us = static_cast<std::int32_t>(answer.lines_took.count());
  message.pose_us = static_cast<std::int32_t>(answer.pose_took.count());
  CopyPose(answer.X_RS, message.sensor_R);
  message.has_vanishing_point = estimate.vanishing_point ? 1 : 0;
  const Eigen::Vector2d point =
      estimate.vanishing_point.value_or(Eigen::Vector2d::Zero());
  message.vanishing_point[0] = point.x();
  message.vanishing_point[1] = point.y();
  message.lines = MessagesOfLines(estimate.lines);
  message.num_lines = static_cast<std::int32_t>(message.lines.size());
  return message;
}

std::optional<AbsoluteFix> CorridorFixFromMessage(
    const corridor_pose_t& message, std::string* reason) {
  const position_fix_t robot = FixOfRobot(message);
  if (message.has_heading == 0) {
    if (message.has_y != 0) {
      Refuse(reason, "has_y: must not be true without has_heading");
      return std::nullopt;
    }
    if (!CheckTime("utime", message.utime, reason)) return std::nullopt;
    AbsoluteFix none;
    none.time = TimeFromMicroseconds(message.utime);
    none.seq = message.seq;
    none.source = robot.source;
    return none;
  }
  std::optional<AbsoluteFix> fix = AbsoluteFixFromMessage(robot, reason);
  if (fix) MoveToSensor(&*fix);
  return fix;
}

std::optional<CorridorAnswer> CorridorAnswerFromMessage(
    const corridor_pose_t& message, std::string* reason) {
  if (!CorridorFixFromMessage(message, reason)) return std::nullopt;
  CorridorAnswer answer;
  answer.time = TimeFromMicroseconds(message.utime);
  answer.seq = message.seq;
  answer.source = message.source;
  if (!CorridorFrom(message, &answer.corridor, reason)) return std::nullopt;
  answer.lines_took = std::chrono::microseconds(message.lines_us);
  answer.pose_took = std::chrono::microseconds(message.pose_us);
  for (const double value : message.covariance) {
    if (std::isfinite(value)) continue;
    Refuse(reason, "covariance: must be finite");
    return std::nullopt;
  }
  for (const double value : message.sensor_R) {
    if (std::isfinite(value)) continue;
    Refuse(reason, "sensor_R: must be finite");
    return std::nullopt;
  }
  answer.X_RS = PoseFrom(message.sensor_R);
  CorridorEstimate& estimate = answer.estimate;
  const auto status = CorridorStatusFromName(message.status);
  if (!status) {
    Refuse(reason, "status: ", message.status, " is none");
    return std::nullopt;
  }
  estimate.status = *status;
  estimate.reason = message.reason;
  if (message.has_heading != 0) {
    estimate.heading = WrapAngle(message.heading_L);
  }
  if (message.has_y != 0) estimate.y = message.y_L;
  for (int i = 0; i < 4; ++i) {
    estimate.covariance(i / 2, i % 2) = message.covariance[i];
  }
  if (!(message.p_regular >= 0.0 && message.p_regular <= 1.0)) {
    Refuse(reason, "p_regular: must be in [0, 1]");
    return std::nullopt;
  }
  estimate.p_regular = message.p_regular;
  if (message.has_vanishing_point != 0) {
    estimate.vanishing_point =
        Eigen::Vector2d(message.vanishing_point[0], message.vanishing_point[1]);
    // Farther than that is no pixel that anybody draws.
    if (!(std::abs(message.vanishing_point[0]) < 1e9 &&
          std::abs(message.vanishing_point[1]) < 1e9)) {
      Refuse(reason, "vanishing_point: must be finite, below 1e9 px");
      return std::nullopt;
    }
  }
  for (const corridor_line_t& sent : message.lines) {
    CorridorLine line;
    line.line.a = {sent.ax, sent.ay};
    line.line.b = {sent.bx, sent.by};
    if (!line.line.a.allFinite() || !line.line.b.allFinite() || sent.edge < 0 ||
        sent.edge > static_cast<int>(CorridorEdge::kAlong)) {
      Refuse(reason, "lines: ends must be finite, edge in 0 to 7");
      return std::nullopt;
    }
    line.edge = static_cast<CorridorEdge>(sent.edge);
    line.is_used = sent.is_used != 0;
    estimate.lines.push_back(line);
  }
  return answer;
}

}  // namespace waymark
