#include "planner/control/path_tracker.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace waymark {
namespace {

// Proportional ends of the profiles, 1/s: with the half second that poses and
// wheels may be late they do not overshoot.
constexpr double kSlowGain = 1.5;
constexpr double kTurnGain = 2.0;
// Slower than this, wheels may not turn at all.
constexpr double kCreep = 0.03;      // m/s.
constexpr double kCreepTurn = 0.06;  // rad/s.
// The end of a leg is reached: well within any tolerance of a way-point.
constexpr double kEndOfLeg = 0.02;  // m.
// How far the place on the way may be off from one pose to the next, m: more
// than a correction of the pose, less than to another branch of the way.
constexpr double kBack = 0.5;
constexpr double kAhead = 1.0;
constexpr int kMaxRetries = 3;
// Progress: so much nearer, where a rad counts like kMetersPerRad.
constexpr double kProgress = 0.02;
constexpr double kMetersPerRad = 0.3;
// Turned around, left is as good as right: it keeps to one.
constexpr double kAround = 2.6;  // rad.
constexpr double kLongestStepS = 1.0;

double BearingTo(const Pose2& X_WR, const Eigen::Vector2d& p_W) {
  return WrapAngle(std::atan2(p_W.y() - X_WR.y, p_W.x() - X_WR.x) -
                   X_WR.heading);
}

}  // namespace

const char* NameOf(TrackState state) {
  switch (state) {
    case TrackState::kIdle:
      return "idle";
    case TrackState::kDriving:
      return "driving";
    case TrackState::kWaiting:
      return "waiting";
    case TrackState::kDone:
      return "done";
    case TrackState::kFailed:
      return "failed";
  }
  return "";
}

void PathTrackerOptions::Check() const {
  const auto check = [](const char* field, double value) {
    if (std::isfinite(value) && value > 0.0) return;
    throw std::invalid_argument(std::string(field) + " = " +
                                std::to_string(value) + " is not above 0");
  };
  check("max_speed", max_speed);
  check("max_turn_rate", max_turn_rate);
  check("acceleration", acceleration);
  check("turn_acceleration", turn_acceleration);
  check("lookahead", lookahead);
  check("max_corner", max_corner);
  check("align_above", align_above);
  check("align_start", align_start);
  check("align_done", align_done);
  check("position_tolerance", position_tolerance);
  check("heading_tolerance", heading_tolerance);
  check("wait_after_s", wait_after_s);
  if (align_done > align_start || align_start > align_above) {
    throw std::invalid_argument(
        "align_done, align_start, align_above must not decrease");
  }
  if (position_tolerance <= kEndOfLeg) {
    throw std::invalid_argument(
        "position_tolerance = " + std::to_string(position_tolerance) +
        " is not above 0.02");
  }
}

PathTracker::PathTracker(const PathTrackerOptions& options)
    : options_(options) {
  options_.Check();
}

void PathTracker::Start(const std::vector<Waypoint>& path,
                        double max_speed,
                        int num_reached) {
  Clear();
  path_ = path;
  max_speed_ = max_speed > 0.0 ? std::min(max_speed, options_.max_speed)
                               : options_.max_speed;
  num_reached_ = std::clamp(num_reached, 0, static_cast<int>(path.size()));
  state_ = TrackState::kDriving;
}

void PathTracker::Clear() {
  path_.clear();
  legs_.clear();
  has_legs_ = false;
  num_retries_ = 0;
  num_reached_ = 0;
  reason_.clear();
  state_ = TrackState::kIdle;
  s_ = offset_ = 0.0;
  mark_time_.reset();
}

