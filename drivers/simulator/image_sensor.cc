#include "drivers/simulator/image_sensor.h"

#include "estimation/base/random.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace waymark {
namespace {

// Of normal numbers in the table; a draw is an index of 16 bits.
constexpr std::size_t kNumNormals = 65536;

// The standard normal distribution as equally likely numbers: the middles of
// its 65536 quantiles, by Newton's method on its distribution function.
std::vector<float> NormalTable() {
  std::vector<float> table(kNumNormals);
  const double root_two = std::sqrt(2.0);
  const double density_at_0 = 0.3989422804014327;  // 1 / sqrt(2 pi).
  double x = 0.0;
  double sum = 0.0;
  // The upper half, outward, each from where the one before ended.
  for (std::size_t i = kNumNormals / 2; i < kNumNormals; ++i) {
    const double tail =
        (static_cast<double>(kNumNormals - i) - 0.5) / kNumNormals;
    // Newton from the inside of a convex tail does not overshoot; eight
    // steps reach the last bit from one quantile to the next.
    for (int step = 0; step < 8; ++step) {
      const double density = density_at_0 * std::exp(-0.5 * x * x);
      x += (0.5 * std::erfc(x / root_two) - tail) / density;
    }
    table[i] = static_cast<float>(x);
    table[kNumNormals - 1 - i] = static_cast<float>(-x);
    sum += 2.0 * x * x;
  }
  // Middles of quantiles vary a little less than the distribution.
  const auto scale = static_cast<float>(std::sqrt(kNumNormals / sum));
  for (float& value : table) value *= scale;
  return table;
}

float Luminance(const cv::Vec3f& bgr) {
  return 0.0722f * bgr[0] + 0.7152f * bgr[1] + 0.2126f * bgr[2];  // Rec. 709.
}

}  // namespace

// Four draws from each 64 random bits.
class ImageSensor::Noise {
 public:
  Noise(const std::vector<float>& normals, std::uint64_t seed)
      : normals_(normals), random_(seed) {}

  float Next() {
    if (num_left_ == 0) {
      bits_ = random_.Bits();
      num_left_ = 4;
    }
    --num_left_;
    const auto index = static_cast<std::size_t>(bits_ & (kNumNormals - 1));
    bits_ >>= 16;
    return normals_[index];
  }

 private:
  const std::vector<float>& normals_;
  Random random_;
  std::uint64_t bits_ = 0;
  int num_left_ = 0;
};

void ImageSensorOptions::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) {
      throw std::invalid_argument(std::string("image sensor: ") + what);
    }
  };
  require(gain > 0.0 && std::isfinite(gain), "gain must be positive");
  require(auto_exposure_s >= 0.0 && std::isfinite(auto_exposure_s),
          "auto_exposure_s must not be negative");
  require(auto_exposure_mean > 0.0 && auto_exposure_mean < 1.0,
          "auto_exposure_mean must be within (0, 1)");
  require(least_gain > 0.0 && least_gain <= largest_gain &&
              std::isfinite(largest_gain),
          "least_gain must be positive and not above largest_gain");
  require(vignetting >= 0.0 && vignetting < 1.0,
          "vignetting must be within [0, 1)");
  require(full_well_electrons >= 0.0 && std::isfinite(full_well_electrons),
          "full_well_electrons must not be negative");
  require(read_noise >= 0.0 && std::isfinite(read_noise),
          "read_noise must not be negative");
}

ImageSensor::ImageSensor(const ImageSensorOptions& options)
    : options_(options), gain_(options.gain) {
  options.Check();
  if (options.full_well_electrons > 0.0 || options.read_noise > 0.0) {
    normals_ = NormalTable();
  }
}

std::vector<float> ImageSensor::FalloffOfRow(const cv::Size& size,
                                             int y) const {
  // cos^4 = (1 + tan^2)^-2, which is 1 - vignetting in the corners.
  const double corner = 1.0 / std::sqrt(1.0 - options_.vignetting) - 1.0;
  const double middle_x = 0.5 * (size.width - 1);
  const double middle_y = 0.5 * (size.height - 1);
  const double square =
      std::max(1.0, middle_x * middle_x + middle_y * middle_y);
  std::vector<float> falloff(static_cast<std::size_t>(size.width));
  for (int x = 0; x < size.width; ++x) {
    const double dx = x - middle_x;
    const double dy = y - middle_y;
    const double tangent = corner * (dx * dx + dy * dy) / square;
    falloff[static_cast<std::size_t>(x)] =
        static_cast<float>(1.0 / ((1.0 + tangent) * (1.0 + tangent)));
  }
  return falloff;
}

template <typename Pixel>
cv::Mat_<Pixel> ImageSensor::Expose(const cv::Mat3f& light,
                                    std::uint64_t number) const {
  cv::Mat_<Pixel> image(light.size());
  const auto read_variance =
      static_cast<float>(options_.read_noise * options_.read_noise);
  const float per_electron =
      options_.full_well_electrons > 0.0
          ? static_cast<float>(1.0 / options_.full_well_electrons)
          : 0.0f;
  // Numbers of neighbours must not give neighbouring seeds.
  const std::uint64_t stream =
      Random(options_.seed ^ Random(number).Bits()).Bits();
  for (int y = 0; y < light.rows; ++y) {
    const std::vector<float> falloff = FalloffOfRow(light.size(), y);
    Noise noise(normals_, stream + static_cast<std::uint64_t>(y));
    const auto read = [&](float value) {
      if (!normals_.empty()) {
        const float variance =
            read_variance + per_electron * std::max(0.0f, value);
        value += std::sqrt(variance) * noise.Next();
      }
      return srgb_.FromLinear(value);
    };
    for (int x = 0; x < light.cols; ++x) {
      const float share =
          static_cast<float>(gain_) * falloff[static_cast<std::size_t>(x)];
      const cv::Vec3f& from = light(y, x);
      if constexpr (std::is_same_v<Pixel, std::uint8_t>) {
        image(y, x) = read(share * Luminance(from));
      } else {
        for (int c = 0; c < 3; ++c) image(y, x)[c] = read(share * from[c]);
      }
    }
  }
  return image;
}

cv::Mat3b ImageSensor::Colour(const cv::Mat3f& light,
                              std::uint64_t number) const {
  return Expose<cv::Vec3b>(light, number);
}

cv::Mat1b ImageSensor::Grey(const cv::Mat3f& light,
                            std::uint64_t number) const {
  return Expose<std::uint8_t>(light, number);
}

void ImageSensor::Adapt(const cv::Mat3f& light, double elapsed_s) {
  if (options_.auto_exposure_s <= 0.0 || !(elapsed_s > 0.0)) return;
  double sum = 0.0;
  double count = 0.0;
  for (const cv::Vec3f& pixel : light) {
    const float luminance = Luminance(pixel);
    if (!(luminance > 0.0f)) continue;
    // What is beyond full tells no more than that.
    sum += std::min(1.0, gain_ * static_cast<double>(luminance));
    count += 1.0;
  }
  if (count == 0.0) return;
  const double share = 1.0 - std::exp(-elapsed_s / options_.auto_exposure_s);
  gain_ *= std::pow(options_.auto_exposure_mean * count / sum, share);
  gain_ = std::clamp(gain_, options_.least_gain, options_.largest_gain);
}

}  // namespace waymark
