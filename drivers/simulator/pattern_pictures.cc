#include "drivers/simulator/pattern_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

float Between(Random* random, float low, float high) {
  return static_cast<float>(random->Uniform(low, high));
}

const cv::Vec3f& AnyOf(const std::vector<cv::Vec3f>& palette, Random* random) {
  return palette[random->Index(palette.size())];
}

Eigen::Vector2f AnyPlace(const Canvas& canvas, Random* random) {
  const float x = Between(random, 0.0f, canvas.width());
  return {x, Between(random, 0.0f, canvas.height())};
}

std::vector<Eigen::Vector2f> RandomPolygon(const Eigen::Vector2f& middle,
                                           float radius,
                                           Random* random) {
  const std::uint64_t corners = 3 + random->Index(4);
  const float first = Between(random, 0.0f, kTurn);
  std::vector<Eigen::Vector2f> polygon;
  for (std::uint64_t i = 0; i < corners; ++i) {
    const float angle =
        first + kTurn * (static_cast<float>(i) + Between(random, -0.3f, 0.3f)) /
                    static_cast<float>(corners);
    const float r = radius * Between(random, 0.6f, 1.0f);
    polygon.emplace_back(middle.x() + r * std::cos(angle),
                         middle.y() + r * std::sin(angle));
  }
  return polygon;
}

// Stripes, dots or checks over the whole canvas.
void PaintHatch(const cv::Vec3f& color, Random* random, Canvas canvas) {
  const float size = std::min(canvas.width(), canvas.height());
  const float pitch = size * Between(random, 0.14f, 0.32f);
  if (!(pitch > 3.0f)) return;
  const std::uint64_t kind = random->Index(3);
  int row = 0;
  for (float y = 0.3f * pitch; y < canvas.height(); y += pitch, ++row) {
    if (kind == 0) {
      canvas.Box(0.0f, y, canvas.width(), 0.45f * pitch, color);
      continue;
    }
    for (float x = (row % 2 != 0 ? 0.8f : 0.3f) * pitch; x < canvas.width();
         x += pitch) {
      if (kind == 1) {
        canvas.Disc({x, y}, 0.26f * pitch, color);
      } else {
        canvas.Box(x, y, 0.5f * pitch, 0.5f * pitch, color);
      }
    }
  }
}

// ---- kinds of pictures -----------------------------------------------------

void PaintShapes(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  canvas.Gradient(palette[0], Mix(palette[0], palette[4], 0.6f));
  const float side = std::min(canvas.width(), canvas.height());
  const int shapes = 22 + static_cast<int>(random->Index(16));
  for (int i = 0; i < shapes; ++i) {
    // Large ones first; each scale from a half down to a thirtieth.
    const float age = static_cast<float>(i) / static_cast<float>(shapes);
    const float radius = side * (0.34f * (1.0f - age) * (1.0f - age) + 0.035f) *
                         Between(random, 0.7f, 1.3f);
    const Eigen::Vector2f middle = AnyPlace(canvas, random);
    const cv::Vec3f color = AnyOf(palette, random);
    switch (random->Index(4)) {
      case 0:
        canvas.Disc(middle, radius, color);
        canvas.Disc(middle, 0.55f * radius, AnyOf(palette, random));
        break;
      case 1: {
        const float angle = Between(random, 0.0f, kTurn);
        const Eigen::Vector2f half =
            1.4f * radius * Eigen::Vector2f(std::cos(angle), std::sin(angle));
        canvas.Stroke(middle - half, middle + half, 0.4f * radius, color);
        break;
      }
      case 2:
        canvas.Box(middle.x() - radius,
                   middle.y() - 0.7f * radius,
                   2.0f * radius,
                   1.4f * radius,
                   color);
        PaintHatch(AnyOf(palette, random),
                   random,
                   canvas.Part(middle.x() - 0.8f * radius,
                               middle.y() - 0.55f * radius,
                               1.6f * radius,
                               1.1f * radius));
        break;
      default:
        canvas.Polygon(RandomPolygon(middle, 1.2f * radius, random), color);
    }
  }
}