void PathTracker::MakeLegs(const Eigen::Vector2d& p_WR) {
  has_legs_ = true;
  std::vector<Eigen::Vector2d> points{p_WR};
  std::vector<int> num_reached{num_reached_};
  const auto cut = [&](std::optional<double> heading) {
    legs_.push_back({Polyline(points), num_reached, heading});
    points = {points.back()};
    num_reached = {num_reached.back()};
  };
  for (int i = num_reached_; i < static_cast<int>(path_.size()); ++i) {
    const Waypoint& waypoint = path_[static_cast<std::size_t>(i)];
    const Eigen::Vector2d way = waypoint.p_W - points.back();
    if (way.norm() > kEndOfLeg) {
      if (points.size() > 1) {
        const Eigen::Vector2d before =
            points.back() - points[points.size() - 2];
        const double corner = WrapAngle(std::atan2(way.y(), way.x()) -
                                        std::atan2(before.y(), before.x()));
        if (std::abs(corner) > options_.max_corner) cut(std::nullopt);
      }
      points.push_back(waypoint.p_W);
      num_reached.push_back(i + 1);
    } else {
      num_reached.back() = i + 1;  // As good as the same place.
    }
    const bool is_last = i + 1 == static_cast<int>(path_.size());
    if (waypoint.heading || is_last) cut(waypoint.heading);
  }
  StartLeg();
}

void PathTracker::StartLeg() {
  s_ = offset_ = error_ = 0.0;
  turn_sign_ = 0.0;
  phase_ = Phase::kDrive;
  mark_time_.reset();
}

// At the end of the leg, standing or nearly so.
void PathTracker::FinishLeg(const Pose2& X_WR) {
  const Leg& leg = legs_.front();
  if (phase_ != Phase::kTurn) {
    const Eigen::Vector2d end = leg.line.points().back();
    const double miss = (end - X_WR.position()).norm();
    if (miss > options_.position_tolerance) {
      if (num_retries_++ < kMaxRetries) {
        legs_.front() = {Polyline({X_WR.position(), end}),
                         {num_reached_, leg.num_reached.back()},
                         leg.heading};
        StartLeg();
        return;
      }
      std::array<char, 96> text{};
      std::snprintf(text.data(),
                    text.size(),
                    "way-point %d missed by %.2f m",
                    leg.num_reached.back(),
                    miss);
      reason_ = text.data();
      state_ = TrackState::kFailed;
      return;
    }
    if (leg.heading) {
      phase_ = Phase::kTurn;
      turn_sign_ = 0.0;
      mark_time_.reset();
      return;
    }
  }
  num_reached_ = leg.num_reached.back();
  num_retries_ = 0;
  legs_.erase(legs_.begin());
  StartLeg();
  if (legs_.empty()) state_ = TrackState::kDone;
}

TrackReport PathTracker::Update(Time time, const Pose2& X_WR) {
  WAYMARK_CHECK(X_WR.vector().allFinite(), X_WR.vector().transpose());
  double dt = time_ ? Seconds(time - *time_) : 0.0;
  if (dt < 0.0 || dt > kLongestStepS) {
    dt = 0.0;
    last_ = {};
    mark_time_.reset();
  }
  time_ = time;
  Velocity velocity;
  if (is_active()) {
    if (!has_legs_) MakeLegs(X_WR.position());
    if (legs_.empty()) state_ = TrackState::kDone;
  }
  if (is_active()) velocity = Drive(X_WR, dt);
  if (is_active()) {
    NoteProgress(time);
  } else {
    velocity = {};
  }
  last_ = velocity;
  return Report(velocity);
}

TrackReport PathTracker::Hold(std::optional<Time> time,
                              const std::string& reason) {
  time_ = time;
  last_ = {};
  mark_time_.reset();
  TrackReport report = Report({});
  if (is_active()) {
    report.state = TrackState::kWaiting;
    report.reason = reason;
  }
  return report;
}

