// How much of a velocity that is asked for a robot may have.
#pragma once

#include "estimation/base/time.h"
#include "planner/control/drive_model.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace waymark {

// One sweep of a lidar or sonar ring, in the sensor's frame S: distances, m, in
// the directions first_angle + i * step. What is not finite or not above the
// least range says nothing; no echo is the sensor's largest range, or any
// larger number.
struct RangeScan {
  Time time;
  double first_angle = 0.0;
  double step = 0.0;
  std::vector<double> ranges;
};

enum class RangeUse {
  kRequired,  // Without new ones nothing moves.
  kNone,      // The robot has no such sensor: limits and bumpers alone.
};

struct VelocityGuardOptions {
  double radius = 0.2;         // Of the round robot about R, m.
  double margin = 0.05;        // Kept free around it, m,
  double margin_time = 0.1;    // and so much more per speed, s.
  double max_speed = 0.5;      // m/s.
  double max_turn_rate = 1.5;  // rad/s.
  // Of the base: it accelerates at most, and brakes at least, like this, and
  // never changes its velocity faster than the former or slower than the
  // latter.
  DriveRates rates;
  // From the time stamp of the newest input until the wheels obey a command
  // that followed from it: anything from 0 to this.
  double max_latency_s = 0.15;
  // A command is looked at again so soon.
  double hold_s = 0.15;

  RangeUse ranges = RangeUse::kRequired;
  Pose2 X_RS;               // Where the range sensor is.
  double min_range = 0.02;  // Less is no measurement, m.
  // An echo may come from anywhere in its beam, which is at least as wide as
  // beams are apart (up to 90 deg), so that nothing is between them, rad.
  double beam_width = 0.0;
  double max_range_age = 0.5;  // s.
  double unseen_speed = 0.1;   // To where no range looks, m/s.

  double contact_hold_s = 1.0;  // After a bumper only backwards.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct AllowedVelocity {
  Velocity velocity;
  std::string reason;  // Why less than was asked for; empty: it is not less.
};

// Allows what lets the robot stop, on the way that it then takes, before it
// comes closer than the margin to anything that the newest ranges show. How the
// base follows commands is known within limits only: every way is checked for
// the least and the largest latency and for a sluggish and a brisk base, from
// the time of the ranges on, with the commands since.
//
// What is too fast is slowed on the same curve; where nothing of it is free,
// turning on the spot may be. What is already within the margin may come no
// closer. Obstacles are taken to stand still.
//
// Deterministic; O(rates of the base / step * ranges nearby) per call.
class VelocityGuard {
 public:
  // Throws as Check() does.
  explicit VelocityGuard(const VelocityGuardOptions& options);

  void SetRanges(const RangeScan& scan);
  // A bumper is pressed at `time`.
  void SetContact(Time time);

  // What becomes the command at `now`, the newest time stamp known. Time that
  // has gone back by more than a second starts anew.
  [[nodiscard]] AllowedVelocity Allow(Time now, const Velocity& asked);
  // The same for 0: brakes, whatever there is.
  void Stop(Time now);

 private:
  struct Command {
    Time time;
    Velocity velocity;
  };
  // The robot when a command of now gets to the wheels, as one kind of base.
  struct Start {
    DriveState state;
    double latency_s = 0.0;
    std::vector<double> distances;  // To the points.
  };

  // Forgets what was decided at this time or after it: it did not come to be.
  void Rewind(Time now);
  void Record(Time now, const Velocity& command);
  [[nodiscard]] AllowedVelocity Check(Time now, const Velocity& limited);
  // From the robot of the moment: nothing farther away can matter to it, m.
  [[nodiscard]] double Reach() const;
  [[nodiscard]] bool IsSeen(double direction) const;
  [[nodiscard]] std::vector<Start> StartsAt(Time now) const;
  [[nodiscard]] DriveState StateAt(Time now,
                                   Duration latency,
                                   const DriveRates& rates) const;
  // What is near enough to matter, and how far it is.
  void Measure(std::vector<Start>* starts);
  [[nodiscard]] std::vector<Eigen::Vector2d> WayOf(
      const Start& start, const Velocity& candidate) const;
  // Index of the nearest point that would come too close; nullopt: none.
  [[nodiscard]] std::optional<std::size_t> Obstacle(
      const std::vector<Start>& starts, const Velocity& candidate) const;
  [[nodiscard]] Velocity Slowed(const std::vector<Start>& starts,
                                const Velocity& asked) const;

  VelocityGuardOptions options_;
  std::optional<Time> range_time_;
  std::vector<double> seen_;             // Directions in R, rad.
  std::vector<Eigen::Vector2d> echoes_;  // p_RQ at the time of the ranges.
  std::vector<Eigen::Vector2d> points_;  // Those of them within reach.
  std::optional<Time> contact_time_;
  std::vector<Command> commands_;  // In the order of time.
};

}  // namespace waymark