void PaintMosaicPart(const std::vector<cv::Vec3f>& palette,
                     float smallest,
                     float line,
                     Random* random,
                     Canvas canvas) {
  const float longer = std::max(canvas.width(), canvas.height());
  if (longer > 2.2f * smallest &&
      (longer > 6.0f * smallest || random->Index(5) != 0)) {
    const float share = Between(random, 0.3f, 0.7f);
    const bool across = canvas.width() > canvas.height();
    const float w = canvas.width() * (across ? share : 1.0f);
    const float h = canvas.height() * (across ? 1.0f : share);
    PaintMosaicPart(
        palette, smallest, line, random, canvas.Part(0.0f, 0.0f, w, h));
    PaintMosaicPart(palette,
                    smallest,
                    line,
                    random,
                    canvas.Part(across ? w : 0.0f,
                                across ? 0.0f : h,
                                canvas.width() - (across ? w : 0.0f),
                                canvas.height() - (across ? 0.0f : h)));
    return;
  }
  canvas.Fill(AnyOf(palette, random));
  if (random->Index(4) == 0) PaintHatch(AnyOf(palette, random), random, canvas);
  canvas.Border(line, palette[1] * 0.5f);
}

void PaintMosaic(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float side = std::min(canvas.width(), canvas.height());
  PaintMosaicPart(palette,
                  side * Between(random, 0.08f, 0.15f),
                  side * Between(random, 0.004f, 0.016f),
                  random,
                  canvas);
}

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
    canvas.Text(
        RandomTitle(line == 0 ? 1 : 1 + static_cast<int>(random->Index(3)),
                    random),
        {indent, y, w - indent - 0.04f * w, tall},
        line % 2 == 0 ? palette[1] : palette[3],
        static_cast<int>(random->Index(5)));
    y += 1.15f * tall;
    ++line;
  }
}

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

void PaintLandscape(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float w = canvas.width();
  const float h = canvas.height();
  const cv::Vec3f sky = ColorOfHue(random->Uniform(0.5, 0.68),
                                   random->Uniform(0.3, 0.7),
                                   random->Uniform(0.5, 0.9));
  const cv::Vec3f haze(215, 225, 235);
  canvas.Gradient(sky, haze);
  canvas.Disc(
      {w * Between(random, 0.1f, 0.9f), h * Between(random, 0.1f, 0.3f)},
      h * Between(random, 0.04f, 0.1f),
      {170, 225, 240});
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

// Points of a grid, each moved at random within its cell; the outermost lie
// beyond the border.
struct PointGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector2f> points;

  [[nodiscard]] const Eigen::Vector2f& At(int column, int row) const {
    return points[static_cast<std::size_t>(row * columns + column)];
  }
};

PointGrid RandomGrid(const Canvas& canvas, float cell, Random* random) {
  PointGrid grid;
  grid.columns = static_cast<int>(canvas.width() / cell) + 3;
  grid.rows = static_cast<int>(canvas.height() / cell) + 3;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const float x = static_cast<float>(column) + Between(random, -0.9f, 0.0f);
      const float y = static_cast<float>(row) + Between(random, -0.9f, 0.0f);
      grid.points.emplace_back(cell * x - 0.5f * cell, cell * y - 0.5f * cell);
    }
  }
  return grid;
}

void PaintTriangles(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float side = std::min(canvas.width(), canvas.height());
  const PointGrid grid =
      RandomGrid(canvas, side * Between(random, 0.11f, 0.2f), random);
  canvas.Fill(palette[1]);
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const std::array<Eigen::Vector2f, 3> upper{grid.At(column, row),
                                                 grid.At(column + 1, row),
                                                 grid.At(column, row + 1)};
      const std::array<Eigen::Vector2f, 3> lower{grid.At(column + 1, row),
                                                 grid.At(column + 1, row + 1),
                                                 grid.At(column, row + 1)};
      canvas.Polygon(upper,
                     AnyOf(palette, random) * Between(random, 0.75f, 1.1f));
      canvas.Polygon(lower,
                     AnyOf(palette, random) * Between(random, 0.75f, 1.1f));
    }
  }
}