Velocity PathTracker::Drive(const Pose2& X_WR, double dt) {
  const Leg& leg = legs_.front();
  if (phase_ == Phase::kTurn) {
    error_ = WrapAngle(*leg.heading - X_WR.heading);
    if (std::abs(error_) > options_.heading_tolerance) {
      return TurnBy(error_, dt);
    }
    FinishLeg(X_WR);
    return {};
  }
  const bool is_new = s_ == 0.0 && phase_ == Phase::kDrive && !mark_time_;
  const Polyline::Foot foot =
      leg.line.Project(X_WR.position(), s_ - kBack, s_ + kAhead);
  s_ = foot.s;
  offset_ = foot.offset;
  // The last point counts once it is reached within tolerance.
  for (std::size_t i = 0; i + 1 < leg.num_reached.size(); ++i) {
    if (leg.line.LengthTo(i) > s_) break;
    num_reached_ = std::max(num_reached_, leg.num_reached[i]);
  }
  if (leg.line.length() - s_ <= kEndOfLeg) {
    FinishLeg(X_WR);
    return {};
  }
  const Eigen::Vector2d ahead = leg.line.PointAt(s_ + options_.lookahead);
  error_ = BearingTo(X_WR, ahead);
  const double limit = is_new ? options_.align_start : options_.align_above;
  if (phase_ == Phase::kDrive && std::abs(error_) > limit) {
    phase_ = Phase::kAlign;
    turn_sign_ = 0.0;
  } else if (phase_ == Phase::kAlign &&
             std::abs(error_) < options_.align_done) {
    phase_ = Phase::kDrive;
  }
  if (phase_ == Phase::kAlign) return TurnBy(error_, dt);
  // The arc through R, along its x, and through the point ahead.
  const double curvature =
      2.0 * std::sin(error_) / (ahead - X_WR.position()).norm();
  const double speed =
      std::min(SpeedLimit(error_, curvature),
               std::max(last_.forward, 0.0) + options_.acceleration * dt);
  return {speed, speed * curvature};
}

double PathTracker::SpeedLimit(double bearing, double curvature) const {
  const Leg& leg = legs_.front();
  const double a = options_.acceleration;
  const auto before = [&](double left, double then) {
    return std::sqrt(then * then + 2.0 * a * left);
  };
  const double left = leg.line.length() - s_;
  double speed = std::min(
      {max_speed_, before(left, 0.0), std::max(kCreep, kSlowGain * left)});
  for (std::size_t i = 1; i + 1 < leg.line.points().size(); ++i) {
    const double way = leg.line.LengthTo(i) - s_;
    if (way < 0.0) continue;
    // Half as fast through the sharpest corner that it drives through.
    const double through =
        max_speed_ *
        (1.0 - 0.5 * std::abs(leg.line.TurnAt(i)) / options_.max_corner);
    speed = std::min(speed, before(way, through));
  }
  speed *= std::max(std::cos(bearing), 0.2);
  return std::min(speed,
                  options_.max_turn_rate / std::max(std::abs(curvature), 1e-6));
}

Velocity PathTracker::TurnBy(double error, double dt) {
  const double size = std::abs(error);
  if (turn_sign_ == 0.0 || size < kAround) {
    turn_sign_ = error < 0.0 ? -1.0 : 1.0;
  }
  const double rate =
      std::min({options_.max_turn_rate,
                std::max(kCreepTurn, kTurnGain * size),
                std::sqrt(2.0 * options_.turn_acceleration * size),
                std::max(turn_sign_ * last_.turn_rate, 0.0) +
                    options_.turn_acceleration * dt});
  return {0.0, turn_sign_ * rate};
}

void PathTracker::NoteProgress(Time time) {
  const double left = DistanceLeft() + kMetersPerRad * std::abs(error_);
  if (!mark_time_ || left < mark_ - kProgress) {
    mark_time_ = time;
    mark_ = left;
    state_ = TrackState::kDriving;
    reason_.clear();
    return;
  }
  const double waited = Seconds(time - *mark_time_);
  if (waited < options_.wait_after_s) return;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "no progress for %.0f s", waited);
  reason_ = text.data();
  state_ = TrackState::kWaiting;
}

double PathTracker::DistanceLeft() const {
  if (legs_.empty()) return 0.0;
  double left = legs_.front().line.length() - s_;
  for (std::size_t i = 1; i < legs_.size(); ++i) left += legs_[i].line.length();
  return left;
}

TrackReport PathTracker::Report(const Velocity& velocity) const {
  TrackReport report;
  report.velocity = velocity;
  report.state = state_;
  report.reason = reason_;
  report.num_reached = num_reached_;
  report.num_waypoints = static_cast<int>(path_.size());
  report.distance_left = DistanceLeft();
  report.cross_track = offset_;
  return report;
}

}  // namespace waymark
