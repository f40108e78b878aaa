// Whatever is asked of it: a guarded robot among posts and walls.
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "planner/control/velocity_guard.h"
#include "tests/planner/control/disc_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace waymark {
namespace {

// Whatever is asked, however late ranges and commands are within the stated
// bounds: the robot stays clear of everything.
TEST(VelocityGuard, StaysClearInRandomScenes) {
  constexpr int kScenes = 1000;
  constexpr int kSteps = 200;  // Of 0.05 s.
  double least = 1.0;
  double way = 0.0;
  for (int seed = 0; seed < kScenes; ++seed) {
    Random random(static_cast<std::uint64_t>(seed) + 1000);
    VelocityGuardOptions options;
    options.margin_time = 0.0;
    const DiscScene scene = RandomScene(&random, 0.35);
    VelocityGuard guard(options);
    // The base is at least as good as stated, and late by what it likes.
    DriveRates rates;
    rates.acceleration = random.Uniform(0.3, options.rates.acceleration);
    rates.braking = random.Uniform(options.rates.braking, 2.0);
    DriveState state;
    state.pose.heading = random.Uniform(-kPi, kPi);
    std::vector<std::pair<double, Velocity>> on_the_way;
    Velocity obeyed;
    Velocity asked;
    double next_scan = 0.0;
    std::vector<std::pair<double, RangeScan>> scans;
    double worst = 1.0;
    for (int i = 0; i < kSteps; ++i) {
      const double t = 0.05 * i;
      if (random.Uniform() < 0.05) {
        asked = {random.Uniform(-0.7, 0.9), random.Uniform(-2.0, 2.0)};
        if (random.Uniform() < 0.5) asked.turn_rate *= 0.2;
      }
      if (t >= next_scan) {
        scans.emplace_back(t + random.Uniform(0.0, 0.1),
                           ScanOf(scene, state.pose, t));
        // Now and then none comes for longer than they are valid.
        next_scan =
            t + (random.Uniform() < 0.03 ? 0.9 : random.Uniform(0.05, 0.25));
      }
      while (!scans.empty() && scans.front().first <= t) {
        guard.SetRanges(scans.front().second);
        scans.erase(scans.begin());
      }
      if (random.Uniform() < 0.6) {  // Requests are not regular either.
        const double late = random.Uniform(0.0, options.max_latency_s);
        const double at = std::max(
            t + late, on_the_way.empty() ? 0.0 : on_the_way.back().first);
        on_the_way.emplace_back(at, guard.Allow(At(t), asked).velocity);
      } else {
        // As the process does by its timer.
        on_the_way.emplace_back(
            std::max(t, on_the_way.empty() ? 0.0 : on_the_way.back().first),
            guard.Allow(At(t), asked).velocity);
      }
      for (int k = 0; k < 5; ++k) {
        const double now = t + 0.01 * k;
        while (!on_the_way.empty() && on_the_way.front().first <= now) {
          obeyed = on_the_way.front().second;
          on_the_way.erase(on_the_way.begin());
        }
        const Pose2 before = state.pose;
        state = Advance(state, obeyed, rates, 0.01);
        way += (state.pose.position() - before.position()).norm();
        worst = std::min(
            worst, scene.Distance(state.pose.position()) - options.radius);
      }
    }
    least = std::min(least, worst);
    // The lidar sees the wall at every degree only, and the base ramps
    // between its bounds: 1.5 cm of the margin are for that.
    EXPECT_GE(worst, options.margin - 0.015) << "seed " << seed;
  }
  RecordProperty("least_clearance_mm", static_cast<int>(1000 * least));
  // It moves all the same: more than a tenth of the speed asked for.
  EXPECT_GT(way, kScenes * kSteps * 0.05 * 0.04);
}

}  // namespace
}  // namespace waymark
