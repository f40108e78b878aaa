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
#include "processes/tools/experiment/corridor_errors.h"
#include "processes/tools/experiment/experiment_world.h"
#include "processes/tools/experiment/lock_step.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

// Any; runs begin there.
constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

// What the filter learned against what is true.
struct Learned {
  double ratio_error = 0.0;  // Share.
  double base_error = 0.0;
  double ratio_sigmas = 0.0;
  double base_sigmas = 0.0;
  double num_to_ratio = 0.0;  // Measurements until within 1 % for good.
  double num_to_base = 0.0;
};

double RatioSigma(const OdometryParameters& p) {
  const double r = p.parameters.k_right;
  const double l = p.parameters.k_left;
  const Eigen::Matrix3d& P = p.covariance;
  return r / l *
         std::sqrt(P(0, 0) / (r * r) + P(1, 1) / (l * l) -
                   2.0 * P(0, 1) / (r * l));
}

Learned LearnedOf(const std::vector<OdometryParameters>& all,
                  const RobotOptions& robot) {
  Learned learned;
  const double ratio = robot.right_wheel_factor / robot.left_wheel_factor;
  const double base = robot.wheel_base * robot.wheel_base_factor;
  constexpr double kClose = 0.01;
  for (const OdometryParameters& p : all) {
    const double ratio_error =
        p.parameters.k_right / p.parameters.k_left / ratio - 1.0;
    const double base_error = p.parameters.wheel_base / base - 1.0;
    const auto num = static_cast<double>(p.num_measurements);
    if (std::abs(ratio_error) > kClose) learned.num_to_ratio = num;
    if (std::abs(base_error) > kClose) learned.num_to_base = num;
    learned.ratio_error = ratio_error;
    learned.base_error = base_error;
    learned.ratio_sigmas = ratio_error * ratio / RatioSigma(p);
    learned.base_sigmas = base_error * base / std::sqrt(p.covariance(2, 2));
  }
  return learned;
}

}  // namespace

CorridorExperimentConfig::CorridorExperimentConfig() {
  simulator.world = "corridor_plain";
  simulator.ranges = RangeKind::kLidar;
  simulator.second_camera.name.clear();
  // Twice what the true wheels differ by.
  pose_filter.nominal_sigma = {
      2.0 * wheel_spread, 2.0 * wheel_spread, 2.0 * base_spread};
}

void CorridorExperimentConfig::Describe(Describer& d) {
  d.Choice<CorridorTask>("task",
                         &task,
                         {{"turns", CorridorTask::kTurns},
                          {"zigzag", CorridorTask::kZigzag},
                          {"blind", CorridorTask::kBlind},
                          {"learn", CorridorTask::kLearn}},
                         "To and fro; zig-zag; straight on, blind on the way; "
                         "zig-zag with wrong wheel parameters");
  d.Choice<CorridorSight>(
      "sight",
      &sight,
      {{"model", CorridorSight::kModel}, {"pixels", CorridorSight::kPixels}},
      "Where CORRIDOR_POSE comes from: truth with errors, or images");
  d.Text("corridor", &corridor, "Corridor file, or name; empty: the world's");
  d.Group(
      "way", [&] { DescribeWay(d); }, "Where the robot drives");
  d.Group(
      "wheels",
      [&] { DescribeWheels(d); },
      "How its wheels differ from what the filter assumes");
  d.Number("max_error_m",
           &max_error_m,
           {1e-4, 10.0},
           "Success: POSE's lateral position is never farther off");
  d.Degrees("max_error_deg", &max_error_rad, {0.01, 180.0}, "and its heading");
  d.Number("relocate_m",
           &relocate_m,
           {0.0, 100.0},
           "of sight after blindness, from where on that holds again");
  d.Number("max_duration_s",
           &max_duration_s,
           {1.0, 100000.0},
           "What is not done by then has failed; simulated time");
  d.Group(
      "model", [&] { model.Describe(d); }, "Of CORRIDOR_POSE (sight: model)");
  d.Number("tracker_latency_s",
           &tracker_latency_s,
           {0.0, 2.0},
           "That corridor_tracker takes for an image (sight: pixels)");
  d.Group(
      "corridor_tracker",
      [&] { corridor_tracker.Describe(d); },
      "As in its own configuration; camera and corridors are those of the run");
  d.Group(
      "simulator",
      [&] { simulator.Describe(d); },
      "seed, start and true wheels vary");
  d.Group(
      "pose_filter",
      [&] { pose_filter.Describe(d); },
      "wheels, noise and start are the simulated robot's");
  d.Group(
      "collision_guard",
      [&] { collision_guard.Describe(d); },
      "As in its own configuration");
  d.Group(
      "path_follower",
      [&] { path_follower.Describe(d); },
      "As in its own configuration");
}

void CorridorExperimentConfig::DescribeWay(Describer& d) {
  d.Number("begin_m", &begin_m, {-1000.0, 1000.0}, "Along the axis");
  d.Number("length_m", &length_m, {0.5, 1000.0}, "From there, one way");
  d.Integer("num_legs", &num_legs, 1, 1000, "So often, to and fro");
  d.Number("zigzag_m", &zigzag_m, {0.0, 10.0}, "To both sides of the axis");
  d.Number("zigzag_step_m", &zigzag_step_m, {0.2, 100.0}, "Along it");
  d.Numbers("blind_m",
            &blind_way_m,
            2,
            "The camera is blind from the first to the second, of the way "
            "driven (task: blind)");
}

void CorridorExperimentConfig::DescribeWheels(Describer& d) {
  constexpr Range kFactor{0.3, 3.0};
  constexpr Range kShare{0.0, 0.3};
  d.Number("spread",
           &wheel_spread,
           kShare,
           "Sigma of the true wheels' travel, as a share, drawn for each seed");
  d.Number("base_spread", &base_spread, kShare, "and of the true wheel base");
  d.Number("wrong_base",
           &wrong_base,
           kFactor,
           "Assumed over nominal wheel base (task: learn)");
  d.Number("wrong_ratio",
           &wrong_ratio,
           kFactor,
           "Assumed over nominal ratio of right and left wheel (task: learn)");
  d.Number("wrong_sigma",
           &wrong_sigma,
           {1e-3, 1.0},
           "Sigma that the filter allows for then, as a share");
}

void CorridorExperimentConfig::Check() const {
  CheckForRuns(simulator);
  CheckHasNoFile("path_follower.task_file", path_follower.task_file);
  CheckHasNoFile("collision_guard.stop_file", collision_guard.stop_file);
  pose_filter.Check();
  collision_guard.Check();
  path_follower.Check();
  if (blind_way_m.size() == 2 && blind_way_m[0] > blind_way_m[1]) {
    throw std::invalid_argument(
        "way.blind_m: its end must not be before its beginning");
  }
}

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
  run.Add<PoseFilterProcess>(Filter(robot));
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
  const Learned learned = LearnedOf(errors.learned(), robot.robot);
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
  return result;
}

}  // namespace waymark
