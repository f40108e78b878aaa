#include "drivers/simulator/picture_painters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace waymark {
namespace {

constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

// Heights of a ridge over the width, by midpoint displacement.
std::vector<float> Ridge(float base, float rough, Random* random) {
  std::vector<float> heights{base + rough * Between(random, -1.0f, 1.0f),
                             base + rough * Between(random, -1.0f, 1.0f)};
  for (int level = 0; level < 6; ++level) {
    rough *= 0.55f;
    std::vector<float> finer;
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
      finer.push_back(heights[i]);
      finer.push_back(0.5f * (heights[i] + heights[i + 1]) +
                      rough * Between(random, -1.0f, 1.0f));
    }
    finer.push_back(heights.back());
    heights = std::move(finer);
  }
  return heights;
}

void PaintHouse(const Eigen::Vector2f& foot,
                float size,
                const std::vector<cv::Vec3f>& palette,
                Random* random,
                Canvas* canvas) {
  const float w = size * Between(random, 0.8f, 1.5f);
  const float h = size * Between(random, 0.7f, 1.3f);
  const cv::Vec3f wall = Mix(AnyOf(palette, random), {225, 230, 235}, 0.6f);
  canvas->Box(foot.x(), foot.y() - h, w, h, wall);
  const std::array<Eigen::Vector2f, 3> roof{
      Eigen::Vector2f(foot.x() - 0.1f * w, foot.y() - h),
      Eigen::Vector2f(foot.x() + 1.1f * w, foot.y() - h),
      Eigen::Vector2f(foot.x() + 0.5f * w, foot.y() - 1.7f * h)};
  canvas->Polygon(roof, AnyOf(palette, random) * 0.6f);
  const int windows = 2 + static_cast<int>(random->Index(2));
  const float pane = 0.8f * w / static_cast<float>(windows);
  for (int i = 0; i < windows; ++i) {
    canvas->Box(foot.x() + 0.15f * w + pane * static_cast<float>(i),
                foot.y() - 0.75f * h,
                0.55f * pane,
                0.4f * h,
                {40, 36, 30});
  }
}

// A ball lit from the upper left.
void PaintBall(const Eigen::Vector2f& middle,
               float radius,
               const cv::Vec3f& color,
               Canvas* canvas) {
  const int rings = 10;
  for (int i = 0; i < rings; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(rings);
    canvas->Disc(middle + t * radius * Eigen::Vector2f(-0.32f, -0.36f),
                 radius * (1.0f - 0.9f * t),
                 Mix(color * 0.4f, Mix(color, {240, 240, 240}, 0.5f), t));
  }
}

}  // namespace

void PaintPoster(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(5, random);
  const float w = canvas.width();
  const float h = canvas.height();
  canvas.Gradient(palette[0], Mix(palette[0], palette[2], 0.5f));
  const float band = h * Between(random, 0.3f, 0.5f);
  const float top = random->Index(2) == 0 ? 0.0f : h - band;
  PaintShapes(random, canvas.Part(0.0f, top, w, band));
  const float start = top > 0.0f ? 0.0f : band;
  float y = start + 0.03f * h;
  const float end = start + h - band - 0.02f * h;
  int line = 0;
  while (y < end - 0.05f * h) {
    const float tall =
        line == 0 ? 0.2f * h : h * Between(random, 0.045f, 0.13f);
    if (random->Index(4) == 0 && line > 0) {
      canvas.Box(
          0.06f * w, y + 0.3f * tall, 0.88f * w, 0.2f * tall, palette[3]);
      y += 0.8f * tall;
      ++line;
      continue;
    }
    const float indent = w * Between(random, 0.03f, 0.25f);
    const int font = static_cast<int>(random->Index(5));
    const int words = line == 0 ? 1 : 1 + static_cast<int>(random->Index(3));
    canvas.Text(RandomTitle(words, random),
                {indent, y, w - indent - 0.04f * w, tall},
                line % 2 == 0 ? palette[1] : palette[3],
                font);
    y += 1.15f * tall;
    ++line;
  }
}

