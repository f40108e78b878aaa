// From the light that falls on a sensor to the image that it gives.
#pragma once

#include "drivers/simulator/srgb.h"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace waymark {

// Every effect is off by default: the image is the light, clipped at 1.
struct ImageSensorOptions {
  // Light 1 / gain fills the sensor.
  double gain = 1.0;
  // Slow automatic exposure: over auto_exposure_s the gain goes 1 - 1/e of the
  // way (in its logarithm) to where the image's mean, in linear light, is
  // auto_exposure_mean. 0 s: off, the gain is fixed.
  double auto_exposure_s = 0.0;
  double auto_exposure_mean = 0.2;
  double least_gain = 0.1;
  double largest_gain = 10.0;
  // Share of the light lost in the corners of the image, [0, 1); toward the
  // middle as cos^4 of an angle whose tangent grows with the distance from it.
  double vignetting = 0.0;
  // Electrons of a full pixel. Photons arrive at random: n electrons have the
  // variance n (drawn from a normal distribution). 0: without photon noise.
  double full_well_electrons = 0.0;
  // Standard deviation of what reading adds; of the full sensor, 0: off.
  double read_noise = 0.0;
  std::uint64_t seed = 1;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// A stream of images of one sensor; it remembers its gain. The same options,
// light, times and numbers give the same bytes.
class ImageSensor {
 public:
  explicit ImageSensor(const ImageSensorOptions& options);

  // The sRGB image of `light` (linear BGR). `number` chooses the noise: one
  // for each image of a stream. Neither changes the gain.
  [[nodiscard]] cv::Mat3b Colour(const cv::Mat3f& light,
                                 std::uint64_t number) const;
  // The same of a sensor without colours: luminance (Rec. 709), one noise.
  [[nodiscard]] cv::Mat1b Grey(const cv::Mat3f& light,
                               std::uint64_t number) const;

  // Sets the gain for the next image, `elapsed_s` after that of `light`. Pixels
  // without any light (outside the camera's field of view) do not count.
  void Adapt(const cv::Mat3f& light, double elapsed_s);
  [[nodiscard]] double gain() const { return gain_; }

 private:
  class Noise;

  // Light that is left of 1 at a pixel.
  [[nodiscard]] std::vector<float> FalloffOfRow(const cv::Size& size,
                                                int y) const;
  template <typename Pixel>
  [[nodiscard]] cv::Mat_<Pixel> Expose(const cv::Mat3f& light,
                                       std::uint64_t number) const;

  ImageSensorOptions options_;
  double gain_;
  SrgbTable srgb_;
  std::vector<float> normals_;  // Empty without noise.
};

}  // namespace waymark
