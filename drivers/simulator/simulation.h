// The simulated robot in lock-step: what its sensors say, event by event.
#pragma once

#include "drivers/simulator/camera_timing.h"
#include "drivers/simulator/pan_tilt_head.h"
#include "drivers/simulator/person_state.h"
#include "drivers/simulator/range_sensor.h"
#include "drivers/simulator/robot.h"
#include "estimation/base/time.h"
#include "estimation/geometry/pose2.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace waymark {

struct SimulatedCamera {
  std::string name;
  CameraTimingOptions timing;
  // Poses over the exposure that an event has; 1: its middle alone.
  int num_exposure_poses = 1;
  PanTiltHeadOptions head;  // Its own; one that is fixed makes no use of it.
};

struct SimulationOptions {
  RobotOptions robot;
  double step_s = 0.005;  // Of the physics.
  double encoder_rate_hz = 50.0;
  double status_rate_hz = 10.0;
  double truth_rate_hz = 50.0;
  std::optional<RangeSensorOptions> ranges;
  std::vector<SimulatedCamera> cameras;
  double person_radius = 0.25;  // m.
  Time start_time;
  std::uint64_t seed = 1;  // All noise follows from it, each source's by name.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// What the robot moves in.
struct SimulationWorld {
  // Outlives the simulation; not null.
  const ObstacleMap* map = nullptr;
  // What ranges meet, where that is not all that the robot bumps into; may be
  // null.
  const ObstacleMap* seen = nullptr;
  // X_WP of each person, `seconds` after the start; `states` as meet() leaves
  // them (empty: nobody has met a robot). Empty: nobody.
  std::function<std::vector<Pose2>(
      double seconds, const Pose2& X_WR, std::span<const PersonState> states)>
      people;
  // What the robot makes of the states in the `dt` from `seconds` on. Empty:
  // nobody minds it.
  std::function<void(double seconds,
                     double dt,
                     const Pose2& X_WR,
                     std::vector<PersonState>* states)>
      meet;
};

struct EncoderEvent {
  Time time;
  std::int64_t left_ticks = 0;
  std::int64_t right_ticks = 0;
};

struct RangeEvent {
  Time time;
  std::vector<float> ranges;  // Of the beams of RangeSensorOptions, m.
};

struct BaseEvent {
  Time time;
  bool is_left_bumper_pressed = false;
  bool is_right_bumper_pressed = false;
  bool is_command_current = false;
  std::int64_t num_touches = 0;  // Since the start.
  std::int64_t num_timeouts = 0;
};

struct TruthEvent {
  Time time;
  Pose2 X_WR;
};

// Where everything is at one time of an exposure.
struct ExposurePose {
  Time time;
  Pose2 X_WR;
  PanTilt head;             // Of this camera.
  std::vector<Pose2> X_WP;  // Of the people.
};

// An exposure that has ended: to be drawn, and handed on at frame.arrival.
struct CameraEvent {
  Time time;       // The end of the exposure.
  int camera = 0;  // Index of SimulationOptions::cameras.
  CameraFrame frame;
  double way = 0.0;                 // That the robot had driven until then, m.
  std::vector<ExposurePose> poses;  // Evenly over the exposure, in order.
};

using SimulationEvent =
    std::variant<EncoderEvent, RangeEvent, BaseEvent, TruthEvent, CameraEvent>;

[[nodiscard]] Time TimeOf(const SimulationEvent& event);

// Events and poses depend on options, world, and the commands and their times,
// not on how time is cut into calls. A command acts from the first step of the
// physics on that begins at or after now().
class Simulation {
 public:
  // Throws as Check() does. `start` is at rest; a restarted simulator goes on
  // from the Snapshot() of the one before.
  Simulation(const SimulationOptions& options,
             SimulationWorld world,
             const RobotSnapshot& start);

  [[nodiscard]] Time now() const { return now_; }
  // Of the next event; nothing happens before.
  [[nodiscard]] Time NextTime() const;
  // Of the next EncoderEvent.
  [[nodiscard]] Time NextEncoderTime() const { return DueTime(encoder_clock_); }

  // As SimulatedRobot::Command; acts at once but for the step under way.
  void Command(double forward, double turn_rate);
  // To all heads, each within its own limits.
  void CommandHead(const PanTilt& target);

  // Moves on to `end` and returns what happened after the last call until then,
  // `end` included, by time; encoders first, then ranges, base, truth, cameras.
  // The first events are at the start itself. Throws std::logic_error where
  // `end` lies before now().
  [[nodiscard]] std::vector<SimulationEvent> AdvanceTo(Time end);

  // At now().
  [[nodiscard]] Pose2 X_WR() const { return PoseAt(now_); }
  [[nodiscard]] std::vector<Pose2> People() const;
  [[nodiscard]] const SimulatedRobot& robot() const { return robot_; }
  // At the end of the step under way, which is at most step_s ahead of now().
  [[nodiscard]] RobotSnapshot Snapshot() const { return robot_.Snapshot(); }

 private:
  // Something that happens at a rate.
  struct Clock {
    double rate_hz = 0.0;
    std::int64_t count = 0;
  };
  struct CameraState {
    CameraTimer timer;
    PanTiltHead head;
    CameraFrame frame;                // The next one.
    std::vector<ExposurePose> poses;  // So far.
  };

  [[nodiscard]] Time DueTime(const Clock& clock) const;
  // Counts the event that is due at t, if it is.
  bool Takes(Clock* clock, Time t) const;
  // Of the next pose of an exposure; its end once all are taken.
  [[nodiscard]] Time DueTime(std::size_t camera) const;
  void TakeCamera(std::size_t camera, std::vector<SimulationEvent>* events);
  void StepPhysics(Time until);
  [[nodiscard]] double ShareAt(Time t) const;
  [[nodiscard]] Pose2 PoseAt(Time t) const;
  [[nodiscard]] std::vector<Pose2> PeopleAt(Time t, const Pose2& X_WR) const;
  [[nodiscard]] std::vector<Disc2> Discs(Time t, const Pose2& X_WR) const;
  [[nodiscard]] double SecondsAt(Time t) const;
  void TakeAllAt(Time t, std::vector<SimulationEvent>* events);

  SimulationOptions options_;
  SimulationWorld world_;
  SimulatedRobot robot_;
  std::optional<RangeSensor> ranges_;
  Clock encoder_clock_;
  Clock range_clock_;
  Clock status_clock_;
  Clock truth_clock_;
  std::vector<CameraState> cameras_;
  Duration step_;
  Time now_;
  Time step_end_;
  // Of the people, at both ends of the step under way.
  std::vector<PersonState> states0_;
  std::vector<PersonState> states_;
};

}  // namespace waymark
