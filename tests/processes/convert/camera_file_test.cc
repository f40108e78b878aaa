#include "processes/convert/camera_file.h"

#include "estimation/base/input_error.h"
#include "estimation/camera/camera_parameters.h"
#include "estimation/camera/pan_tilt_mount.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

std::string ErrorOf(const std::string& yaml) {
  try {
    (void)CameraFromYaml(yaml, "camera.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<CameraModel> Models() {
  const Intrinsics k{330.1, -331.7, 641.2, 522.6};
  return {PerspectiveCamera({901.0, 905.0, 652.0, 498.0},
                            {-0.21, 0.06, 8e-4, -5e-4, 1e-3}),
          FisheyeCamera({352.0, 351.0, 633.0, 520.0},
                        {0.03, -0.012, 0.004, -0.001}),
          SphereCamera(0.96, k, {-0.05, 0.01}),
          PanoramaCamera::WholeTurn({1024, 256}, 127.5)};
}

TEST(CameraFile, LoadsWhatWasWritten) {
  for (const CameraModel& model : Models()) {
    CameraDescription camera;
    camera.model = model;
    camera.size = {1280, 1024};
    camera.X_RC.linear() = (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                            Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                            Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitX()))
                               .toRotationMatrix() *
                           ForwardCameraRotation();
    camera.X_RC.translation() << 0.1, -0.02, 0.6;
    if (KindOf(model) == CameraKind::kSphere) {
      camera.p_RH = Eigen::Vector3d(0.05, 0.0, 0.5);
    }
    const std::string yaml = YamlOfCamera(camera);
    const CameraDescription loaded = CameraFromYaml(yaml, "x");
    EXPECT_EQ(ParametersOf(loaded.model), ParametersOf(model)) << yaml;
    EXPECT_EQ(loaded.model.index(), model.index());
    EXPECT_EQ(loaded.size, camera.size);
    EXPECT_LT((loaded.X_RC.matrix() - camera.X_RC.matrix()).norm(), 1e-14)
        << yaml;
    EXPECT_EQ(loaded.p_RH, camera.p_RH) << yaml;
  }
}

TEST(CameraFile, MountingIsAsItSays) {
  const CameraDescription camera = CameraFromYaml(
      "model: perspective\nwidth: 640\nheight: 480\nfx: 500\nfy: 500\n"
      "cx: 320\ncy: 240\n"
      "mounting:\n  z: 1.0\n  pitch_deg: 45.0\n  yaw_deg: 90.0\n",
      "x");
  // To the left and down by the same amount.
  const Eigen::Vector3d sight = camera.X_RC.linear() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(
      (sight - Eigen::Vector3d(0.0, std::sqrt(0.5), -std::sqrt(0.5))).norm(),
      1e-15);
  // The camera's right is the robot's front.
  EXPECT_LT((camera.X_RC.linear() * Eigen::Vector3d::UnitX() -
             Eigen::Vector3d::UnitX())
                .norm(),
            1e-15);
  EXPECT_EQ(camera.X_RC.translation(), Eigen::Vector3d(0.0, 0.0, 1.0));
}

// A mirror camera looks straight up or down: yaw and roll are one turn there.
TEST(CameraFile, CamerasThatLookUpOrDownLoadBack) {
  for (const double pitch : {-90.0, 90.0, 90.0 - 1e-8, 89.0}) {
    for (const double yaw : {-170.0, -90.0, 0.0, 30.0, 135.0}) {
      CameraDescription camera;
      camera.size = {4, 4};
      camera.X_RC.linear() =
          (Eigen::AngleAxisd(yaw * kPi / 180.0, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(pitch * kPi / 180.0, Eigen::Vector3d::UnitY()))
              .toRotationMatrix() *
          ForwardCameraRotation();
      // Twice, since what was loaded differs by rounding.
      CameraDescription again = camera;
      for (int i = 0; i < 2; ++i) {
        again = CameraFromYaml(YamlOfCamera(again), "again");
      }
      // The distance below which a camera counts as vertical, twice.
      EXPECT_LT((again.X_RC.matrix() - camera.X_RC.matrix()).norm(), 4e-9)
          << pitch << " " << yaw;
    }
  }
}

// a 3, b 4 have c = 5: e = 5 / 3, xi = 2 e / (1 + e^2) = 15 / 17.
TEST(CameraFile, AHyperbolicMirrorByItsSemiAxes) {
  const CameraDescription camera = CameraFromYaml(
      "model: sphere\nwidth: 640\nheight: 640\nfx: 680\nfy: -680\n"
      "cx: 320\ncy: 320\nmirror: [0.03, 0.04]\n",
      "camera.yaml");
  const auto& sphere = std::get<SphereCamera>(camera.model);
  EXPECT_NEAR(sphere.xi(), 15.0 / 17.0, 1e-15);
  // Times (e^2 - 1) / (e^2 + 1) = 8 / 17.
  EXPECT_NEAR(sphere.intrinsics().fx, 320.0, 1e-12);
  EXPECT_NEAR(sphere.intrinsics().fy, -320.0, 1e-12);
}

TEST(CameraFile, BadOnesAreOneLine) {
  const std::string good =
      "model: sphere\nwidth: 640\nheight: 480\nfx: 300\nfy: -300\ncx: 320\n"
      "cy: 240\nxi: 0.9\n";
  EXPECT_EQ(ErrorOf(good), "no error");
  EXPECT_THAT(ErrorOf(good + "k4: 0.1\n"), HasSubstr("k4"));
  EXPECT_THAT(ErrorOf("model: pinhole\n"),
              HasSubstr("perspective, fisheye, sphere, panorama"));
  EXPECT_THAT(ErrorOf("model: sphere\nwidth: 640\nheight: 480\nxi: 0.9\n"),
              HasSubstr("fx"));
  EXPECT_THAT(ErrorOf("model: sphere\nfx: 1\nfy: 1\n"),
              HasSubstr("width and height are missing"));
  EXPECT_THAT(ErrorOf(good + "mounting:\n  pitch_deg: 120\n"),
              HasSubstr("[-90, 90]"));
  EXPECT_THAT(ErrorOf(good + "mounting:\n  head: [0, 0]\n"),
              HasSubstr("mounting.head"));
  EXPECT_THAT(ErrorOf(good + "mounting:\n  head: [0, 0, 500]\n"),
              HasSubstr("mounting.head must be within +-100 m"));
  EXPECT_THAT(ErrorOf("width: 0\n"), HasSubstr("[1, 16384]"));
  EXPECT_THAT(ErrorOf("fx: .nan\n"), HasSubstr("fx"));
  EXPECT_THAT(ErrorOf("width: 9\nheight: 9\nfy: 3\n"),
              HasSubstr("fx and fy must be given"));
  EXPECT_THAT(ErrorOf("width: 16384\nheight: 16384\nfx: 9\nfy: 9\n"),
              HasSubstr("at most 67108864 pixels"));
  EXPECT_THAT(ErrorOf("model: sphere\nxi: 1e300\n"), HasSubstr("[0, 100]"));
  const std::string mirror =
      "model: sphere\nwidth: 9\nheight: 9\nfx: 9\nfy: 9\nmirror: ";
  EXPECT_THAT(ErrorOf(mirror + "[1, 1]\nxi: 0.5\n"),
              HasSubstr("mirror must not be beside xi"));
  EXPECT_THAT(ErrorOf(mirror + "[1, -1]\n"), HasSubstr("b"));
}

TEST(CameraFile, AllThatComeWithWaymarkLoad) {
  for (const char* name : {"perspective", "fisheye", "mirror", "panorama"}) {
    const CameraDescription camera = LoadCameraFile(FindCameraFile(name));
    const Eigen::Vector2d middle(0.5 * (camera.size.width - 1),
                                 0.5 * (camera.size.height - 1));
    const auto ray = RayFromPixel(camera.model, middle);
    ASSERT_TRUE(ray.has_value()) << name;
    // Forward, or straight down: what a mirror sees in its middle is the lens.
    const Eigen::Vector3d ray_R = camera.X_RC.linear() * ray->ray;
    const bool is_mirror = std::string(name) == "mirror";
    const double along = is_mirror ? -ray_R.z() : ray_R.x();
    EXPECT_GT(along, 0.99) << name;
  }
}

// The panorama's left and right edges meet behind the robot.
TEST(CameraFile, ThePanoramaIsAWholeTurn) {
  const CameraDescription camera = LoadCameraFile(FindCameraFile("panorama"));
  const auto left = RayFromPixel(camera.model, {-0.499, 127.5});
  const auto right = RayFromPixel(camera.model, {1023.499, 127.5});
  ASSERT_TRUE(left && right);
  EXPECT_LT((left->ray - right->ray).norm(), 1e-4);
}

}  // namespace
}  // namespace waymark
