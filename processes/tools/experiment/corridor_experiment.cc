#include "processes/tools/experiment/corridor_experiment.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "planner/control/corridor_way.h"
#include "processes/collision_guard/collision_guard_process.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/task_convert.h"
#include "processes/corridor_tracker/corridor_tracker_process.h"
#include "processes/path_follower/path_follower_process.h"
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/simulator/simulator_process.h"
#include "processes/support/channels.h"
#include "processes/tools/experiment/corridor_bound.h"
#include "processes/tools/experiment/corridor_errors.h"
#include "processes/tools/experiment/corridor_learned.h"
#include "processes/tools/experiment/corridor_vision.h"
#include "processes/tools/experiment/experiment_world.h"
#include "processes/tools/experiment/lock_step.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace waymark {
namespace {

// Any; runs begin there.
constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

}  // namespace

void CorridorExperiment::Prepare() {
  config_.Check();
  const std::string name =
      config_.corridor.empty() ? config_.simulator.world : config_.corridor;
  corridor_path_ = FindCorridorFile(name);
  corridor_ = LoadCorridorFile(corridor_path_).front();
  subject_ = fmt::format("{} in {}: {} x {} m at {}, {}, {}",
                         SubjectOf(config_.simulator),
                         corridor_.name,
                         corridor_.width.value_or(0.0),
                         corridor_.height.value_or(0.0),
                         corridor_.X_WL.x,
                         corridor_.X_WL.y,
                         corridor_.X_WL.heading);
}

std::vector<Eigen::Vector2d> CorridorExperiment::Way() const {
  const bool is_zigzag = config_.task == CorridorTask::kZigzag ||
                         config_.task == CorridorTask::kLearn;
  CorridorWayOptions way;
  way.begin = config_.begin_m;
  way.length = config_.length_m;
  way.num_legs = config_.task == CorridorTask::kBlind ? 1 : config_.num_legs;
  way.zigzag = is_zigzag ? config_.zigzag_m : 0.0;
  way.zigzag_step = config_.zigzag_step_m;
  return CorridorWay(way);
}

std::optional<Eigen::Vector2d> CorridorExperiment::BlindWay() const {
  if (config_.task != CorridorTask::kBlind || config_.blind_way_m.empty()) {
    return std::nullopt;
  }
  return Eigen::Vector2d(config_.blind_way_m[0], config_.blind_way_m[1]);
}

SimulatorConfig CorridorExperiment::Robot(std::uint64_t seed) const {
  const Pose2 X_WR = corridor_.X_WL * Pose2{config_.begin_m, 0.0, 0.0};
  SimulatorConfig robot = WithStart(config_.simulator, X_WR, seed);
  Random random(SeedFor(seed, "wheels"));
  robot.robot.right_wheel_factor *= 1.0 + random.Normal(config_.wheel_spread);
  robot.robot.left_wheel_factor *= 1.0 + random.Normal(config_.wheel_spread);
  robot.robot.wheel_base_factor *= 1.0 + random.Normal(config_.base_spread);
  if (config_.sight == CorridorSight::kModel) robot.camera.name.clear();
  if (const auto blind = BlindWay()) {
    robot.camera.covered_way = {(*blind)(0), (*blind)(1)};
  }
  return robot;
}

PoseFilterConfig CorridorExperiment::Filter(
    const SimulatorConfig& robot) const {
  PoseFilterConfig filter = ForRobot(
      config_.pose_filter,
      robot,
      Pose2{
          robot.start[0], robot.start[1], RadiansFromDegrees(robot.start[2])});
  if (config_.task == CorridorTask::kLearn) {
    // The mean of both wheels stays.
    const double half = std::sqrt(config_.wrong_ratio);
    filter.nominal[0] *= half;
    filter.nominal[1] /= half;
    filter.nominal[2] *= config_.wrong_base;
    filter.nominal_sigma.assign(3, config_.wrong_sigma);
  }
  return filter;
}

