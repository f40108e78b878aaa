// Properties that every camera model has.
#include "estimation/camera/camera_model.h"

#include "estimation/base/random.h"
#include "estimation/camera/camera_parameters.h"
#include "estimation/camera/hyperbolic_mirror.h"
#include "estimation/geometry/angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace waymark {
namespace {

struct Case {
  std::string name;
  CameraModel camera;
  double max_angle;  // Of rays that are tried, from z (panorama: elevation).
};

// Rounded from calibrations of real cameras: a webcam, the wide-angle camera
// of a robot, a mirror camera.
const Intrinsics kLens{674.9, 671.2, 307.5, 251.4};
const LensDistortion kBarrel{-0.28, 0.08, 1.2e-3, -4e-4, 0.0};

std::vector<Case> Cases() {
  return {{"pinhole", PerspectiveCamera(kLens), 1.2},
          {"perspective", PerspectiveCamera(kLens, kBarrel), 0.7},
          {"fisheye",
           FisheyeCamera({182.3, 182.3, 321.0, 248.6},
                         {0.067955, -0.044254, 0.013958, -0.002250}),
           1.5},
          {"fisheye behind", FisheyeCamera({150.0, 150.0, 300.0, 300.0}), 3.0},
          {"parabolic", SphereCamera(1.0, {260.0, 260.0, 320.0, 240.0}), 2.4},
          {"hyperbolic",
           CameraFromMirror({.a = 0.0281, .b = 0.0234},
                            {800.0, -800.0, 320.0, 320.0}),
           2.1},
          {"wide lens",
           SphereCamera(1.7, {900.0, 900.0, 640.0, 480.0}, {-0.05, 0.01}),
           1.2},
          {"panorama", PanoramaCamera::WholeTurn({1024, 256}, 127.5), 1.2}};
}

class CameraModelTest : public testing::TestWithParam<Case> {
 protected:
  // Somewhere in the stated part of the domain.
  Eigen::Vector3d Ray() {
    const Case& c = GetParam();
    const double azimuth = random_.Uniform(-kPi, kPi);
    if (c.name == "panorama") {
      const double elevation = random_.Uniform(-c.max_angle, c.max_angle);
      return {std::cos(elevation) * std::sin(azimuth),
              std::sin(elevation),
              std::cos(elevation) * std::cos(azimuth)};
    }
    const double angle = random_.Uniform(0.0, c.max_angle);
    return {std::sin(angle) * std::cos(azimuth),
            std::sin(angle) * std::sin(azimuth),
            std::cos(angle)};
  }

  Random random_{7};
};

TEST_P(CameraModelTest, RayComesBackFromItsPixel) {
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d ray = Ray();
    const double distance = random_.Uniform(0.1, 30.0);
    const auto there = PixelFromRay(GetParam().camera, distance * ray);
    ASSERT_TRUE(there) << ray.transpose();
    const auto back = RayFromPixel(GetParam().camera, there->pixel);
    ASSERT_TRUE(back) << ray.transpose();
    EXPECT_NEAR(back->ray.norm(), 1.0, 1e-15);
    EXPECT_LT((back->ray - ray).norm(), 1e-11) << ray.transpose();
  }
}

TEST_P(CameraModelTest, JacobiansAreTheNumericOnes) {
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = random_.Uniform(0.5, 3.0) * Ray();
    const auto there = PixelFromRay(GetParam().camera, point);
    ASSERT_TRUE(there);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const auto plus = PixelFromRay(GetParam().camera, point + step);
      const auto minus = PixelFromRay(GetParam().camera, point - step);
      if (!plus || !minus) continue;  // Over the edge.
      const Eigen::Vector2d numeric =
          (plus->pixel - minus->pixel) / (2.0 * kStep);
      if (numeric.norm() > 1e6) continue;  // Over the panorama's seam.
      EXPECT_LT((numeric - there->d_point.col(k)).norm(),
                1e-6 * (1.0 + there->d_point.norm()))
          << point.transpose();
    }
    const auto back = RayFromPixel(GetParam().camera, there->pixel);
    ASSERT_TRUE(back);
    // Forth and back is no change; the bearing stays a unit vector.
    const Eigen::Matrix2d product =
        there->d_point * point.norm() * back->d_pixel;
    EXPECT_LT((product - Eigen::Matrix2d::Identity()).norm(), 1e-8);
    EXPECT_LT((back->ray.transpose() * back->d_pixel).norm(), 1e-10);
  }
}

TEST_P(CameraModelTest, JacobiansByParametersAreTheNumericOnes) {
  const CameraKind kind = KindOf(GetParam().camera);
  const Eigen::VectorXd values = ParametersOf(GetParam().camera);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    // The first is on the axis, where a fisheye's formulas have no direction.
    const Eigen::Vector3d point =
        i == 0 ? Eigen::Vector3d(0.0, 0.0, 2.0)
               : (random_.Uniform(0.5, 3.0) * Ray()).eval();
    const auto analytic = PixelByParameters(GetParam().camera, point);
    ASSERT_TRUE(analytic);
    ASSERT_EQ(analytic->cols(), values.size());
    for (Eigen::Index p = 0; p < values.size(); ++p) {
      const Eigen::VectorXd step =
          kStep * Eigen::VectorXd::Unit(values.size(), p);
      const auto plus =
          PixelFromRay(CameraFromParameters(kind, values + step), point);
      const auto minus =
          PixelFromRay(CameraFromParameters(kind, values - step), point);
      if (!plus || !minus) continue;  // Over the edge.
      const Eigen::Vector2d numeric =
          (plus->pixel - minus->pixel) / (2.0 * kStep);
      // Pixels of some thousand have 1e-12 of rounding, over the step.
      EXPECT_LT((numeric - analytic->col(p)).norm(),
                1e-6 * (1.0 + analytic->col(p).norm()))
          << ParameterNames(kind)[static_cast<std::size_t>(p)] << " at "
          << point.transpose();
    }
  }
  EXPECT_FALSE(PixelByParameters(GetParam().camera, Eigen::Vector3d::Zero()));
}

