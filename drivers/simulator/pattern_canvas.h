// What procedural patterns are painted with. Sizes are in pixels here.
#pragma once

#include "estimation/base/random.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <span>
#include <string>
#include <vector>

namespace waymark {

// Rounded and kept within [kMinPatternValue, kMaxPatternValue].
[[nodiscard]] cv::Vec3b ToPixel(const cv::Vec3f& color);
// Hue in turns, saturation and value in [0, 1].
[[nodiscard]] cv::Vec3f ColorOfHue(double hue, double saturation, double value);
[[nodiscard]] cv::Vec3f Mix(const cv::Vec3f& a,
                            const cv::Vec3f& b,
                            float share);
// 0 below 0, 1 above 1, smooth between.
[[nodiscard]] float SmoothStep(float x);

// Smooth random field in [-1, 1] that repeats over the image, with that many
// random values across and down it.
[[nodiscard]] cv::Mat1f PeriodicNoise(cv::Size size,
                                      int across,
                                      int down,
                                      Random* random);
// Octaves of the above: each has twice the cells and half the height.
[[nodiscard]] cv::Mat1f FractalNoise(
    cv::Size size, int across, int down, int octaves, Random* random);

// Multiplies every pixel by 1 + amount * noise.
void Tone(const cv::Mat1f& noise, float amount, cv::Mat3b* image);

// Anti-aliased shapes on an image, or on a part of one: they are cut off at
// its border.
class Canvas {
 public:
  explicit Canvas(const cv::Mat3b& image) : image_(image) {}

  [[nodiscard]] float width() const { return static_cast<float>(image_.cols); }
  [[nodiscard]] float height() const { return static_cast<float>(image_.rows); }
  [[nodiscard]] cv::Mat3b& image() { return image_; }
  // The part of it, cut off at the border.
  [[nodiscard]] Canvas Part(float x, float y, float width, float height) const;

  void Fill(const cv::Vec3f& color);
  // From `top` to `bottom`.
  void Gradient(const cv::Vec3f& top, const cv::Vec3f& bottom);
  void Polygon(std::span<const Eigen::Vector2f> corners,
               const cv::Vec3f& color);
  void Box(float x, float y, float width, float height, const cv::Vec3f& color);
  void Disc(const Eigen::Vector2f& middle,
            float radius,
            const cv::Vec3f& color);
  void Stroke(const Eigen::Vector2f& from,
              const Eigen::Vector2f& to,
              float width,
              const cv::Vec3f& color);
  // Outline inside the border.
  void Border(float width, const cv::Vec3f& color);
  // One line, as large as fits into the box, in its middle. Returns the box
  // that the letters take. `style` picks one of the fonts.
  void Text(const std::string& text,
            const cv::Rect2f& box,
            const cv::Vec3f& color,
            int style);
  // Puts a picture with its middle there, turned by `angle`.
  void Paste(const cv::Mat3b& picture,
             const Eigen::Vector2f& middle,
             float angle);

 private:
  cv::Mat3b image_;
};

// A word that can be pronounced, and a line of some.
[[nodiscard]] std::string RandomWord(Random* random);
[[nodiscard]] std::string RandomTitle(int words, Random* random);
// Colours that go together and differ in lightness, most different first.
[[nodiscard]] std::vector<cv::Vec3f> RandomPalette(int count, Random* random);

}  // namespace waymark
