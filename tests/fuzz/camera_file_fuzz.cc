// Calibration files: refused in one line, or a camera that answers every pixel
// and every ray with finite numbers or not at all, and that prints and loads
// back the same.
#include "estimation/camera/camera_parameters.h"
#include "processes/convert/camera_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cmath>

namespace waymark::fuzz {
namespace {

void CheckLoadsBack(const CameraDescription& camera) {
  const std::string printed = YamlOfCamera(camera);
  const CameraDescription again = CameraFromYaml(printed, "printed");
  Expect(
      again.size == camera.size && KindOf(again.model) == KindOf(camera.model),
      "size and model load back: " + printed);
  Expect(ParametersOf(again.model) == ParametersOf(camera.model),
         "numbers load back: " + printed);
  // A camera within 1e-9 of straight up or down is written as if it was.
  Expect((again.X_RC.matrix() - camera.X_RC.matrix()).norm() < 1e-8,
         "mounting loads back: " + printed);
  Expect(again.p_RH == camera.p_RH, "head loads back: " + printed);
}

void CheckPixels(const CameraDescription& camera) {
  const auto [width, height] = camera.size;
  for (const double x : {-0.5, 0.0, 0.3 * width, width - 0.5}) {
    for (const double y : {-0.5, 0.0, 0.7 * height, height - 0.5}) {
      const auto back = RayFromPixel(camera.model, {x, y});
      if (!back) continue;
      Expect(std::abs(back->ray.norm() - 1.0) < 1e-12, "a unit bearing");
      const auto seen = PixelFromRay(camera.model, back->ray);
      Expect(seen.has_value(), "a ray of a pixel is seen");
      Expect(seen->pixel.allFinite(), "a finite pixel");
    }
  }
  for (const double x : {-1.0, 0.0, 0.4}) {
    for (const double y : {-0.7, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 2.0}) {
        const auto seen = PixelFromRay(camera.model, {x, y, z});
        Expect(!seen || !seen->pixel.hasNaN(), "a pixel is a number");
      }
    }
  }
}

}  // namespace

void RunOne(Bytes data) {
  CameraDescription camera;
  if (!TakesOrRefuses(
          [&] { camera = CameraFromYaml(std::string(Text(data)), "fuzz"); })) {
    return;
  }
  Expect(camera.size.width > 0 && camera.size.height > 0,
         "an image has a size");
  Expect(ParametersOf(camera.model).allFinite(), "finite numbers");
  Expect(MountOf(camera).CameraOnRobot(0.3, -0.2).matrix().allFinite(),
         "a finite mounting");
  CheckLoadsBack(camera);
  CheckPixels(camera);
}

std::vector<std::string> Seeds() {
  CameraDescription camera;
  camera.size = {640, 480};
  camera.X_RC.translation() << 0.1, 0.0, 0.6;
  std::vector<std::string> seeds;
  for (const CameraModel& model : std::initializer_list<CameraModel>{
           PerspectiveCamera({600.0, 601.0, 320.0, 240.0},
                             {-0.28, 0.08, 1.2e-3, -4e-4, 0.01}),
           FisheyeCamera({182.3, 182.3, 321.0, 248.6},
                         {0.068, -0.044, 0.014, -0.002}),
           SphereCamera(0.96, {330.0, -331.0, 320.0, 240.0}, {-0.05, 0.01}),
           PanoramaCamera::WholeTurn({640, 480}, 239.5)}) {
    camera.model = model;
    seeds.push_back(YamlOfCamera(camera));
  }
  camera.p_RH = Eigen::Vector3d(0.05, 0.0, 0.6);
  seeds.push_back(YamlOfCamera(camera));
  seeds.emplace_back("model: fisheye\nwidth: 4\nheight: 4\nfx: 1\nfy: -1\n");
  seeds.emplace_back("mounting: {yaw_deg: 90, pitch_deg: 90, roll_deg: 180}\n");
  return seeds;
}

}  // namespace waymark::fuzz