void PaintLandscape(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float w = canvas.width();
  const float h = canvas.height();
  const double value = random->Uniform(0.5, 0.9);
  const double saturation = random->Uniform(0.3, 0.7);
  const cv::Vec3f sky =
      ColorOfHue(random->Uniform(0.5, 0.68), saturation, value);
  const cv::Vec3f haze(215, 225, 235);
  canvas.Gradient(sky, haze);
  const float sun = h * Between(random, 0.04f, 0.1f);
  const float sun_x = w * Between(random, 0.1f, 0.9f);
  const float sun_y = h * Between(random, 0.1f, 0.3f);
  canvas.Disc({sun_x, sun_y}, sun, {170, 225, 240});
  const int ridges = 3 + static_cast<int>(random->Index(3));
  for (int i = 0; i < ridges; ++i) {
    const float depth = static_cast<float>(i + 1) / static_cast<float>(ridges);
    const std::vector<float> line =
        Ridge(h * (0.25f + 0.5f * depth), 0.22f * h, random);
    std::vector<Eigen::Vector2f> hill{{w, h}, {0.0f, h}};
    for (std::size_t k = 0; k < line.size(); ++k) {
      hill.emplace_back(
          w * static_cast<float>(k) / static_cast<float>(line.size() - 1),
          line[k]);
    }
    const cv::Vec3f ground = Mix(haze, AnyOf(palette, random) * 0.45f, depth);
    canvas.Polygon(hill, ground);
    const int things = 5 + static_cast<int>(random->Index(12));
    for (int k = 0; k < things; ++k) {
      const std::size_t at = random->Index(line.size());
      const Eigen::Vector2f foot(
          w * static_cast<float>(at) / static_cast<float>(line.size() - 1),
          line[at] + h * Between(random, 0.0f, 0.1f));
      const float size =
          h * (0.04f + 0.09f * depth) * Between(random, 0.6f, 1.4f);
      if (random->Index(4) == 0) {
        PaintHouse(foot, size, palette, random, &canvas);
        continue;
      }
      const std::array<Eigen::Vector2f, 3> tree{
          foot + size * Eigen::Vector2f(-0.35f, 0.0f),
          foot + size * Eigen::Vector2f(0.35f, 0.0f),
          foot + size * Eigen::Vector2f(0.0f, -1.5f)};
      canvas.Polygon(tree, ground * Between(random, 0.35f, 0.7f));
    }
  }
}

void PaintSkyline(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float w = canvas.width();
  const float h = canvas.height();
  const bool is_night = random->Index(2) == 0;
  const cv::Vec3f sky =
      is_night ? cv::Vec3f(80, 48, 34) : cv::Vec3f(225, 190, 150);
  canvas.Gradient(sky, Mix(sky, {140, 170, 235}, 0.7f));
  const float moon = h * Between(random, 0.04f, 0.08f);
  const float moon_x = w * Between(random, 0.1f, 0.9f);
  const float moon_y = h * Between(random, 0.08f, 0.25f);
  canvas.Disc({moon_x, moon_y}, moon, {190, 230, 240});
  for (int layer = 0; layer < 3; ++layer) {
    const float near = 0.5f * static_cast<float>(layer);
    float x = w * Between(random, -0.1f, 0.0f);
    while (x < w) {
      const float width = w * Between(random, 0.07f, 0.2f);
      const float top = h * (Between(random, 0.2f, 0.55f) +
                             0.17f * static_cast<float>(layer));
      const cv::Vec3f wall =
          Mix(sky, AnyOf(palette, random) * 0.6f, 0.35f + 0.6f * near);
      canvas.Box(x, top, width, h - top, wall);
      if (random->Index(3) == 0) {
        canvas.Box(
            x + 0.4f * width, top - 0.06f * h, 0.1f * width, 0.06f * h, wall);
      }
      const float pane = w * Between(random, 0.014f, 0.03f);
      for (float v = top + pane; v < h - pane; v += 1.9f * pane) {
        for (float u = x + 0.7f * pane; u < x + width - pane;
             u += 1.7f * pane) {
          if (random->Index(5) < 2) continue;
          const cv::Vec3f light =
              random->Index(2) == 0 ? cv::Vec3f(120, 215, 240) : wall * 0.45f;
          canvas.Box(u, v, 0.9f * pane, 1.1f * pane, light);
        }
      }
      x += width * Between(random, 0.95f, 1.3f);
    }
  }
}

