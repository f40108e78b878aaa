#include "drivers/simulator/pattern_canvas.h"

#include "drivers/simulator/material_pattern.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace waymark {
namespace {

// OpenCV draws at 1/16 of a pixel.
constexpr int kShift = 4;
constexpr float kSubpixels = 16.0f;

cv::Point Fixed(const Eigen::Vector2f& p) {
  return {static_cast<int>(std::lround(p.x() * kSubpixels)),
          static_cast<int>(std::lround(p.y() * kSubpixels))};
}

cv::Scalar ToScalar(const cv::Vec3f& color) {
  const cv::Vec3b pixel = ToPixel(color);
  return {static_cast<double>(pixel[0]),
          static_cast<double>(pixel[1]),
          static_cast<double>(pixel[2])};
}

// For each pixel of a row of `size`: the cell it is in and how far.
struct Place {
  int cell = 0;
  int next = 0;
  float share = 0.0f;
};

std::vector<Place> Places(int size, int cells) {
  std::vector<Place> places(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    const float at = static_cast<float>(i) * static_cast<float>(cells) /
                     static_cast<float>(size);
    const int cell = static_cast<int>(at);
    places[static_cast<std::size_t>(i)] = {
        cell % cells,
        (cell + 1) % cells,
        SmoothStep(at - static_cast<float>(cell))};
  }
  return places;
}

}  // namespace

cv::Vec3b ToPixel(const cv::Vec3f& color) {
  cv::Vec3b pixel;
  for (int i = 0; i < 3; ++i) {
    pixel[i] = static_cast<std::uint8_t>(
        std::clamp(color[i],
                   static_cast<float>(kMinPatternValue),
                   static_cast<float>(kMaxPatternValue)) +
        0.5f);
  }
  return pixel;
}

cv::Vec3f ColorOfHue(double hue, double saturation, double value) {
  const double turns = 6.0 * (hue - std::floor(hue));
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + turns, 6.0);
    const double dip = std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
    return static_cast<float>(255.0 * value * (1.0 - saturation * dip));
  };
  return {channel(1.0), channel(3.0), channel(5.0)};
}

cv::Vec3f Mix(const cv::Vec3f& a, const cv::Vec3f& b, float share) {
  return a + share * (b - a);
}

float SmoothStep(float x) {
  const float t = std::clamp(x, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

cv::Mat1f PeriodicNoise(cv::Size size, int across, int down, Random* random) {
  cv::Mat1f cells(down, across);
  for (float& cell : cells) {
    cell = static_cast<float>(random->Uniform(-1.0, 1.0));
  }
  const std::vector<Place> columns = Places(size.width, across);
  const std::vector<Place> rows = Places(size.height, down);
  cv::Mat1f noise(size);
  std::vector<float> line(static_cast<std::size_t>(across));
  for (int y = 0; y < size.height; ++y) {
    const Place& row = rows[static_cast<std::size_t>(y)];
    const float* above = cells[row.cell];
    const float* below = cells[row.next];
    for (int i = 0; i < across; ++i) {
      line[static_cast<std::size_t>(i)] =
          above[i] + row.share * (below[i] - above[i]);
    }
    float* out = noise[y];
    for (int x = 0; x < size.width; ++x) {
      const Place& column = columns[static_cast<std::size_t>(x)];
      const float left = line[static_cast<std::size_t>(column.cell)];
      const float right = line[static_cast<std::size_t>(column.next)];
      out[x] = left + column.share * (right - left);
    }
  }
  return noise;
}

cv::Mat1f FractalNoise(
    cv::Size size, int across, int down, int octaves, Random* random) {
  cv::Mat1f sum(size, 0.0f);
  float height = 1.0f;
  float total = 0.0f;
  for (int i = 0; i < octaves; ++i) {
    // More cells than pixels would only be noise of one pixel.
    const cv::Mat1f noise = PeriodicNoise(size,
                                          std::min(across << i, size.width),
                                          std::min(down << i, size.height),
                                          random);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) sum(y, x) += height * noise(y, x);
    }
    total += height;
    height *= 0.5f;
  }
  for (float& value : sum) value /= total;
  return sum;
}

void Tone(const cv::Mat1f& noise, float amount, cv::Mat3b* image) {
  for (int y = 0; y < image->rows; ++y) {
    for (int x = 0; x < image->cols; ++x) {
      cv::Vec3b& pixel = (*image)(y, x);
      pixel = ToPixel(cv::Vec3f(pixel) * (1.0f + amount * noise(y, x)));
    }
  }
}