TEST_P(CameraModelTest, NothingComesOfNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_FALSE(PixelFromRay(GetParam().camera, {bad, 0.0, 1.0}));
    EXPECT_FALSE(PixelFromRay(GetParam().camera, {0.0, 0.0, bad}));
    EXPECT_FALSE(RayFromPixel(GetParam().camera, {bad, 10.0}));
    EXPECT_FALSE(RayFromPixel(GetParam().camera, {10.0, bad}));
  }
  EXPECT_FALSE(PixelFromRay(GetParam().camera, Eigen::Vector3d::Zero()));
}

TEST_P(CameraModelTest, EveryPixelWithARayIsSeenThere) {
  // Far outside the image too: a ray is only given where it comes back.
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d pixel(random_.Uniform(-2000.0, 3000.0),
                                random_.Uniform(-2000.0, 3000.0));
    const auto back = RayFromPixel(GetParam().camera, pixel);
    if (!back) continue;
    const auto there = PixelFromRay(GetParam().camera, back->ray);
    ASSERT_TRUE(there) << pixel.transpose();
    EXPECT_LT((there->pixel - pixel).norm(), 1e-6) << pixel.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Models,
                         CameraModelTest,
                         testing::ValuesIn(Cases()),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           for (char& c : name) {
                             if (c == ' ') c = '_';
                           }
                           return name;
                         });

TEST(CameraDomain, EndsWhereTheModelHasNoInverse) {
  const PerspectiveCamera barrel(kLens, {.k1 = -0.28});
  EXPECT_LT(barrel.max_radius(), 2.0);
  EXPECT_FALSE(barrel.PixelFromRay({1.001 * barrel.max_radius(), 0.0, 1.0}));
  EXPECT_TRUE(barrel.PixelFromRay({0.999 * barrel.max_radius(), 0.0, 1.0}));
  EXPECT_FALSE(barrel.PixelFromRay({0.0, 0.0, -1.0}));
  // The pixel of a radius beyond the edge is that of none within it.
  EXPECT_FALSE(barrel.RayFromPixel({kLens.cx + 2.0 * kLens.fx, kLens.cy}));

  const SphereCamera mirror(0.9, kLens);
  EXPECT_DOUBLE_EQ(mirror.min_z(), -0.9);
  EXPECT_FALSE(mirror.PixelFromRay({0.1, 0.0, -1.0}));
  const SphereCamera wide(2.0, kLens);
  EXPECT_DOUBLE_EQ(wide.min_z(), -0.5);
  EXPECT_FALSE(wide.PixelFromRay({0.8, 0.0, -0.6}));
  EXPECT_FALSE(wide.RayFromPixel({kLens.cx + kLens.fx, kLens.cy}));

  const FisheyeCamera fisheye(kLens, {-0.1, 0.0, 0.0, 0.0});
  EXPECT_NEAR(fisheye.max_angle(), std::sqrt(1.0 / 0.3), 1e-12);
}

TEST(CameraDomain, ImpossibleIntrinsicsAreNamed) {
  const auto message_of = [](auto make) -> std::string {
    try {
      (void)make();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of([] {
              return PerspectiveCamera({0.0, 1.0, 0.0, 0.0});
            }),
            "fx is 0");
  EXPECT_EQ(message_of([&] {
              return FisheyeCamera(kLens, {0.0, 0.0, nan, 0.0});
            }),
            "k3 is not finite");
  EXPECT_EQ(message_of([] { return SphereCamera(-0.1, kLens); }),
            "xi is negative");
  EXPECT_EQ(
      message_of([] { return CameraFromMirror({.a = 0.0, .b = 1.0}, kLens); }),
      "a is not a positive length");
  EXPECT_EQ(message_of([] {
              return PanoramaCamera::WholeTurn({0, 10}, 5.0);
            }),
            "a panorama's size is not positive");
}

TEST(Panorama, RightOfForwardIsRightInTheImage) {
  const ImageSize size{1024, 256};
  const PanoramaCamera camera = PanoramaCamera::WholeTurn(size, 127.5);
  EXPECT_DOUBLE_EQ(camera.PixelFromRay({0.0, 0.0, 1.0})->pixel.x(), 511.5);
  EXPECT_DOUBLE_EQ(camera.PixelFromRay({1.0, 0.0, 0.0})->pixel.x(), 767.5);
  EXPECT_GT(camera.PixelFromRay({0.0, 1.0, 1.0})->pixel.y(), 127.5);
  // A whole turn is the image's width, edge to edge.
  EXPECT_TRUE(IsInside(size, camera.PixelFromRay({1e-12, 0.0, -1.0})->pixel));
  EXPECT_TRUE(IsInside(size, camera.PixelFromRay({-1e-12, 0.0, -1.0})->pixel));
}

}  // namespace
}  // namespace waymark
