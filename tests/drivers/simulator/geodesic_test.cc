#include "drivers/simulator/geodesic.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"
#include "tests/support/rectangle_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

constexpr double kRadius = 0.17;

// What the header promises, of an exact length.
double Slack(double length) {
  return 0.001 * length + 0.002;
}

void ExpectLength(const std::optional<GeodesicPath>& path, double length) {
  ASSERT_TRUE(path.has_value());
  EXPECT_GT(path->length, length - 1e-6);
  EXPECT_LT(path->length, length + Slack(length));
}

double ClearanceOf(const GeodesicPath& path, const ObstacleMap& map) {
  double least = 1e9;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    for (int k = 0; k <= 20; ++k) {
      const Eigen::Vector2d p =
          path.points[i - 1] + k / 20.0 * (path.points[i] - path.points[i - 1]);
      if (const auto near = map.Nearest(p, 1.0)) {
        least = std::min(least, near->distance);
      }
    }
  }
  return least;
}

// From p to q, the far way round the point c at a distance of kRadius: two
// tangents and the arc between them.
double RoundAPoint(const Eigen::Vector2d& p,
                   const Eigen::Vector2d& c,
                   const Eigen::Vector2d& q) {
  const double dp = (p - c).norm();
  const double dq = (q - c).norm();
  const double angle = 2.0 * kPi - std::acos((p - c).dot(q - c) / dp / dq) -
                       std::acos(kRadius / dp) - std::acos(kRadius / dq);
  return std::sqrt(dp * dp - kRadius * kRadius) +
         std::sqrt(dq * dq - kRadius * kRadius) + kRadius * angle;
}

TEST(Geodesic, FreeWaysAreStraight) {
  const ObstacleMap map({{{0.0, 1.0}, {5.0, 1.0}}});
  const auto path = Geodesic(map, kRadius).Shortest({0.0, 0.0}, {4.0, 0.7});
  ASSERT_TRUE(path.has_value());
  EXPECT_DOUBLE_EQ(path->length, std::hypot(4.0, 0.7));
}

TEST(Geodesic, RoundTheEndOfAWall) {
  // A wall from far above down to the origin; outside of the box nothing is
  // nearer.
  const ObstacleMap map({{{0.0, 0.0}, {0.0, 6.0}}});
  const Geodesic geodesic(map, kRadius);
  Random random(SeedFor(1, "round"));
  for (int i = 0; i < 15; ++i) {
    const Eigen::Vector2d p(random.Uniform(-0.38, -0.2),
                            random.Uniform(0.5, 2.4));
    const Eigen::Vector2d q(random.Uniform(0.2, 0.38),
                            random.Uniform(0.5, 2.4));
    const auto path = geodesic.Shortest(p, q);
    ASSERT_TRUE(path.has_value());
    ExpectLength(path, RoundAPoint(p, {0.0, 0.0}, q));
    EXPECT_GT(ClearanceOf(*path, map), kRadius - 1e-9);
  }
}

TEST(Geodesic, RoundASquarePillarOnTheShorterSide) {
  // 1 m square about the origin in a hall of 10 x 8 m.
  const ObstacleMap map(RectangleWalls(
      {-5.0, -4.0}, {5.0, 4.0}, RectangleWalls({-0.5, -0.5}, {0.5, 0.5})));
  const Geodesic geodesic(map, kRadius);
  for (double y = -0.4; y < 0.45; y += 0.1) {
    // Round the upper corners: tangent, arc, along the top, arc, tangent.
    const auto side = [&](double from_y) {
      const Eigen::Vector2d to(3.0 - 0.5, 0.5 - from_y);
      const double d = to.norm();
      // Angle of the arc: from the top's direction down to the tangent's.
      const double climb = std::atan2(to.y(), to.x()) + std::asin(kRadius / d);
      return std::sqrt(d * d - kRadius * kRadius) + kRadius * climb;
    };
    const double over = side(y) + 1.0 + side(-0.1);
    const double under = side(-y) + 1.0 + side(0.1);
    ExpectLength(geodesic.Shortest({-3.0, y}, {3.0, -0.1}),
                 std::min(over, under));
  }
}

TEST(Geodesic, RoundAPillarOfManySides) {
  std::vector<Segment2> sides;
  constexpr int kSides = 64;
  const auto corner = [](int i) {
    const double angle = 2.0 * kPi * i / kSides;
    return Eigen::Vector2d(std::cos(angle), std::sin(angle));
  };
  for (int i = 0; i < kSides; ++i) sides.push_back({corner(i), corner(i + 1)});
  const ObstacleMap map(sides);
  const Geodesic geodesic(map, kRadius, 0.1);
  const double r = 1.0 + kRadius;
  const Eigen::Vector2d p(-1.19, 0.05);
  const Eigen::Vector2d q(1.19, 0.05);
  const double angle =
      kPi - 2.0 * std::atan2(0.05, 1.19) - 2.0 * std::acos(r / p.norm());
  const double exact = 2.0 * std::sqrt(p.squaredNorm() - r * r) + r * angle;
  const auto path = geodesic.Shortest(p, q);
  ASSERT_TRUE(path.has_value());
  // The polygon lies up to 1.2 mm inside of its circle.
  EXPECT_NEAR(path->length, exact, 0.0012 * kPi + Slack(exact));
}

