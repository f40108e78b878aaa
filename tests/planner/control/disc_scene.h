// Posts and walls in the plane, for tests of what drives among them.
#pragma once

#include "estimation/base/random.h"
#include "estimation/base/time.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose2.h"
#include "planner/control/velocity_guard.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace waymark {

struct DiscScene {
  struct Post {
    Eigen::Vector2d p_W;
    double radius = 0.1;
  };
  struct Wall {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  std::vector<Post> posts;
  std::vector<Wall> walls;

  // From a point to the nearest surface, m.
  [[nodiscard]] double Distance(const Eigen::Vector2d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Post& post : posts) {
      least = std::min(least, (p - post.p_W).norm() - post.radius);
    }
    for (const Wall& wall : walls) {
      const Eigen::Vector2d way = wall.to - wall.from;
      const double share =
          std::clamp((p - wall.from).dot(way) / way.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (p - wall.from - share * way).norm());
    }
    return least;
  }

  // Along a ray at `angle` in R; `limit` where there is nothing nearer.
  [[nodiscard]] double Range(const Pose2& X_WR,
                             double angle,
                             double limit) const {
    const double a = X_WR.heading + angle;
    const Eigen::Vector2d n(std::cos(a), std::sin(a));
    double range = limit;
    for (const Post& post : posts) {
      const Eigen::Vector2d d = post.p_W - X_WR.position();
      const double along = d.dot(n);
      const double beside2 = d.squaredNorm() - along * along;
      const double half2 = post.radius * post.radius - beside2;
      if (half2 <= 0.0 || along <= 0.0) continue;
      range = std::min(range, along - std::sqrt(half2));
    }
    for (const Wall& wall : walls) {
      // X_WR + r n = from + u way.
      const Eigen::Vector2d way = wall.to - wall.from;
      const Eigen::Vector2d d = wall.from - X_WR.position();
      const double det = n.x() * way.y() - n.y() * way.x();
      if (std::abs(det) < 1e-12) continue;
      const double r = (d.x() * way.y() - d.y() * way.x()) / det;
      const double u = (d.x() * n.y() - d.y() * n.x()) / det;
      if (r > 0.0 && u >= 0.0 && u <= 1.0) range = std::min(range, r);
    }
    return range;
  }
};

// A room with posts and walls in it; the origin is `free` away from all.
inline DiscScene RandomScene(Random* random, double free) {
  DiscScene scene;
  const double half = random->Uniform(1.0, 3.0);
  scene.walls = {{{-half, -half}, {half, -half}},
                 {{half, -half}, {half, half}},
                 {{half, half}, {-half, half}},
                 {{-half, half}, {-half, -half}}};
  const auto place = [&] {
    return Eigen::Vector2d(random->Uniform(-half, half),
                           random->Uniform(-half, half));
  };
  for (int i = 0; i < 8; ++i) {
    DiscScene one;
    if (i % 2 == 0) {
      one.posts.push_back({place(), random->Uniform(0.03, 0.3)});
    } else {
      const DiscScene::Wall wall{place(), place()};
      one.walls.push_back(wall);
      // A wall without thickness could not be seen from its end.
      one.posts = {{wall.from, 0.03}, {wall.to, 0.03}};
    }
    if (one.Distance({0.0, 0.0}) < free) continue;
    scene.posts.insert(scene.posts.end(), one.posts.begin(), one.posts.end());
    scene.walls.insert(scene.walls.end(), one.walls.begin(), one.walls.end());
  }
  return scene;
}

inline Time At(double s) {
  return TimeFromMicroseconds(1'000'000) + DurationFromSeconds(s);
}

// What a lidar in the middle of `scene` sees from X_WR.
inline RangeScan ScanOf(const DiscScene& scene, const Pose2& X_WR, double s) {
  RangeScan scan{At(s), -kPi, kPi / 180.0, {}};
  for (int i = 0; i < 360; ++i) {
    scan.ranges.push_back(
        scene.Range(X_WR, scan.first_angle + i * scan.step, 5.0));
  }
  return scan;
}

}  // namespace waymark
