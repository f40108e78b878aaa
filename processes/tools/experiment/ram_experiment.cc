#include "processes/tools/experiment/ram_experiment.h"

#include "estimation/base/random.h"
#include "processes/collision_guard/collision_guard_process.h"
#include "processes/simulator/simulator_process.h"
#include "processes/support/channels.h"
#include "processes/tools/experiment/lock_step.h"

#include <waymark/velocity_t.hpp>

namespace waymark {
namespace {

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);
constexpr Duration kRequestPeriod = std::chrono::milliseconds(50);

}  // namespace

RamExperimentConfig::RamExperimentConfig()
    : simulator(SimulatorWithoutVision()) {}

void RamExperimentConfig::Describe(Describer& d) {
  d.Number("duration_s", &duration_s, {1.0, 100000.0}, "Simulated time");
  d.Number("period_s", &period_s, {0.1, 1000.0}, "A new direction so often");
  d.Group(
      "simulator",
      [&] { simulator.Describe(d); },
      "seed and start vary; world: random is another one for every seed");
  d.Group(
      "collision_guard",
      [&] { collision_guard.Describe(d); },
      "As in its own configuration");
}

void RamExperimentConfig::Check() const {
  CheckForRuns(simulator);
  CheckHasNoFile("collision_guard.stop_file", collision_guard.stop_file);
  collision_guard.Check();
}

void RamExperiment::Prepare() {
  config_.Check();
  DriveTaskOptions options;
  options.radius = config_.simulator.robot.radius;
  options.min_way = 0.0;
  options.max_way = 1000.0;
  options.num_goals = 1;
  tasks_.emplace(config_.simulator, options);
}

RunResult RamExperiment::Run(std::uint64_t seed,
                             const std::string& log_path) const {
  LockStep run(kStart, log_path);
  const SimulatorConfig simulator =
      WithStart(config_.simulator, tasks_->Make(seed).X_WR, seed);
  run.Add<SimulatorProcess>(simulator);
  run.Add<CollisionGuardProcess>(config_.collision_guard);
  // Asked for without end: more than the guard allows, in any direction, most
  // of it forward, where a robot meets things.
  Random random(SeedFor(seed, "ram"));
  const Duration limit = DurationFromSeconds(config_.duration_s);
  velocity_t request{};
  request.source = "experiment";
  Time next_turn = kStart;
  for (Time t = kStart; t < kStart + limit; t += kRequestPeriod) {
    if (t >= next_turn) {
      next_turn = t + DurationFromSeconds(config_.period_s);
      request.forward = random.Uniform(-1.0, 2.0);
      request.turn_rate = random.Uniform(-2.0, 2.0);
    }
    request.utime = Microseconds(t);
    run.bus()->Publish(kMotionRequest, request);
    ++request.seq;
  }
  const ObstacleMap walls = WallsOf(simulator);
  constexpr double kFarEnough = 1.0;  // m.
  double nearest = kFarEnough;
  const auto look = [&](const Trip& trip) {
    if (!trip.X_WR) return false;
    const auto found = walls.Nearest(trip.X_WR->position(), nearest);
    if (found) nearest = found->distance;
    return false;
  };
  (void)run.Run(look, limit);
  RunResult result;
  result.seed = seed;
  result.num_touches = run.trip().num_touches;
  result.is_success = result.num_touches == 0;
  if (!result.is_success) result.reason = "touched";
  result.way_m = run.trip().way_m;
  result.duration_s = run.duration_s();
  // Of the body, at most; below 0 the least gap that was left.
  result.figures = {{"into_walls_m", config_.simulator.robot.radius - nearest}};
  return result;
}

}  // namespace waymark