// ---- shapes ----------------------------------------------------------------

Canvas Canvas::Part(float x, float y, float width, float height) const {
  const auto whole = [](float value) {
    return static_cast<int>(std::lround(value));
  };
  const cv::Rect part(cv::Point(whole(x), whole(y)),
                      cv::Point(whole(x + width), whole(y + height)));
  return Canvas(image_(part & cv::Rect(0, 0, image_.cols, image_.rows)));
}

void Canvas::Fill(const cv::Vec3f& color) {
  image_.setTo(ToPixel(color));
}

void Canvas::Gradient(const cv::Vec3f& top, const cv::Vec3f& bottom) {
  for (int y = 0; y < image_.rows; ++y) {
    image_.row(y).setTo(
        ToPixel(Mix(top, bottom, static_cast<float>(y) / height())));
  }
}

void Canvas::Polygon(std::span<const Eigen::Vector2f> corners,
                     const cv::Vec3f& color) {
  if (image_.empty()) return;
  std::vector<cv::Point> points;
  for (const Eigen::Vector2f& corner : corners) points.push_back(Fixed(corner));
  const std::vector<std::vector<cv::Point>> polygons{points};
  cv::fillPoly(image_, polygons, ToScalar(color), cv::LINE_AA, kShift);
}

void Canvas::Box(
    float x, float y, float width, float height, const cv::Vec3f& color) {
  const std::array<Eigen::Vector2f, 4> corners{
      Eigen::Vector2f(x, y),
      Eigen::Vector2f(x + width, y),
      Eigen::Vector2f(x + width, y + height),
      Eigen::Vector2f(x, y + height)};
  Polygon(corners, color);
}

void Canvas::Disc(const Eigen::Vector2f& middle,
                  float radius,
                  const cv::Vec3f& color) {
  if (image_.empty()) return;
  cv::circle(image_,
             Fixed(middle),
             static_cast<int>(std::lround(radius * kSubpixels)),
             ToScalar(color),
             cv::FILLED,
             cv::LINE_AA,
             kShift);
}

void Canvas::Stroke(const Eigen::Vector2f& from,
                    const Eigen::Vector2f& to,
                    float width,
                    const cv::Vec3f& color) {
  const Eigen::Vector2f along = to - from;
  const float length = along.norm();
  if (!(length > 0.0f)) return;
  const Eigen::Vector2f side =
      0.5f * width / length * Eigen::Vector2f(-along.y(), along.x());
  const std::array<Eigen::Vector2f, 4> corners{
      from + side, to + side, to - side, from - side};
  Polygon(corners, color);
}

void Canvas::Border(float width, const cv::Vec3f& color) {
  Part(0.0f, 0.0f, this->width(), width).Fill(color);
  Part(0.0f, height() - width, this->width(), width).Fill(color);
  Part(0.0f, 0.0f, width, height()).Fill(color);
  Part(this->width() - width, 0.0f, width, height()).Fill(color);
}

void Canvas::Text(const std::string& text,
                  const cv::Rect2f& box,
                  const cv::Vec3f& color,
                  int style) {
  if (image_.empty() || text.empty()) return;
  static constexpr std::array<int, 5> kFonts{cv::FONT_HERSHEY_SIMPLEX,
                                             cv::FONT_HERSHEY_DUPLEX,
                                             cv::FONT_HERSHEY_TRIPLEX,
                                             cv::FONT_HERSHEY_COMPLEX,
                                             cv::FONT_HERSHEY_COMPLEX_SMALL};
  const int font = kFonts[static_cast<std::size_t>(style) % kFonts.size()];
  int baseline = 0;
  const cv::Size unit = cv::getTextSize(text, font, 1.0, 1, &baseline);
  // The part below the line counts half: few letters have one.
  const double tall = unit.height + 0.5 * baseline;
  const double scale = std::min(static_cast<double>(box.width) / unit.width,
                                static_cast<double>(box.height) / tall);
  // A capital is 22 units high; a bold letter's stroke is a seventh of that.
  const int thickness =
      std::max(1, static_cast<int>(std::lround(22.0 / 7.0 * scale)));
  const cv::Point origin(
      static_cast<int>(
          std::lround(box.x + 0.5 * (box.width - scale * unit.width))),
      static_cast<int>(std::lround(box.y + 0.5 * (box.height - scale * tall) +
                                   scale * unit.height)));
  cv::putText(image_,
              text,
              origin,
              font,
              scale,
              ToScalar(color),
              thickness,
              cv::LINE_AA);
}

