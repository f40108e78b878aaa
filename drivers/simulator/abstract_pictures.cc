#include "drivers/simulator/picture_painters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

// Points of a grid, each moved at random within its cell; the outermost lie
// beyond the border.
struct PointGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector2f> points;

  [[nodiscard]] std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] const Eigen::Vector2f& At(int column, int row) const {
    return points[Index(column, row)];
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

}  // namespace

// ---- tools -----------------------------------------------------------------

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

// ---- pictures --------------------------------------------------------------

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

void PaintMosaic(Random* random, Canvas canvas) {
  const std::vector<cv::Vec3f> palette = RandomPalette(6, random);
  const float side = std::min(canvas.width(), canvas.height());
  const float line = side * Between(random, 0.004f, 0.016f);
  const float smallest = side * Between(random, 0.08f, 0.15f);
  PaintMosaicPart(palette, smallest, line, random, std::move(canvas));
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
      for (const auto& corners : {upper, lower}) {
        const float light = Between(random, 0.75f, 1.1f);
        canvas.Polygon(corners, AnyOf(palette, random) * light);
      }
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
    const float light = Between(random, 0.8f, 1.1f);
    colors.push_back(AnyOf(palette, random) * light);
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
            nearest = grid.Index(c, r);
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

}  // namespace waymark
