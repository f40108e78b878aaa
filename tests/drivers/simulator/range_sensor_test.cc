#include "drivers/simulator/range_sensor.h"

#include "estimation/geometry/angle.h"
#include "tests/support/rectangle_walls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

// 6 x 4 m about the origin.
ObstacleMap Room() {
  return ObstacleMap(RectangleWalls({-3.0, -2.0}, {3.0, 2.0}));
}

double ToRoom(const Eigen::Vector2d& p, double bearing) {
  const double c = std::cos(bearing);
  const double s = std::sin(bearing);
  const double tx = ((c > 0.0 ? 3.0 : -3.0) - p.x()) / c;
  const double ty = ((s > 0.0 ? 2.0 : -2.0) - p.y()) / s;
  return std::min(tx, ty);
}

RangeSensorOptions Exact(RangeSensorOptions options) {
  options.sigma = options.sigma_share = options.drop_share = 0.0;
  return options;
}

TEST(RangeSensor, LidarMeasuresARoomAsGeometryHasIt) {
  RangeSensorOptions options = Exact(RangeSensorOptions::Lidar());
  options.X_RS = {0.2, -0.1, 0.4};
  RangeSensor lidar(options, 1);
  const Pose2 X_WR{0.7, -0.3, 2.1};
  const auto ranges = lidar.Measure(X_WR, Room(), {});
  ASSERT_EQ(ranges.size(), 360u);
  const Pose2 X_WS = X_WR * options.X_RS;
  for (int i = 0; i < 360; ++i) {
    const double bearing =
        X_WS.heading + options.first_bearing + i * options.bearing_step;
    EXPECT_NEAR(ranges[static_cast<std::size_t>(i)],
                ToRoom(X_WS.position(), bearing),
                1e-6)  // Of a float.
        << i;
  }
}

TEST(RangeSensor, SonarHearsTheNearestThatItMeetsSteeplyEnough) {
  RangeSensorOptions options = Exact(RangeSensorOptions::SonarRing());
  options.max_range = 10.0;
  options.ring_radius = 0.15;
  RangeSensor sonar(options, 1);
  const ObstacleMap wall({{{2.0, -50.0}, {2.0, 50.0}}});
  for (const double heading : {0.0, 0.1, 0.2, 0.25}) {
    const auto ranges = sonar.Measure({0.0, 0.0, heading}, wall, {});
    // Beam 0 looks `heading` off the normal, which lies in its cone: the foot.
    const double foot = 2.0 - 0.15 * std::cos(heading);
    EXPECT_NEAR(ranges[0], 0.15 + foot, 0.5 * foot * 8e-5 + 1e-6) << heading;
  }
  // 45 deg off, half a cone less is 30 deg off the normal: 25 deg are heard.
  const auto oblique = sonar.Measure({0.0, 0.0, kPi / 4.0}, wall, {});
  EXPECT_EQ(oblique[0], 10.0f);
  EXPECT_EQ(oblique[8], 10.0f);  // Nothing behind.
  // 37 deg off, its edge is 22 deg off: heard along that edge.
  const double heading = RadiansFromDegrees(37.0);
  const auto edge = sonar.Measure({0.0, 0.0, heading}, wall, {});
  const double angle = RadiansFromDegrees(22.0);
  EXPECT_NEAR(
      edge[0], 0.15 + (2.0 - 0.15 * std::cos(heading)) / std::cos(angle), 1e-4);
}

TEST(RangeSensor, SonarHearsTheEdgeOfAPillarAtShortRangeOnly) {
  RangeSensorOptions options = Exact(RangeSensorOptions::SonarRing());
  // A corner that points at the robot: both sides 45 deg off.
  for (const double x : {0.8, 1.8}) {
    const ObstacleMap pillar(
        {{{x, 0.0}, {x + 0.3, 0.3}}, {{x, 0.0}, {x + 0.3, -0.3}}});
    RangeSensor sonar(options, 1);
    const auto ranges = sonar.Measure({}, pillar, {});
    if (x < options.edge_range) {
      EXPECT_NEAR(ranges[0], x, 0.02);  // A ray may pass beside the edge.
    } else {
      EXPECT_EQ(ranges[0], options.max_range);
    }
  }
}

TEST(RangeSensor, PeopleAreHeardAndHideWhatIsBehind) {
  const Disc2 person{{1.5, 0.0}, 0.25};
  RangeSensor lidar(Exact(RangeSensorOptions::Lidar()), 1);
  const auto light = lidar.Measure({}, Room(), {&person, 1});
  EXPECT_NEAR(light[180], 1.25, 1e-6);
  EXPECT_NEAR(light[180 + 30], ToRoom({0, 0}, RadiansFromDegrees(30.0)), 1e-6);
  RangeSensor sonar(Exact(RangeSensorOptions::SonarRing()), 1);
  const auto sound = sonar.Measure({}, Room(), {&person, 1});
  EXPECT_NEAR(sound[0], 1.25, 1e-4);
}

TEST(RangeSensor, NoiseIsAsStatedAndLostReadingsAreTheLimit) {
  RangeSensorOptions options = RangeSensorOptions::Lidar();
  options.sigma = 0.02;
  options.sigma_share = 0.01;
  options.drop_share = 0.1;
  options.bearing_step = 0.0;  // All beams ahead: 3 m.
  options.first_bearing = 0.0;
  RangeSensor lidar(options, 4);
  int num_lost = 0;
  int num_heard = 0;
  double sum = 0.0;
  double square = 0.0;
  for (int scan = 0; scan < 100; ++scan) {
    for (const float range : lidar.Measure({}, Room(), {})) {
      if (range == 8.0f) {
        ++num_lost;
        continue;
      }
      ++num_heard;
      sum += range - 3.0;
      square += (range - 3.0) * (range - 3.0);
    }
  }
  // Four standard deviations of each.
  const double n = num_lost + num_heard;
  EXPECT_NEAR(num_lost / n, 0.1, 4.0 * std::sqrt(0.1 * 0.9 / n));
  EXPECT_NEAR(sum / num_heard, 0.0, 4.0 * 0.05 / std::sqrt(num_heard));
  EXPECT_NEAR(square / num_heard / (0.05 * 0.05),
              1.0,
              4.0 * std::sqrt(2.0 / num_heard));
}

TEST(RangeSensor, WhatOneBeamMeetsChangesNoOtherBeamsNoise) {
  RangeSensor a(RangeSensorOptions::SonarRing(), 9);
  RangeSensor b(RangeSensorOptions::SonarRing(), 9);
  const Disc2 person{{1.5, 0.0}, 0.25};
  for (int scan = 0; scan < 10; ++scan) {
    const auto without = a.Measure({}, Room(), {});
    const auto with = b.Measure({}, Room(), {&person, 1});
    EXPECT_NE(with[0], without[0]);
    for (std::size_t i = 3; i < 14; ++i) EXPECT_EQ(with[i], without[i]) << i;
  }
}

TEST(RangeSensor, OptionsOutOfRangeAreNamed) {
  RangeSensorOptions options;
  options.num_beams = 0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = RangeSensorOptions::SonarRing();
  options.ring_radius = 5.0;  // Beyond its own reach.
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
