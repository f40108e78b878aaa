#include "processes/convert/camera_convert.h"

#include "estimation/camera/camera_parameters.h"
#include "estimation/camera/pan_tilt_mount.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::HasSubstr;

const Time kTime = TimeFromMicroseconds(1'700'000'000'000'000);

CameraDescription Camera(const CameraModel& model) {
  CameraDescription camera;
  camera.model = model;
  camera.size = {1280, 1024};
  camera.X_RC.linear() = (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                          Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()))
                             .toRotationMatrix() *
                         ForwardCameraRotation();
  camera.X_RC.translation() << 0.1, -0.02, 0.6;
  return camera;
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

TEST(CameraConvert, EveryModelSurvivesTheRoundTrip) {
  for (const CameraModel& model : Models()) {
    CameraDescription camera = Camera(model);
    for (const bool has_head : {false, true}) {
      if (has_head) camera.p_RH = Eigen::Vector3d(0.05, 0.0, 0.55);
      const camera_info_t message = ToMessage(camera, "FRONT", kTime, 3);
      EXPECT_EQ(message.camera, "FRONT");
      EXPECT_EQ(message.seq, 3);
      EXPECT_EQ(message.is_pan_tilt != 0, has_head);
      std::string reason;
      const auto back = CameraFromMessage(message, &reason);
      ASSERT_TRUE(back) << reason;
      EXPECT_EQ(back->model.index(), model.index());
      EXPECT_EQ(ParametersOf(back->model), ParametersOf(model));
      EXPECT_EQ(back->size, camera.size);
      // Rounding of the quaternion.
      EXPECT_LT((back->X_RC.matrix() - camera.X_RC.matrix()).norm(), 1e-14);
      EXPECT_EQ(back->p_RH, camera.p_RH);
    }
  }
}

TEST(CameraConvert, HeadAtRestHoldsTheCameraWhereItIsMounted) {
  CameraDescription camera = Camera(Models()[0]);
  camera.p_RH = Eigen::Vector3d(0.05, 0.01, 0.5);
  const PanTiltMount mount = MountOf(camera);
  EXPECT_LT((mount.CameraOnRobot(0, 0).matrix() - camera.X_RC.matrix()).norm(),
            1e-14);
  // Turning the head moves the camera about the crossing of its axes.
  const Eigen::Isometry3d turned = mount.CameraOnRobot(0.3, 0.1);
  EXPECT_NEAR((turned.translation() - *camera.p_RH).norm(),
              (camera.X_RC.translation() - *camera.p_RH).norm(),
              1e-14);
  EXPECT_GT((turned.translation() - camera.X_RC.translation()).norm(), 0.01);
}

TEST(CameraConvert, WhatIsNoCameraIsRefused) {
  const auto error_of = [](const std::function<void(camera_info_t*)>& spoil) {
    camera_info_t message = ToMessage(Camera(Models()[2]), "OMNI", kTime, 0);
    spoil(&message);
    std::string reason = "no error";
    EXPECT_FALSE(CameraFromMessage(message, &reason));
    return reason;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Info = camera_info_t;
  EXPECT_THAT(error_of([](Info* m) { m->utime = -1; }), HasSubstr("utime"));
  EXPECT_THAT(error_of([](Info* m) { m->model = "pinhole"; }),
              HasSubstr("perspective"));
  EXPECT_THAT(error_of([](Info* m) { m->width = 0; }),
              HasSubstr("0 px must be in [1, 20000]"));
  EXPECT_THAT(error_of([](Info* m) { m->height = 20001; }),
              HasSubstr("20001 px"));
  EXPECT_THAT(error_of([](Info* m) { m->names[0] = "f"; }),
              HasSubstr("names: not those of a sphere camera"));
  EXPECT_THAT(error_of([](Info* m) { m->names.clear(); }), HasSubstr("names"));
  EXPECT_THAT(error_of([](Info* m) { m->values.pop_back(); }),
              testing::Not(HasSubstr("no error")));
  EXPECT_THAT(error_of([](Info* m) { m->values[0] = kNan; }), HasSubstr("fx"));
  EXPECT_THAT(error_of([](Info* m) { m->position_R[1] = kNan; }),
              HasSubstr("position_R"));
  EXPECT_THAT(error_of([](Info* m) { m->head_R[2] = 1e6; }),
              HasSubstr("head_R: 1000000 m must be within +-100"));
  EXPECT_THAT(error_of([](Info* m) { m->orientation_R[0] = 0.0; }),
              HasSubstr("orientation_R: norm"));
}

}  // namespace
}  // namespace waymark
