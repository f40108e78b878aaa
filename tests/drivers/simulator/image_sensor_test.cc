#include "drivers/simulator/image_sensor.h"

#include "drivers/simulator/motion_blur.h"
#include "tests/support/box_scene.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>

namespace waymark {
namespace {

cv::Mat3f Flat(float light, int width = 200, int height = 150) {
  return cv::Mat3f(height, width, cv::Vec3f(light, light, light));
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

// In linear light, of values far from the ends.
Moments LinearMoments(const cv::Mat1b& image) {
  double sum = 0.0;
  double squares = 0.0;
  for (const std::uint8_t value : image) {
    const double light = LinearFromSrgb(value);
    sum += light;
    squares += light * light;
  }
  const auto n = static_cast<double>(image.total());
  return {sum / n, squares / n - sum * sum / (n * n)};
}

TEST(ImageSensor, WithoutEffectsTheImageIsTheLight) {
  const ImageSensor sensor({});
  cv::Mat3f light(16, 16);
  for (int i = 0; i < 256; ++i) {
    const float value = LinearFromSrgb(static_cast<std::uint8_t>(i));
    light(i / 16, i % 16) = {value, 0.5f * value, 2.0f};
  }
  const cv::Mat3b image = sensor.Colour(light, 0);
  const cv::Mat1b grey = sensor.Grey(Flat(LinearFromSrgb(77)), 3);
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ(image(i / 16, i % 16)[0], i);
    EXPECT_EQ(image(i / 16, i % 16)[2], 255);
  }
  EXPECT_EQ(cv::countNonZero(grey != 77), 0);
}

TEST(ImageSensor, NoiseHasTheVarianceStated) {
  ImageSensorOptions options;
  options.full_well_electrons = 5000.0;
  options.read_noise = 0.004;
  for (const float light : {0.1f, 0.3f, 0.6f}) {
    const cv::Mat1b image = ImageSensor(options).Grey(Flat(light), 7);
    const Moments moments = LinearMoments(image);
    const double variance = light / 5000.0 + 0.004 * 0.004;
    // A step of 8 bits at that light adds a twelfth of its square.
    const double step = LinearFromSrgb(SrgbTable().FromLinear(light)) -
                        LinearFromSrgb(SrgbTable().FromLinear(light) - 1);
    // 30,000 draws: the mean to 4 sigma, the variance to 5 %.
    EXPECT_NEAR(
        moments.mean, light, 4.0 * std::sqrt(variance / 30000.0) + 0.1 * step);
    EXPECT_NEAR(moments.variance / (variance + step * step / 12.0), 1.0, 0.05);
  }
}

TEST(ImageSensor, NoiseIsOfItsSeedAndNumber) {
  ImageSensorOptions options;
  options.read_noise = 0.01;
  const auto differs = [](const cv::Mat1b& a, const cv::Mat1b& b) {
    return cv::countNonZero(a != b);
  };
  const cv::Mat1b image = ImageSensor(options).Grey(Flat(0.3f), 5);
  EXPECT_EQ(differs(image, ImageSensor(options).Grey(Flat(0.3f), 5)), 0);
  EXPECT_GT(differs(image, ImageSensor(options).Grey(Flat(0.3f), 6)), 20000);
  options.seed = 2;
  EXPECT_GT(differs(image, ImageSensor(options).Grey(Flat(0.3f), 5)), 20000);
  // No row is the one before, nor its neighbour's in the next image.
  EXPECT_GT(differs(image.row(3), image.row(4)), 100);
  const cv::Mat1b next = ImageSensor(options).Grey(Flat(0.3f), 6);
  EXPECT_GT(differs(next.row(3), image.row(4)), 100);
}

TEST(ImageSensor, VignettingIsLostInTheCorners) {
  ImageSensorOptions options;
  options.vignetting = 0.4;
  const cv::Mat1b image = ImageSensor(options).Grey(Flat(0.8f, 201, 151), 0);
  const auto light = [&](int y, int x) {
    return static_cast<double>(LinearFromSrgb(image(y, x)));
  };
  EXPECT_NEAR(light(75, 100), 0.8, 0.005);
  for (const auto& [y, x] : {std::pair(0, 0),
                             std::pair(150, 0),
                             std::pair(0, 200),
                             std::pair(150, 200)}) {
    EXPECT_NEAR(light(y, x), 0.6 * 0.8, 0.005);
  }
  // cos^4 on the way: at half the corner's tangent.
  const double corner = 1.0 / std::sqrt(0.6) - 1.0;
  EXPECT_NEAR(light(75, 0),
              0.8 / std::pow(1.0 + corner * 100.0 * 100.0 / 15625.0, 2.0),
              0.005);
}

TEST(ImageSensor, ExposureAdaptsSlowly) {
  ImageSensorOptions options;
  options.auto_exposure_s = 1.0;
  options.auto_exposure_mean = 0.2;
  ImageSensor sensor(options);
  const cv::Mat3f dim = Flat(0.05f);
  sensor.Adapt(dim, 1.0);
  // 1 - 1/e of the way to four times, in its logarithm.
  EXPECT_NEAR(
      std::log(sensor.gain()), (1.0 - std::exp(-1.0)) * std::log(4.0), 1e-4);
  for (int i = 0; i < 100; ++i) sensor.Adapt(dim, 0.1);
  EXPECT_NEAR(sensor.gain(), 4.0, 0.001);
  // Half of the pixels without any ray do not count.
  cv::Mat3f half = Flat(0.05f);
  half.colRange(0, 100).setTo(cv::Scalar::all(0.0));
  for (int i = 0; i < 100; ++i) sensor.Adapt(half, 0.1);
  EXPECT_NEAR(sensor.gain(), 4.0, 0.001);
  for (int i = 0; i < 200; ++i) sensor.Adapt(Flat(1e-6f), 1.0);
  EXPECT_EQ(sensor.gain(), options.largest_gain);
  const double gain = sensor.gain();
  sensor.Adapt(Flat(0.0f), 1.0);
  EXPECT_EQ(sensor.gain(), gain);
}

TEST(ImageSensor, RefusesWrongOptions) {
  const auto refuses = [](auto change) {
    ImageSensorOptions options;
    change(&options);
    EXPECT_THROW(ImageSensor{options}, std::invalid_argument);
  };
  refuses([](auto* o) { o->gain = 0.0; });
  refuses([](auto* o) { o->gain = NAN; });
  refuses([](auto* o) { o->auto_exposure_s = -1.0; });
  refuses([](auto* o) { o->auto_exposure_mean = 1.0; });
  refuses([](auto* o) { o->least_gain = 20.0; });
  refuses([](auto* o) { o->vignetting = 1.0; });
  refuses([](auto* o) { o->full_well_electrons = -1.0; });
  refuses([](auto* o) { o->read_noise = NAN; });
}

// An edge that moves by ten pixels becomes a ramp of ten.
TEST(MotionBlur, IsTheMeanOverTheExposure) {
  Scene scene;
  scene.ambient = {1.0, 1.0, 1.0};
  AddMaterial(cv::Mat3b(1, 1, {255, 255, 255}), &scene);
  AddSurface("wall", SurfaceKind::kWall, &scene);
  AddQuad({-5, -5, 4}, {0, -5, 4}, {-5, 5, 4}, 0, 0, &scene.mesh);
  const Renderer renderer(scene);
  const CameraRays camera(
      {PerspectiveCamera({100.0, 100.0, 49.5, 4.5}), {100, 10}});
  std::vector<ExposureMoment> moments(40);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const double share = (static_cast<double>(i) + 0.5) / 40.0;
    moments[i].X_WC.translation().x() = 0.4 * share;
  }
  const cv::Mat3f light =
      GatherLight(renderer, camera, moments, RenderQuality::kSingle);
  const float full = light(5, 10)[1];
  EXPECT_NEAR(full, 1.0f, 0.01f);
  EXPECT_EQ(light(5, 60)[1], 0.0f);
  // The wall ends at 49.5 px at first, 39.5 px at last.
  for (int x = 40; x < 50; ++x) {
    const double expected = (49.5 - x) / 10.0;
    EXPECT_NEAR(light(5, x)[1], expected * static_cast<double>(full), 0.03);
  }
}

}  // namespace
}  // namespace waymark