RunResult CorridorExperiment::Run(std::uint64_t seed,
                                  const std::string& log_path) const {
  LockStep run(kStart, log_path);
  const SimulatorConfig robot = Robot(seed);
  const auto blind = BlindWay();
  run.Add<SimulatorProcess>(robot);
  const PoseFilterConfig filter = Filter(robot);
  run.Add<PoseFilterProcess>(filter);
  if (config_.sight == CorridorSight::kPixels) {
    CorridorTrackerConfig tracker = config_.corridor_tracker;
    tracker.camera = robot.camera.name;
    tracker.corridors = corridor_path_;
    run.Add<CorridorTrackerProcess>(
        tracker, DurationFromSeconds(config_.tracker_latency_s));
  }
  run.Add<PathFollowerProcess>(config_.path_follower);
  run.Add<CollisionGuardProcess>(config_.collision_guard);
  std::optional<CorridorVision> model;
  if (config_.sight == CorridorSight::kModel) {
    model.emplace(config_.model, corridor_, blind, seed, run.bus());
  }
  const CorridorErrors errors(
      corridor_.X_WL, blind, config_.relocate_m, run.bus());
  // As if all of an error were new in each image: no less is known then.
  const CorridorBound bound(
      corridor_.X_WL,
      std::hypot(config_.model.sigma_m, config_.model.slow_sigma_m),
      std::hypot(config_.model.sigma_rad, config_.model.slow_sigma_rad),
      run.bus());
  Task message{kStart + std::chrono::milliseconds(500),
               "experiment",
               "waypoints",
               0.0,
               {}};
  for (const Eigen::Vector2d& p_L : Way()) {
    message.waypoints.push_back({corridor_.X_WL * p_L, std::nullopt});
  }
  run.bus()->Publish(kTask, ToMessage(message, 0));
  const bool is_over_in_time = run.Run(
      [](const Trip& trip) {
        return trip.task &&
               (trip.task->state == "done" || trip.task->state == "failed");
      },
      DurationFromSeconds(config_.max_duration_s));

  const Trip& trip = run.trip();
  const CorridorErrors::Errors& seeing = errors.seeing();
  RunResult result;
  result.seed = seed;
  result.num_touches = trip.num_touches;
  result.way_m = trip.way_m;
  result.duration_s = run.duration_s();
  // While it learns its wheels the pose may be anywhere near.
  const bool is_judged = config_.task != CorridorTask::kLearn;
  if (!is_over_in_time) {
    result.reason = "out of time";
  } else if (trip.task->state == "failed") {
    result.reason = "path_follower gave up";
  } else if (trip.num_touches > 0) {
    result.reason = "touched";
  } else if (is_judged && seeing.max_y_m > config_.max_error_m) {
    result.reason = "lateral error";
  } else if (is_judged && seeing.max_heading_rad > config_.max_error_rad) {
    result.reason = "heading error";
  } else {
    result.is_success = true;
  }
  const LearnedWheels learned = LearnedOf(errors.learned(), robot.robot);
  result.figures = {
      {"rms_y_m", seeing.rms_y_m()},
      {"max_y_m", seeing.max_y_m},
      {"rms_heading_deg", DegreesFromRadians(seeing.rms_heading_rad())},
      {"max_heading_deg", DegreesFromRadians(seeing.max_heading_rad)},
      {"max_y_sigmas", seeing.max_y_sigmas},
      {"max_heading_sigmas", seeing.max_heading_sigmas},
      {"blind_max_y_m", errors.blind().max_y_m},
      {"max_offset_m", errors.max_offset_m()},
      {"relocated_m", errors.relocated_m()},
      {"reckoned_max_y_m", errors.reckoned_m()},
      {"ratio_error", learned.ratio_error},
      {"base_error", learned.base_error},
      {"ratio_sigmas", learned.ratio_sigmas},
      {"base_sigmas", learned.base_sigmas},
      {"updates_to_ratio", learned.num_to_ratio},
      {"updates_to_base", learned.num_to_base}};
  if (!is_judged) {
    const WheelBound least = BoundOf(bound, filter, robot.robot);
    result.figures.emplace_back("ratio_bound", least.ratio);
    result.figures.emplace_back("base_bound", least.base);
  }
  return result;
}

}  // namespace waymark
