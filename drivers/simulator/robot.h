// A differential-drive robot: its wheels, its noise, and what it bumps into.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "drivers/wheels/differential_base.h"
#include "estimation/base/random.h"
#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"

#include <cstdint>
#include <optional>
#include <span>

namespace waymark {

// What wheels do that push against an obstacle.
enum class BlockedWheels : std::uint8_t {
  kStall,  // They stand; no ticks.
  kSpin,   // They go on turning, with their ticks.
};

struct RobotOptions {
  double radius = 0.17;           // Of the round body about R, m.
  double height = 1.1;            // With what stands on it: cameras, m.
  double meters_per_tick = 1e-4;  // Nominal: what its own controller assumes.
  double wheel_base = 0.27;       // Nominal, m.
  // True over nominal.
  double right_wheel_factor = 1.0;
  double left_wheel_factor = 1.0;
  double wheel_base_factor = 1.0;

  double max_wheel_speed = 0.6;         // m/s.
  double max_wheel_acceleration = 2.0;  // Also when braking, m/s^2.
  // So long after the last command the robot stands, braking in time.
  double command_timeout_s = 0.5;

  // As DriveNoise of the odometry filters has them: the variance of a wheel's
  // travel is wheel_variance per metre, m^2/m; over a way ds (the mean absolute
  // travel of the wheels) the wheel base is off by b with variance
  // base_variance / ds, m^3, so that the turn is off by -turn * b / B. Neither
  // depends on the length of the steps.
  double wheel_variance = 1e-6;
  double base_variance = 1e-8;

  // Now and then, on average once in slip_every meters of way (0: never), one
  // wheel loses slip_share of its travel over slip_length meters.
  double slip_every = 0.0;
  double slip_length = 0.05;
  double slip_share = 0.5;

  BlockedWheels blocked_wheels = BlockedWheels::kStall;
  // Once its bumper was pressed it goes no further forward until the bumper is
  // free and no forward motion is asked for, as bases with bumpers do
  // (drivers/wheels); else it pushes.
  bool holds_at_bumper = true;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// What a restarted simulator goes on from, at rest.
struct RobotSnapshot {
  Pose2 X_WR;
  double right_ticks = 0.0;  // Whole ticks and what has turned since.
  double left_ticks = 0.0;
};

// Moves in steps of any length. What the wheels have turned is counted before
// noise, slip and true radii make a way of it, as encoders count.
class SimulatedRobot {
 public:
  // Throws as Check() does.
  SimulatedRobot(const RobotOptions& options,
                 const RobotSnapshot& start,
                 std::uint64_t seed);

  // Asks for speeds of the nominal robot, m/s and rad/s, from the next step
  // on. Both wheels are slowed alike where one would be too fast, so that the
  // curve stays. Throws std::logic_error unless finite.
  void Command(double forward, double turn_rate);

  // Moves for dt seconds among walls and people, where these stand at its end.
  // The last command counts by its age at the end of the step.
  // Stops where it touches; it may back off and turn on the spot.
  void Step(double dt,
            const ObstacleMap& map,
            std::span<const Disc2> people = {});

  // Within the last step, at a share of it in [0, 1].
  [[nodiscard]] Pose2 PoseAt(double share) const;
  [[nodiscard]] std::int64_t RightTicksAt(double share) const;
  [[nodiscard]] std::int64_t LeftTicksAt(double share) const;
  [[nodiscard]] RobotSnapshot Snapshot() const;

  [[nodiscard]] const Pose2& X_WR() const { return X_WR_; }
  // As its own wheels have it, nominal: what a base reports.
  [[nodiscard]] double forward_speed() const;
  [[nodiscard]] double turn_rate() const;
  // Touches so far: each counts once, from its first step until everything is
  // kReleaseGap away.
  [[nodiscard]] std::int64_t num_touches() const { return num_touches_; }
  [[nodiscard]] bool is_touching() const { return is_touching_; }
  // The bumper is in front: something touches within kBumperReach to the left
  // (right) of straight ahead, or less than kBumperOverlap to its other side.
  [[nodiscard]] bool is_left_bumper_pressed() const;
  [[nodiscard]] bool is_right_bumper_pressed() const;
  // False before the first command and command_timeout_s after the last.
  [[nodiscard]] bool is_command_current() const {
    return base_.is_command_current();
  }
  // Its bumper holds back what is asked of it.
  [[nodiscard]] bool is_held() const {
    return base_.hold() == BaseHold::kBumper;
  }
  // Commands to move that were not renewed in time, so far.
  [[nodiscard]] std::int64_t num_timeouts() const {
    return base_.num_timeouts();
  }
  // Length of the true way so far, m.
  [[nodiscard]] double way() const { return way_; }
  [[nodiscard]] const RobotOptions& options() const { return options_; }

  // Stops this much before it would touch: more than the error of a contact,
  // less than anyone sees.
  static constexpr double kSkin = 1e-4;
  static constexpr double kReleaseGap = 0.005;
  static constexpr double kBumperReach = 1.3;     // rad.
  static constexpr double kBumperOverlap = 0.35;  // rad.

 private:
  // Of the two wheels: speeds m/s, ways m, ticks.
  struct Wheels {
    double right = 0.0;
    double left = 0.0;
  };
  // Nominal way of the wheels over the next dt seconds, and what becomes of
  // it on the ground.
  [[nodiscard]] Wheels TurnWheels(double dt);
  [[nodiscard]] ArcMotion MotionOf(const Wheels& way);
  void Slip(Wheels* way);
  // Keeps what of the motion is free.
  void StopAt(const ArcContact& contact, const Wheels& way);
  void CountTouch(const std::optional<ArcContact>& contact,
                  const ObstacleMap& map,
                  std::span<const Disc2> people);
  [[nodiscard]] double TouchBearing() const;
  // Since the start.
  [[nodiscard]] Time Now() const { return Time(DurationFromSeconds(seconds_)); }

  RobotOptions options_;
  Random wheel_noise_;
  Random slip_noise_;
  Pose2 X_WR_;
  Wheels ticks_;

  DifferentialBase base_;
  double seconds_ = 0.0;  // So far.
  Wheels speed_;          // Nominal.

  // The last step.
  Pose2 X_WR0_;
  Wheels ticks0_;
  Wheels turned_;            // Ticks of the whole step, were the way free.
  ArcMotion motion_;         // As well.
  double free_share_ = 1.0;  // Of it until the robot was stopped.
  double tick_share_ = 1.0;  // Until the wheels were.
  bool turns_on_ = false;    // On the spot, once stopped.

  double way_ = 0.0;
  std::int64_t num_touches_ = 0;
  bool is_touching_ = false;
  Eigen::Vector2d p_WT_ = Eigen::Vector2d::Zero();  // What is touched.

  double to_next_slip_ = 0.0;  // Way until the next slip begins, m.
  double slip_rest_ = 0.0;     // Way that the present one still lasts, m.
  bool is_right_slipping_ = false;
};

}  // namespace waymark