void PaintStillLife(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float w = canvas.width();
  const float h = canvas.height();
  const float table = h * Between(random, 0.5f, 0.65f);
  canvas.Gradient(palette[5] * 0.5f, palette[2]);
  Canvas cloth = canvas.Part(0.0f, table, w, h - table);
  cloth.Gradient(palette[0], palette[0] * 0.7f);
  PaintHatch(palette[3], random, cloth);
  const int things = 12 + static_cast<int>(random->Index(9));
  for (int i = 0; i < things; ++i) {
    const float near = static_cast<float>(i) / static_cast<float>(things);
    const Eigen::Vector2f foot(w * Between(random, 0.06f, 0.94f),
                               table + (h - table) * (0.75f * near));
    const float size = h * (0.05f + 0.07f * near) * Between(random, 0.7f, 1.3f);
    const cv::Vec3f color = AnyOf(palette, random);
    if (random->Index(3) == 0) {  // A bottle with a label.
      const float tall = size * Between(random, 2.4f, 4.0f);
      canvas.Box(
          foot.x() - 0.5f * size, foot.y() - tall, size, tall, color * 0.55f);
      canvas.Box(foot.x() - 0.2f * size,
                 foot.y() - 1.5f * tall,
                 0.4f * size,
                 0.6f * tall,
                 color * 0.55f);
      canvas.Box(foot.x() - 0.5f * size,
                 foot.y() - 0.6f * tall,
                 size,
                 0.35f * tall,
                 AnyOf(palette, random));
      canvas.Text(RandomWord(random),
                  {foot.x() - 0.45f * size,
                   foot.y() - 0.55f * tall,
                   0.9f * size,
                   0.25f * tall},
                  {30, 30, 30},
                  1);
    } else {
      PaintBall(foot - Eigen::Vector2f(0.0f, size), size, color, &canvas);
    }
  }
}

void PaintMap(Random* random, Canvas canvas) {
  const float w = canvas.width();
  const float h = canvas.height();
  const float side = std::min(w, h);
  canvas.Fill({205, 222, 228});
  const std::vector<cv::Vec3f> palette = RandomPalette(5, random);
  for (int i = 0; i < 14; ++i) {  // Parks, lakes, quarters.
    const cv::Vec3f color = Mix(AnyOf(palette, random), {190, 215, 205}, 0.35f);
    const float radius = side * Between(random, 0.06f, 0.25f);
    const Eigen::Vector2f middle = AnyPlace(canvas, random);
    canvas.Polygon(RandomPolygon(middle, radius, random), color);
  }
  for (int i = 0; i < 26; ++i) {
    const float width = side * (i < 18 ? 0.008f : 0.022f);
    const cv::Vec3f color = i < 18 ? cv::Vec3f(235, 240, 242) : palette[3];
    Eigen::Vector2f at = AnyPlace(canvas, random);
    float angle = Between(random, 0.0f, kTurn);
    for (int k = 0; k < 9; ++k) {
      angle += Between(random, -0.5f, 0.5f);
      const Eigen::Vector2f next =
          at + 0.17f * side * Eigen::Vector2f(std::cos(angle), std::sin(angle));
      canvas.Stroke(at, next, 1.7f * width, color * 0.5f);
      canvas.Stroke(at, next, width, color);
      at = next;
    }
  }
  for (int i = 0; i < 16; ++i) {
    const Eigen::Vector2f at = AnyPlace(canvas, random);
    const float tall = side * Between(random, 0.03f, 0.07f);
    canvas.Disc(at, 0.3f * tall, palette[1]);
    const int font = static_cast<int>(random->Index(3));
    canvas.Text(RandomTitle(1, random),
                {at.x() + 0.4f * tall, at.y() - 0.5f * tall, 5.0f * tall, tall},
                {35, 30, 40},
                font);
  }
}

}  // namespace waymark
