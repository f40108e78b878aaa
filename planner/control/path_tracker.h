// Drives a differential drive along way-points.
#pragma once

#include "estimation/base/time.h"
#include "planner/control/drive_model.h"
#include "planner/control/polyline.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct PathTrackerOptions {
  double max_speed = 0.4;          // m/s.
  double max_turn_rate = 1.0;      // rad/s.
  double acceleration = 0.4;       // Also before corners and the goal, m/s^2.
  double turn_acceleration = 2.0;  // rad/s^2.
  // It heads for the point this far ahead of it on the way, m.
  double lookahead = 0.35;
  double max_corner = 0.52;   // More is turned on the spot, rad.
  double align_above = 1.0;   // While driving: worse aligned than this, it
                              // stops and turns, rad,
  double align_start = 0.26;  // and at the start of a straight piece.
  double align_done = 0.08;   // It drives on below, rad.
  double position_tolerance = 0.05;  // Of every way-point, m.
  double heading_tolerance = 0.035;  // Where one has a heading, rad.
  double wait_after_s = 5.0;         // Without progress it is 'waiting'.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct Waypoint {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  std::optional<double> heading;  // To turn to there, rad.
};

enum class TrackState { kIdle, kDriving, kWaiting, kDone, kFailed };

struct TrackReport {
  Velocity velocity;
  TrackState state = TrackState::kIdle;
  std::string reason;  // Why it waits or failed.
  int num_reached = 0;
  int num_waypoints = 0;
  double distance_left = 0.0;  // m.
  double cross_track = 0.0;    // Offset from the way, left positive, m.
};

// The way leads from where the robot is at the first Update() through the
// way-points on straight pieces. Sharp corners, and way-points with a heading,
// divide it into legs: the robot stops there and turns on the spot. On a leg it
// pursues a point ahead on the way, which beyond the end of the leg lies
// straight on, so that the curvature asked for stays bounded up to the goal.
//
// Where it has missed a way-point by more than the tolerance it drives there
// anew, three times at most. Velocities grow with limited acceleration.
// Without progress it goes on asking, and reports kWaiting until it moves on.
// Deterministic; O(way-points) per call.
class PathTracker {
 public:
  // Throws as Check() does.
  explicit PathTracker(const PathTrackerOptions& options);

  // Replaces what is under way. `max_speed` 0: that of the options;
  // `num_reached`: so many of the way-points are done. Every number is finite.
  void Start(const std::vector<Waypoint>& path,
             double max_speed,
             int num_reached = 0);
  // Gives up.
  void Clear();

  // What to ask for at pose X_WR. Time that does not advance, or by more than
  // a second, counts as no time for acceleration and waiting.
  [[nodiscard]] TrackReport Update(Time time, const Pose2& X_WR);
  // The same where the pose is unknown: to stand. Without a time where there
  // was no pose yet whose time could be told.
  [[nodiscard]] TrackReport Hold(std::optional<Time> time,
                                 const std::string& reason);

  [[nodiscard]] bool is_active() const {
    return state_ == TrackState::kDriving || state_ == TrackState::kWaiting;
  }

 private:
  enum class Phase { kAlign, kDrive, kTurn };
  struct Leg {
    Polyline line{{Eigen::Vector2d::Zero()}};
    std::vector<int> num_reached;   // Way-points, at each of line.points().
    std::optional<double> heading;  // At its end.
  };

  void MakeLegs(const Eigen::Vector2d& p_WR);
  void StartLeg();
  void FinishLeg(const Pose2& X_WR);
  [[nodiscard]] Velocity Drive(const Pose2& X_WR, double dt);
  [[nodiscard]] Velocity TurnBy(double error, double dt);
  [[nodiscard]] double SpeedLimit(double bearing, double curvature) const;
  void NoteProgress(Time time);
  [[nodiscard]] double DistanceLeft() const;
  [[nodiscard]] TrackReport Report(const Velocity& velocity) const;

  PathTrackerOptions options_;
  std::vector<Waypoint> path_;
  double max_speed_ = 0.0;
  TrackState state_ = TrackState::kIdle;
  std::string reason_;
  int num_reached_ = 0;

  std::vector<Leg> legs_;  // Still to drive; the first one is under way.
  bool has_legs_ = false;
  int num_retries_ = 0;
  Phase phase_ = Phase::kAlign;
  double s_ = 0.0;  // Along the leg.
  double offset_ = 0.0;
  double error_ = 0.0;  // Of the direction, rad.
  double turn_sign_ = 0.0;

  Velocity last_;
  std::optional<Time> time_;
  // Since when, and from where, there is no progress.
  std::optional<Time> mark_time_;
  double mark_ = 0.0;
};

[[nodiscard]] const char* NameOf(TrackState state);

}  // namespace waymark
