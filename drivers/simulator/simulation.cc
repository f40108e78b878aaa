#include "drivers/simulator/simulation.h"

#include "drivers/simulator/option_range.h"
#include "estimation/base/check.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

Duration StepOf(const SimulationOptions& options) {
  options.Check();
  return DurationFromSeconds(options.step_s);
}

}  // namespace

void SimulationOptions::Check() const {
  robot.Check();
  // Whole microseconds, and short enough for limits and people.
  RequireWithin("step_s", step_s, 1e-4, 0.05);
  RequireWithin("encoder_rate_hz", encoder_rate_hz, 0.1, 1000.0);
  RequireWithin("status_rate_hz", status_rate_hz, 0.1, 1000.0);
  RequireWithin("truth_rate_hz", truth_rate_hz, 0.1, 1000.0);
  if (ranges) ranges->Check();
  for (const SimulatedCamera& camera : cameras) {
    camera.timing.Check();
    camera.head.Check();
    RequireWithin("num_exposure_poses", camera.num_exposure_poses, 1, 1000);
    const auto same = [&](const SimulatedCamera& other) {
      return other.name == camera.name;
    };
    if (std::count_if(cameras.begin(), cameras.end(), same) > 1) {
      throw std::invalid_argument("two cameras are named '" + camera.name +
                                  "'");
    }
  }
  RequireAbove0("person_radius", person_radius);
}

Time TimeOf(const SimulationEvent& event) {
  return std::visit([](const auto& e) { return e.time; }, event);
}

Simulation::Simulation(const SimulationOptions& options,
                       SimulationWorld world,
                       const RobotSnapshot& start)
    : options_(options),
      world_(std::move(world)),
      robot_(options_.robot, start, options_.seed),
      encoder_clock_{options_.encoder_rate_hz},
      range_clock_{options_.ranges ? options_.ranges->rate_hz : 0.0},
      status_clock_{options_.status_rate_hz},
      truth_clock_{options_.truth_rate_hz},
      step_(StepOf(options_)),
      now_(options_.start_time),
      step_end_(options_.start_time) {
  WAYMARK_CHECK(world_.map != nullptr);
  if (options_.ranges) ranges_.emplace(*options_.ranges, options_.seed);
  for (const SimulatedCamera& camera : options_.cameras) {
    CameraTimer timer(
        camera.timing, options_.start_time, options_.seed, camera.name);
    const CameraFrame first = timer.Next();
    cameras_.push_back({timer, PanTiltHead(camera.head), first, {}});
  }
}

void Simulation::Command(double forward, double turn_rate) {
  robot_.Command(forward, turn_rate);
}

void Simulation::CommandHead(const PanTilt& target) {
  for (CameraState& camera : cameras_) camera.head.Command(now_, target);
}

// ---- when -------------------------------------------------------------------

Time Simulation::DueTime(const Clock& clock) const {
  if (clock.rate_hz == 0.0) return Time::max();
  return options_.start_time +
         DurationFromSeconds(static_cast<double>(clock.count) / clock.rate_hz);
}

bool Simulation::Takes(Clock* clock, Time t) const {
  if (DueTime(*clock) != t) return false;
  ++clock->count;
  return true;
}

Time Simulation::DueTime(std::size_t camera) const {
  const CameraState& state = cameras_[camera];
  const int num_poses = options_.cameras[camera].num_exposure_poses;
  const auto taken = static_cast<double>(state.poses.size());
  if (taken >= num_poses) return state.frame.exposure_end;
  const double exposure_s =
      Seconds(state.frame.exposure_end - state.frame.exposure_start);
  return state.frame.exposure_start +
         DurationFromSeconds(exposure_s * (taken + 0.5) / num_poses);
}

Time Simulation::NextTime() const {
  Time next = std::min({DueTime(encoder_clock_),
                        DueTime(range_clock_),
                        DueTime(status_clock_),
                        DueTime(truth_clock_)});
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    next = std::min(next, DueTime(i));
  }
  return next;
}

// ---- what -------------------------------------------------------------------