void Canvas::Paste(const cv::Mat3b& picture,
                   const Eigen::Vector2f& middle,
                   float angle) {
  const float cosine = std::cos(angle);
  const float sine = std::sin(angle);
  const Eigen::Vector2f half(0.5f * static_cast<float>(picture.cols),
                             0.5f * static_cast<float>(picture.rows));
  const float reach = half.norm() + 1.0f;
  const auto from = [](float low) {
    return std::max(0, static_cast<int>(low));
  };
  const int x_end = std::min(image_.cols, static_cast<int>(middle.x() + reach));
  const int y_end = std::min(image_.rows, static_cast<int>(middle.y() + reach));
  for (int y = from(middle.y() - reach); y < y_end; ++y) {
    for (int x = from(middle.x() - reach); x < x_end; ++x) {
      const Eigen::Vector2f d(static_cast<float>(x) - middle.x(),
                              static_cast<float>(y) - middle.y());
      const float u = cosine * d.x() + sine * d.y() + half.x() - 0.5f;
      const float v = -sine * d.x() + cosine * d.y() + half.y() - 0.5f;
      // How much of this pixel the picture covers, along each axis.
      const auto cover = [](float at, int size) {
        return std::clamp(at + 1.0f, 0.0f, 1.0f) *
               std::clamp(static_cast<float>(size) - at, 0.0f, 1.0f);
      };
      const float share = cover(u, picture.cols) * cover(v, picture.rows);
      if (!(share > 0.0f)) continue;
      const float cu =
          std::clamp(u, 0.0f, static_cast<float>(picture.cols - 1));
      const float cv_ =
          std::clamp(v, 0.0f, static_cast<float>(picture.rows - 1));
      const int iu = static_cast<int>(cu);
      const int iv = static_cast<int>(cv_);
      const int ju = std::min(iu + 1, picture.cols - 1);
      const int jv = std::min(iv + 1, picture.rows - 1);
      const float su = cu - static_cast<float>(iu);
      const float sv = cv_ - static_cast<float>(iv);
      const cv::Vec3f top = Mix(picture(iv, iu), picture(iv, ju), su);
      const cv::Vec3f bottom = Mix(picture(jv, iu), picture(jv, ju), su);
      image_(y, x) = ToPixel(Mix(image_(y, x), Mix(top, bottom, sv), share));
    }
  }
}

// ---- words and colours -----------------------------------------------------

std::string RandomWord(Random* random) {
  static constexpr std::string_view kConsonants = "bdfgklmnprstvz";
  static constexpr std::string_view kVowels = "aeiou";
  std::string word;
  const std::uint64_t syllables = 1 + random->Index(3);
  for (std::uint64_t i = 0; i < syllables; ++i) {
    word += kConsonants[random->Index(kConsonants.size())];
    word += kVowels[random->Index(kVowels.size())];
  }
  if (random->Index(2) == 0) {
    word += kConsonants[random->Index(kConsonants.size())];
  }
  return word;
}

std::string RandomTitle(int words, Random* random) {
  std::string title;
  for (int i = 0; i < words; ++i) {
    std::string word = RandomWord(random);
    word[0] = static_cast<char>(word[0] - 'a' + 'A');
    title += (i ? " " : "") + word;
  }
  return title;
}

std::vector<cv::Vec3f> RandomPalette(int count, Random* random) {
  // Light and dark in turn, so that neighbours in the list contrast.
  static constexpr std::array<double, 6> kValues{
      0.92, 0.22, 0.70, 0.38, 0.82, 0.52};
  const double base = random->Uniform();
  const double spread = random->Uniform(0.08, 0.45);
  std::vector<cv::Vec3f> palette;
  for (int i = 0; i < count; ++i) {
    const double value = kValues[static_cast<std::size_t>(i) % kValues.size()];
    // Light colours of full saturation would glow.
    const double saturation = random->Uniform(0.1, value > 0.6 ? 0.5 : 0.8);
    const double light =
        std::clamp(value + random->Uniform(-0.07, 0.07), 0.1, 0.95);
    const double hue = base + spread * i + random->Uniform(-0.04, 0.04);
    palette.push_back(ColorOfHue(hue, saturation, light));
  }
  return palette;
}

}  // namespace waymark
