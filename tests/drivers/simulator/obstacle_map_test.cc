#include "drivers/simulator/obstacle_map.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

double DistanceTo(const Segment2& s, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = s.b - s.a;
  const double t =
      std::clamp(along.dot(p - s.a) / along.squaredNorm(), 0.0, 1.0);
  return (s.a + t * along - p).norm();
}

// Without a grid.
double PlainDistance(const ObstacleMap& map,
                     std::span<const Disc2> discs,
                     const Eigen::Vector2d& p) {
  double best = 1e9;
  for (const Segment2& s : map.segments()) {
    best = std::min(best, DistanceTo(s, p));
  }
  for (const Disc2& disc : discs) {
    best = std::min(best, (disc.p_W - p).norm() - disc.radius);
  }
  return best;
}

Eigen::Vector2d RandomPoint(Random* random) {
  return {random->Uniform(-6.0, 6.0), random->Uniform(-4.0, 4.0)};
}

struct RandomScene {
  ObstacleMap map{{}};
  std::vector<Disc2> discs;
};

RandomScene MakeScene(Random* random) {
  std::vector<Segment2> segments;
  const auto n = 1 + random->Index(30);
  for (std::uint64_t i = 0; i < n; ++i) {
    const Eigen::Vector2d a = RandomPoint(random);
    const double length = random->Uniform(0.01, 5.0);
    const double angle =
        random->Index(2) == 0
            ? random->Uniform(-kPi, kPi)
            : 0.5 * kPi * static_cast<double>(random->Index(4));
    segments.push_back(
        {a, a + length * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  RandomScene scene{ObstacleMap(segments), {}};
  for (std::uint64_t i = random->Index(4); i > 0; --i) {
    scene.discs.push_back({RandomPoint(random), random->Uniform(0.1, 0.4)});
  }
  return scene;
}

TEST(ObstacleMap, NearestAgreesWithTryingAllSegments) {
  Random random(SeedFor(1, "nearest"));
  for (int i = 0; i < 2000; ++i) {
    const RandomScene scene = MakeScene(&random);
    // Outside of the grid too.
    const Eigen::Vector2d p = 1.5 * RandomPoint(&random);
    const double truth = PlainDistance(scene.map, scene.discs, p);
    const double limit = random.Uniform(0.05, 4.0);
    const auto nearest = scene.map.Nearest(p, limit, scene.discs);
    ASSERT_EQ(nearest.has_value(), truth <= limit) << i;
    if (!nearest) continue;
    ASSERT_NEAR(nearest->distance, std::max(0.0, truth), 1e-12) << i;
    ASSERT_NEAR((nearest->p_W - p).norm(), nearest->distance, 1e-12) << i;
  }
}

TEST(ObstacleMap, RayAgreesWithTryingAllSegments) {
  Random random(SeedFor(1, "ray"));
  for (int i = 0; i < 5000; ++i) {
    const RandomScene scene = MakeScene(&random);
    const Eigen::Vector2d p = 1.5 * RandomPoint(&random);
    const double bearing =
        i % 4 == 0 ? 0.5 * kPi * static_cast<double>(random.Index(4))
                   : random.Uniform(-kPi, kPi);
    const auto hit = scene.map.CastRay(p, bearing, 8.0, scene.discs);
    const Eigen::Vector2d d(std::cos(bearing), std::sin(bearing));
    // Walks the ray by what is free: never past anything.
    double t = 0.0;
    double gap = 1.0;
    while (t < 8.0 && gap > 1e-7) {
      gap = std::max(0.0, PlainDistance(scene.map, scene.discs, p + t * d));
      t += gap;
    }
    if (gap > 1e-7) {
      EXPECT_FALSE(hit && hit->distance < 8.0 - 1e-6) << i;
      continue;
    }
    ASSERT_TRUE(hit.has_value()) << i << " " << t;
    // At grazing incidence the walk stops early.
    const double slack = 1e-6 / std::max(1e-3, std::cos(hit->incidence));
    ASSERT_NEAR(hit->distance, t, slack) << i;
  }
}

// A grid of 0.25 m would have 10^11 cells.
TEST(ObstacleMap, CellsGrowWhereSegmentsAreFarApart) {
  const double far = 8e4;
  const ObstacleMap map({{{2.0, -5.0}, {2.0, 5.0}},
                         {{-far, -far}, {-far, far}},
                         {{-far, far}, {far, far - 3.0}}});
  const auto hit = map.CastRay({0.0, 1.0}, 0.0, 10.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 2.0, 1e-9);
  const auto nearest = map.Nearest({1.0, 0.0}, 10.0);
  ASSERT_TRUE(nearest);
  EXPECT_NEAR(nearest->distance, 1.0, 1e-9);
  const auto side = map.CastRay({0.0, 1.0}, kPi, 1e5);
  ASSERT_TRUE(side);
  EXPECT_NEAR(side->distance, far, 1e-3);
}

// Slanting ones too: of 1000 of 560 m each the cells of their boxes would take
// half a minute.
TEST(ObstacleMap, LongSegmentsCostTheirLength) {
  std::vector<Segment2> segments;
  for (int i = 0; i < 1000; ++i) {
    const double shift = 1e-3 * i;
    segments.push_back({{-200.0 + shift, -200.0}, {200.0, 200.0 - shift}});
  }
  const ObstacleMap map(segments);
  for (const double x : {-150.0, 0.0, 31.0, 187.0}) {
    const auto nearest = map.Nearest({x, x + 1.0}, 5.0);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance, std::sqrt(0.5), 1e-9) << x;
  }
}

// Across the x axis at x = 2.
ObstacleMap WallAtTwo() {
  return ObstacleMap({{{2.0, -5.0}, {2.0, 5.0}}});
}

TEST(ObstacleMap, RayTellsAngleToNormal) {
  const ObstacleMap map = WallAtTwo();
  for (double bearing = -1.2; bearing < 1.25; bearing += 0.1) {
    const auto hit = map.CastRay({0.5, 0.3}, bearing, 20.0);
    ASSERT_TRUE(hit.has_value()) << bearing;
    EXPECT_NEAR(hit->distance, 1.5 / std::cos(bearing), 1e-12);
    EXPECT_NEAR(hit->incidence, std::abs(bearing), 1e-7);
  }
  const Disc2 person{{3.0, 0.0}, 0.5};
  const auto hit = ObstacleMap({}).CastRay({0.0, 0.3}, 0.0, 9.0, {&person, 1});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 3.0 - 0.4, 1e-12);
  EXPECT_NEAR(hit->incidence, std::asin(0.3 / 0.5), 1e-9);
}

TEST(ObstacleMap, ContactWithAWallIsWhereGeometryHasIt) {
  const ObstacleMap map = WallAtTwo();
  const auto ahead = map.FirstContact({0.0, 0.0, 0.3}, {40.0, 0.0}, 0.2);
  ASSERT_TRUE(ahead.has_value());
  const double way = 1.8 / std::cos(0.3);
  EXPECT_NEAR(ahead->share, way / 40.0, 1e-12);
  EXPECT_NEAR(ahead->p_W.x(), 2.0, 1e-12);
  EXPECT_NEAR(ahead->p_W.y(), way * std::sin(0.3), 1e-12);
  EXPECT_FALSE(map.FirstContact({0.0, 0.0, 0.3}, {-40.0, 0.0}, 0.2));
  EXPECT_FALSE(map.FirstContact({0.0, 0.0, 0.3}, {0.99 * way, 0.0}, 0.2));
  EXPECT_FALSE(map.FirstContact({1.8, 0.0, 0.0}, {0.0, 3.0}, 0.2));
  // Round its end.
  const auto end = map.FirstContact({0.0, 5.1, 0.0}, {9.0, 0.0}, 0.2);
  ASSERT_TRUE(end.has_value());
  EXPECT_NEAR(end->share * 9.0, 2.0 - std::sqrt(0.04 - 0.01), 1e-12);
  // A circle of 1 m to the left reaches x = 1 at most, one of 2.5 m the wall
  // where 2.5 sin(angle) = 1.8.
  EXPECT_FALSE(map.FirstContact({}, {2.0 * kPi, 2.0 * kPi}, 0.2));
  const auto curve = map.FirstContact({}, {2.5 * kPi, kPi}, 0.2);
  ASSERT_TRUE(curve.has_value());
  EXPECT_NEAR(curve->share * kPi, std::asin(1.8 / 2.5), 1e-4);
}

TEST(ObstacleMap, ATouchingDiscMayLeaveAndSlideButNotPush) {
  const ObstacleMap map = WallAtTwo();
  const Pose2 touching{1.8, 0.0, 0.0};
  EXPECT_TRUE(map.FirstContact(touching, {0.1, 0.0}, 0.2));
  EXPECT_FALSE(map.FirstContact(touching, {-0.1, 0.0}, 0.2));
  EXPECT_FALSE(map.FirstContact({1.8, 0.0, 0.5 * kPi}, {0.5, 0.0}, 0.2));
  EXPECT_FALSE(map.FirstContact({1.8, 0.0, 2.0}, {0.5, 0.0}, 0.2));
  // A person who came too near.
  const Disc2 person{{0.3, 0.0}, 0.25};
  EXPECT_TRUE(map.FirstContact({}, {0.1, 0.0}, 0.2, {&person, 1}));
  EXPECT_FALSE(map.FirstContact({}, {-0.1, 0.0}, 0.2, {&person, 1}));
}

// Whatever the step, the way up to the contact is free and no farther one
// could be taken.
TEST(ObstacleMap, NothingIsPassedThroughOnAnyArc) {
  Random random(SeedFor(1, "arc"));
  int num_contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    const RandomScene scene = MakeScene(&random);
    const Eigen::Vector2d p = RandomPoint(&random);
    const double radius = random.Uniform(0.05, 0.4);
    if (PlainDistance(scene.map, scene.discs, p) < radius) continue;
    const Pose2 X_WR{p.x(), p.y(), random.Uniform(-kPi, kPi)};
    const ArcMotion motion{random.Uniform(-15.0, 15.0),
                           random.Uniform(-12.0, 12.0)};
    const auto contact =
        scene.map.FirstContact(X_WR, motion, radius, scene.discs);
    const double share = contact ? contact->share : 1.0;
    for (int k = 0; k <= 200; ++k) {
      const Pose2 at = X_WR * PoseAlong(motion, share * k / 200.0);
      ASSERT_GT(PlainDistance(scene.map, scene.discs, at.position()),
                radius - 1.01 * ObstacleMap::kMaxSagitta)
          << i;
    }
    if (!contact) continue;
    ++num_contacts;
    const Pose2 at = X_WR * PoseAlong(motion, share);
    ASSERT_NEAR((contact->p_W - at.position()).norm(),
                radius,
                1.01 * ObstacleMap::kMaxSagitta)
        << i;
  }
  EXPECT_GT(num_contacts, 500);
}

TEST(ObstacleMap, EmptyMapIsFree) {
  const ObstacleMap map({});
  EXPECT_FALSE(map.Nearest({1.0, 2.0}, 100.0));
  EXPECT_FALSE(map.CastRay({1.0, 2.0}, 0.3, 100.0));
  EXPECT_FALSE(map.FirstContact({}, {50.0, 2.0}, 0.3));
}

}  // namespace
}  // namespace waymark