TEST(Geodesic, ThroughTwoDoors) {
  // Three rooms in a row; doors of 0.9 m up in the one wall, down in the other.
  const ObstacleMap map(RectangleWalls({0.0, 0.0},
                                       {9.0, 4.0},
                                       {{{3.0, 0.0}, {3.0, 2.9}},
                                        {{3.0, 3.8}, {3.0, 4.0}},
                                        {{6.0, 1.1}, {6.0, 4.0}},
                                        {{6.0, 0.0}, {6.0, 0.2}}}));
  // Over the first door's lower edge c1 and under the second's upper edge c2:
  // between them a tangent that crosses the line of centres.
  const Eigen::Vector2d p(0.5, 0.5), q(8.5, 3.5), c1(3.0, 2.9), c2(6.0, 1.1);
  const double d = (c2 - c1).norm();
  const double down = std::atan2(c1.y() - c2.y(), c2.x() - c1.x()) +
                      std::asin(2.0 * kRadius / d);
  const double tangent = std::sqrt(d * d - 4.0 * kRadius * kRadius);
  const auto outer = [&](const Eigen::Vector2d& to) {
    const double n = to.norm();
    const double climb = std::atan2(to.y(), to.x()) + std::asin(kRadius / n);
    return std::pair(std::sqrt(n * n - kRadius * kRadius), climb);
  };
  const auto [first, climb1] = outer(c1 - p);
  const auto [last, climb2] = outer(q - c2);
  const double exact = first + kRadius * (climb1 + down) + tangent +
                       kRadius * (down + climb2) + last;
  const auto path = Geodesic(map, kRadius).Shortest(p, q);
  ASSERT_TRUE(path.has_value());
  EXPECT_GT(ClearanceOf(*path, map), kRadius - 1e-9);
  ExpectLength(path, exact);
}

TEST(Geodesic, NoWayIsNoLength) {
  // A gap of 0.3 m.
  const ObstacleMap map(
      RectangleWalls({0.0, 0.0},
                     {4.0, 2.0},
                     {{{2.0, 0.0}, {2.0, 0.9}}, {{2.0, 1.2}, {2.0, 2.0}}}));
  const Geodesic wide(map, kRadius);
  EXPECT_FALSE(wide.Shortest({1.0, 1.0}, {3.0, 1.0}));
  EXPECT_FALSE(wide.Shortest({1.0, 1.0}, {9.0, 1.0}));   // Outside.
  EXPECT_FALSE(wide.Shortest({1.0, 1.0}, {0.05, 1.0}));  // In the wall.
  const Geodesic slim(map, 0.1);
  const auto path = slim.Shortest({1.0, 0.5}, {3.0, 0.5});
  ASSERT_TRUE(path.has_value());
  // Cells of the near half: less a rim as wide as the robot.
  const auto half = wide.ReachableFrom({1.0, 1.0});
  const double area = static_cast<double>(half.size()) * 0.03 * 0.03;
  EXPECT_NEAR(area, 1.66 * 1.66, 2.0 * 0.1 * 1.66);
  for (const Eigen::Vector2d& p : half) EXPECT_LT(p.x(), 2.0);
  EXPECT_THROW(Geodesic(map, 0.01), std::invalid_argument);
}

// Straight lines between random free points bound it from below; going by a
// third point from above.
TEST(Geodesic, IsAMetric) {
  Random random(SeedFor(1, "metric"));
  std::vector<Segment2> walls{{{-4.0, -3.0}, {4.0, -3.0}},
                              {{4.0, -3.0}, {4.0, 3.0}},
                              {{4.0, 3.0}, {-4.0, 3.0}},
                              {{-4.0, 3.0}, {-4.0, -3.0}}};
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d a(random.Uniform(-4, 4), random.Uniform(-3, 3));
    const double angle = random.Uniform(-kPi, kPi);
    walls.push_back({a, a + Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  const ObstacleMap map(walls);
  const Geodesic geodesic(map, kRadius);
  const auto cells = geodesic.ReachableFrom({0.0, 0.0});
  ASSERT_GT(cells.size(), 1000u);
  for (int i = 0; i < 12; ++i) {
    const auto pick = [&] { return cells[random.Index(cells.size())]; };
    const Eigen::Vector2d a = pick(), b = pick(), c = pick();
    const auto ab = geodesic.Shortest(a, b);
    const auto ba = geodesic.Shortest(b, a);
    const auto ac = geodesic.Shortest(a, c);
    const auto cb = geodesic.Shortest(c, b);
    ASSERT_TRUE(ab && ba && ac && cb) << i;
    EXPECT_GT(ClearanceOf(*ab, map), kRadius - 1e-9) << i;
    EXPECT_GE(ab->length, (a - b).norm() - 1e-9);
    EXPECT_NEAR(ab->length, ba->length, 0.01 * ab->length + 0.002) << i;
    EXPECT_LE(ab->length, 1.01 * (ac->length + cb->length) + 0.002) << i;
  }
}

}  // namespace
}  // namespace waymark
