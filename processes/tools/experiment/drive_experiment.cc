#include "processes/tools/experiment/drive_experiment.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "processes/collision_guard/collision_guard_process.h"
#include "processes/convert/odometry_convert.h"
#include "processes/convert/task_convert.h"
#include "processes/path_follower/path_follower_process.h"
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/simulator/simulator_process.h"
#include "processes/support/channels.h"
#include "processes/tools/experiment/lock_step.h"

#include <waymark/truth_t.hpp>

#include <utility>

namespace waymark {
namespace {

// Any; runs begin there.
constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

// POSITION_FIX from TRUTH, as a localiser would send it.
class SimulatedLocaliser {
 public:
  SimulatedLocaliser(const DriveExperimentConfig& config,
                     std::uint64_t seed,
                     LocalBus* bus)
      : config_(config), random_(SeedFor(seed, "localiser")), bus_(bus) {
    if (config.fix_period_s == 0.0) return;
    bus->bus()->Subscribe<truth_t>(
        kTruth, Keep::All(), [this](const truth_t& truth, Time t) {
          OnTruth(truth, t);
        });
  }

 private:
  void OnTruth(const truth_t& truth, Time t) {
    if (t < next_) return;
    next_ = t + DurationFromSeconds(config_.fix_period_s);
    AbsoluteFix fix;
    fix.time = t;
    fix.source = "simulated_localiser";
    fix.seq = seq_++;
    fix.has = {true, true, true};
    fix.value = {
        truth.x + random_.Normal(config_.fix_sigma_m),
        truth.y + random_.Normal(config_.fix_sigma_m),
        WrapAngle(truth.heading + random_.Normal(config_.fix_sigma_rad))};
    const double position = config_.fix_sigma_m * config_.fix_sigma_m;
    const double heading = config_.fix_sigma_rad * config_.fix_sigma_rad;
    fix.covariance = Eigen::Vector3d(position, position, heading).asDiagonal();
    bus_->Publish(kPositionFix, ToMessage(fix));
  }

  const DriveExperimentConfig& config_;
  Random random_;
  LocalBus* bus_;
  Time next_;
  std::int64_t seq_ = 0;
};

}  // namespace

DriveExperimentConfig::DriveExperimentConfig()
    : simulator(SimulatorWithoutVision()) {}

void DriveExperimentConfig::Describe(Describer& d) {
  std::int64_t num_goals = task.num_goals;
  d.Group(
      "task",
      [&] {
        d.Integer("num_goals", &num_goals, 1, 100, "Random places, in order");
        d.Number("min_way_m",
                 &task.min_way,
                 {0.0, 1000.0},
                 "Of the shortest way from one to the next");
        d.Number("max_way_m", &task.max_way, {0.1, 10000.0}, "At most");
        d.Number("clearance_m",
                 &task.clearance,
                 {0.0, 5.0},
                 "The way to drive is planned so much farther from walls than "
                 "the shortest");
      },
      "Where to drive");
  task.num_goals = static_cast<int>(num_goals);
  d.Number("goal_radius_m",
           &goal_radius_m,
           {0.01, 10.0},
           "Success: so near to every goal, and in the end to the last, truly");
  d.Number("max_duration_s",
           &max_duration_s,
           {1.0, 100000.0},
           "What is not done by then has failed; simulated time");
  d.Group(
      "fixes",
      [&] {
        d.Number("period_s",
                 &fix_period_s,
                 {0.0, 1000.0},
                 "POSITION_FIX so often, the truth with noise; 0: never");
        d.Number("sigma_m", &fix_sigma_m, {1e-4, 10.0}, "Of x and y");
        d.Number("sigma_rad", &fix_sigma_rad, {1e-4, 1.0}, "Of the heading");
      },
      "Stand in for localisation by sight");
  d.Group(
      "simulator",
      [&] { simulator.Describe(d); },
      "seed and start vary; world: random is another one for every seed");
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

void DriveExperimentConfig::Check() const {
  CheckForRuns(simulator);
  CheckHasNoFile("path_follower.task_file", path_follower.task_file);
  CheckHasNoFile("collision_guard.stop_file", collision_guard.stop_file);
  pose_filter.Check();
  collision_guard.Check();
  path_follower.Check();
}

void DriveExperiment::Prepare() {
  config_.Check();
  config_.task.radius = config_.simulator.robot.radius;
  tasks_.emplace(config_.simulator, config_.task);
}

RunResult DriveExperiment::Run(std::uint64_t seed,
                               const std::string& log_path) const {
  const DriveTask task = tasks_->Make(seed);
  LockStep run(kStart, log_path);
  const SimulatorConfig simulator =
      WithStart(config_.simulator, task.X_WR, seed);
  run.Add<SimulatorProcess>(simulator);
  run.Add<PoseFilterProcess>(
      ForRobot(config_.pose_filter, simulator, task.X_WR));
  run.Add<PathFollowerProcess>(config_.path_follower);
  run.Add<CollisionGuardProcess>(config_.collision_guard);
  const SimulatedLocaliser localiser(config_, seed, run.bus());
  Task message{kStart + std::chrono::milliseconds(500),
               "experiment",
               "waypoints",
               0.0,
               {}};
  for (const Eigen::Vector2d& p_W : task.waypoints) {
    message.waypoints.push_back({p_W, std::nullopt});
  }
  run.bus()->Publish(kTask, ToMessage(message, 0));

  std::size_t num_goals = 0;
  const auto is_over = [&](const Trip& trip) {
    if (trip.X_WR && num_goals < task.goals.size() &&
        (trip.X_WR->position() - task.goals[num_goals]).norm() <=
            config_.goal_radius_m) {
      ++num_goals;
    }
    return trip.task &&
           (trip.task->state == "done" || trip.task->state == "failed");
  };
  const bool is_over_in_time =
      run.Run(is_over, DurationFromSeconds(config_.max_duration_s));
  const Trip& trip = run.trip();
  RunResult result;
  result.seed = seed;
  result.num_touches = trip.num_touches;
  result.way_m = trip.way_m;
  result.shortest_m = ShortestPast(task, config_.goal_radius_m);
  result.duration_s = run.duration_s();
  const double to_goal =
      trip.X_WR ? (trip.X_WR->position() - task.goals.back()).norm() : 0.0;
  if (!is_over_in_time) {
    result.reason = "out of time";
    if (trip.task && trip.task->state == "waiting") result.reason += ", waits";
  } else if (trip.task->state == "failed") {
    result.reason = "path_follower gave up";
  } else if (to_goal > config_.goal_radius_m || num_goals < task.goals.size()) {
    result.reason = "not at the goal";
  } else {
    result.is_success = true;
  }
  result.figures = {{"waypoints_reached",
                     trip.task ? static_cast<double>(trip.task->num_reached) /
                                     static_cast<double>(task.waypoints.size())
                               : 0.0},
                    {"end_error_m", to_goal},
                    {"max_pose_error_m", trip.max_pose_error_m}};
  return result;
}

}  // namespace waymark