std::vector<SimulationEvent> Simulation::AdvanceTo(Time end) {
  WAYMARK_CHECK(end >= now_, Microseconds(end), Microseconds(now_));
  std::vector<SimulationEvent> events;
  for (Time next = NextTime(); next <= end; next = NextTime()) {
    StepPhysics(next);
    TakeAllAt(next, &events);
  }
  // Steps that begin before `end` are done with the commands of before it.
  StepPhysics(end);
  now_ = end;
  return events;
}

void Simulation::StepPhysics(Time until) {
  while (step_end_ < until) {
    // Decided where the step begins, whoever asks in between.
    const double begin_s = SecondsAt(step_end_);
    const double dt = Seconds(step_);
    states0_ = states_;
    if (world_.meet) world_.meet(begin_s, dt, robot_.X_WR(), &states_);
    states0_.resize(states_.size());
    step_end_ += step_;
    robot_.Step(dt, *world_.map, Discs(step_end_, robot_.X_WR()));
  }
  now_ = until;
}

void Simulation::TakeAllAt(Time t, std::vector<SimulationEvent>* events) {
  const double share = ShareAt(t);
  if (Takes(&encoder_clock_, t)) {
    events->push_back(
        EncoderEvent{t, robot_.LeftTicksAt(share), robot_.RightTicksAt(share)});
  }
  if (Takes(&range_clock_, t)) {
    const Pose2 X_WR = PoseAt(t);
    const ObstacleMap& map = *(world_.seen ? world_.seen : world_.map);
    events->push_back(
        RangeEvent{t, ranges_->Measure(X_WR, map, Discs(t, X_WR))});
  }
  if (Takes(&status_clock_, t)) {
    events->push_back(BaseEvent{t,
                                robot_.is_left_bumper_pressed(),
                                robot_.is_right_bumper_pressed(),
                                robot_.is_command_current(),
                                robot_.num_touches(),
                                robot_.num_timeouts()});
  }
  if (Takes(&truth_clock_, t)) events->push_back(TruthEvent{t, PoseAt(t)});
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    while (DueTime(i) == t) TakeCamera(i, events);
  }
}

void Simulation::TakeCamera(std::size_t camera,
                            std::vector<SimulationEvent>* events) {
  CameraState& state = cameras_[camera];
  const Time t = DueTime(camera);
  const auto num_poses =
      static_cast<std::size_t>(options_.cameras[camera].num_exposure_poses);
  if (state.poses.size() < num_poses) {
    const Pose2 X_WR = PoseAt(t);
    state.poses.push_back({t, X_WR, state.head.AnglesAt(t), PeopleAt(t, X_WR)});
    return;
  }
  events->push_back(CameraEvent{t,
                                static_cast<int>(camera),
                                state.frame,
                                robot_.way(),
                                std::move(state.poses)});
  state.poses.clear();
  state.frame = state.timer.Next();
}

// ---- where ------------------------------------------------------------------

double Simulation::ShareAt(Time t) const {
  // Before the first step there is nothing to be a share of.
  return 1.0 - Seconds(step_end_ - t) / Seconds(step_);
}

Pose2 Simulation::PoseAt(Time t) const {
  return robot_.PoseAt(ShareAt(t));
}

std::vector<Pose2> Simulation::PeopleAt(Time t, const Pose2& X_WR) const {
  if (!world_.people) return {};
  const double share = ShareAt(t);
  std::vector<PersonState> states = states_;
  for (std::size_t i = 0; i < states.size(); ++i) {
    states[i] = Interpolate(states0_[i], states_[i], share);
  }
  return world_.people(SecondsAt(t), X_WR, states);
}

double Simulation::SecondsAt(Time t) const {
  return Seconds(t - options_.start_time);
}

std::vector<Pose2> Simulation::People() const {
  return PeopleAt(now_, X_WR());
}

std::vector<Disc2> Simulation::Discs(Time t, const Pose2& X_WR) const {
  std::vector<Disc2> discs;
  for (const Pose2& X_WP : PeopleAt(t, X_WR)) {
    discs.push_back({X_WP.position(), options_.person_radius});
  }
  return discs;
}

}  // namespace waymark
