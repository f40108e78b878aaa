#include "estimation/camera/hyperbolic_mirror.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace waymark {
namespace {

const HyperbolicMirror kMirror{.a = 0.0281, .b = 0.0234};

Eigen::Vector3d RandomRay(Random* random) {
  const double z = random->Uniform(-0.75, 1.0);
  const double azimuth = random->Uniform(-kPi, kPi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

// The mirror as physics has it: light that comes in along the ray toward the
// viewpoint leaves the mirror toward the lens.
TEST(HyperbolicMirror, ReflectsEveryRayIntoTheLens) {
  Random random(3);
  const Eigen::Vector3d lens(0.0, 0.0, 2.0 * kMirror.focal_distance());
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d ray = RandomRay(&random);
    const auto point = kMirror.PointOnMirror(ray);
    ASSERT_TRUE(point);
    // On the hyperboloid about the middle between the foci.
    const double z = point->z() - kMirror.focal_distance();
    EXPECT_NEAR(z * z / (kMirror.a * kMirror.a) -
                    point->head<2>().squaredNorm() / (kMirror.b * kMirror.b),
                1.0,
                1e-9);
    const Eigen::Vector3d normal = kMirror.NormalAt(*point);
    const Eigen::Vector3d incoming = -ray;
    const Eigen::Vector3d outgoing =
        incoming - 2.0 * incoming.dot(normal) * normal;
    const Eigen::Vector3d to_lens = (lens - *point).normalized();
    EXPECT_LT(outgoing.cross(to_lens).norm(), 1e-9);
    EXPECT_GT(outgoing.dot(to_lens), 0.0);
  }
}

// The lens's own image of the point on the mirror is the sphere camera's.
TEST(HyperbolicMirror, SphereCameraSeesWhatTheLensSees) {
  Random random(4);
  const Intrinsics lens{810.0, -805.0, 322.0, 318.0};
  const SphereCamera camera = CameraFromMirror(kMirror, lens);
  const double e = kMirror.eccentricity();
  EXPECT_NEAR(camera.xi(), 2.0 * e / (1.0 + e * e), 1e-15);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d ray = RandomRay(&random);
    const Eigen::Vector3d point = *kMirror.PointOnMirror(ray);
    const double depth = 2.0 * kMirror.focal_distance() - point.z();
    const Eigen::Vector2d seen(lens.cx + lens.fx * point.x() / depth,
                               lens.cy + lens.fy * point.y() / depth);
    const auto projection = camera.PixelFromRay(ray);
    ASSERT_TRUE(projection);
    EXPECT_LT((projection->pixel - seen).norm(), 1e-9);
    // And its rays come from the one viewpoint.
    const auto back = camera.RayFromPixel(seen);
    ASSERT_TRUE(back);
    EXPECT_LT(back->ray.cross(ray).norm(), 1e-9);
  }
}

TEST(HyperbolicMirror, RaysThatMissItHaveNoPoint) {
  const double edge = -kMirror.a / kMirror.focal_distance();
  const auto ray = [](double z) {
    return Eigen::Vector3d(std::sqrt(1.0 - z * z), 0.0, z);
  };
  EXPECT_FALSE(kMirror.PointOnMirror(ray(edge - 1e-6)));
  EXPECT_TRUE(kMirror.PointOnMirror(ray(edge + 1e-6)));
}

}  // namespace
}  // namespace waymark