void PaintGlass(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float side = std::min(canvas.width(), canvas.height());
  const float cell = side * Between(random, 0.11f, 0.2f);
  const float lead = side * Between(random, 0.006f, 0.014f);
  const PointGrid grid = RandomGrid(canvas, cell, random);
  std::vector<cv::Vec3f> colors;
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    colors.push_back(AnyOf(palette, random) * Between(random, 0.8f, 1.1f));
  }
  cv::Mat3b& image = canvas.image();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2f at(static_cast<float>(x), static_cast<float>(y));
      const int middle_column = static_cast<int>(at.x() / cell + 1.0f);
      const int middle_row = static_cast<int>(at.y() / cell + 1.0f);
      float best = 1e9f;
      float second = 1e9f;
      std::size_t nearest = 0;
      for (int r = std::max(0, middle_row - 1);
           r <= std::min(grid.rows - 1, middle_row + 2);
           ++r) {
        for (int c = std::max(0, middle_column - 1);
             c <= std::min(grid.columns - 1, middle_column + 2);
             ++c) {
          const float distance = (grid.At(c, r) - at).norm();
          if (distance < best) {
            second = best;
            best = distance;
            nearest = static_cast<std::size_t>(r * grid.columns + c);
          } else if (distance < second) {
            second = distance;
          }
        }
      }
      const float inside = SmoothStep((second - best) - lead);
      image(y, x) = ToPixel(Mix({28, 26, 26}, colors[nearest], inside));
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
  canvas.Disc(
      {w * Between(random, 0.1f, 0.9f), h * Between(random, 0.08f, 0.25f)},
      h * Between(random, 0.04f, 0.08f),
      {190, 230, 240});
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
    canvas.Polygon(RandomPolygon(AnyPlace(canvas, random),
                                 side * Between(random, 0.06f, 0.25f),
                                 random),
                   Mix(AnyOf(palette, random), {190, 215, 205}, 0.35f));
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
    canvas.Text(RandomTitle(1, random),
                {at.x() + 0.4f * tall, at.y() - 0.5f * tall, 5.0f * tall, tall},
                {35, 30, 40},
                static_cast<int>(random->Index(3)));
  }
}

}  // namespace

void PaintPicture(Random* random, Canvas canvas) {
  using Painter = void (*)(Random*, Canvas);
  static constexpr std::array<Painter, 9> kPainters{PaintShapes,
                                                    PaintMosaic,
                                                    PaintPoster,
                                                    PaintLandscape,
                                                    PaintGlass,
                                                    PaintTriangles,
                                                    PaintSkyline,
                                                    PaintStillLife,
                                                    PaintMap};
  kPainters[random->Index(kPainters.size())](random, canvas);
}

void PaintFramedPicture(const std::optional<cv::Vec3b>& frame,
                        const std::string& title,
                        double pixels_per_metre,
                        std::uint64_t seed,
                        cv::Mat3b* image) {
  Random random(seed);
  Canvas canvas(*image);
  const float metre = static_cast<float>(pixels_per_metre);
  const float side = std::min(canvas.width(), canvas.height());
  static const std::array<cv::Vec3f, 4> kFrames{cv::Vec3f(34, 32, 32),
                                                cv::Vec3f(70, 110, 150),
                                                cv::Vec3f(205, 212, 214),
                                                cv::Vec3f(96, 150, 178)};
  const cv::Vec3f wood =
      frame ? cv::Vec3f(*frame) : kFrames[random.Index(kFrames.size())];
  // A frame of 15 to 35 mm, on a small picture less.
  const float width =
      std::min(metre * Between(&random, 0.015f, 0.035f), 0.08f * side);
  canvas.Fill(wood);
  canvas.Border(0.3f * width, wood * 0.72f);
  Canvas inner = canvas.Part(width,
                             width,
                             canvas.width() - 2.0f * width,
                             canvas.height() - 2.0f * width);
  inner.Fill({222, 228, 230});
  const float mount = random.Index(3) == 0 ? 0.0f : 0.05f * side;
  const float below = title.empty() ? mount : std::max(mount, 0.11f * side);
  Canvas picture = inner.Part(mount,
                              mount,
                              inner.width() - 2.0f * mount,
                              inner.height() - mount - below);
  if (picture.width() > 0.0f && picture.height() > 0.0f) {
    PaintPicture(&random, picture);
    // Print and paper are never quite even.
    const cv::Mat1f noise =
        FractalNoise(picture.image().size(), 6, 6, 4, &random);
    Tone(noise, 0.12f, &picture.image());
  }
  inner.Text(title,
             {mount,
              inner.height() - 0.85f * below,
              inner.width() - 2.0f * mount,
              0.7f * below},
             {40, 38, 36},
             1);
}

}  // namespace waymark
