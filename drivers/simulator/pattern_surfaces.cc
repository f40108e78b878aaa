#include "drivers/simulator/pattern_surfaces.h"

#include "drivers/simulator/pattern_canvas.h"
#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace waymark {
namespace {

// Where a pixel lies in a pattern of stones: which stone, and how far from its
// nearest edge (m).
struct Cell {
  int column = 0;
  int row = 0;
  float x = 0.0f;     // From the stone's left edge, m.
  float y = 0.0f;     // From its upper edge.
  float edge = 0.0f;  // To the nearest edge.
};

// A table of random numbers in [-1, 1] that repeats.
class Table {
 public:
  Table(int columns, int rows, Random* random) : values_(rows, columns) {
    for (float& value : values_) {
      value = static_cast<float>(random->Uniform(-1.0, 1.0));
    }
  }
  [[nodiscard]] float operator()(int column, int row) const {
    return values_(row % values_.rows, column % values_.cols);
  }

 private:
  cv::Mat1f values_;
};

// Metres per pixel of an image that holds one period of a kind.
Eigen::Vector2f PixelSize(PatternKind kind, const cv::Mat3b& image) {
  const Eigen::Vector2d period = PeriodOf(kind);
  return {static_cast<float>(period.x() / image.cols),
          static_cast<float>(period.y() / image.rows)};
}

// `shade` gives the colour at pixel x, y, which lies at u, v (m).
template <typename Shade>
void ForEachPixel(cv::Mat3b* image,
                  const Eigen::Vector2f& pixel,
                  const Shade& shade) {
  for (int y = 0; y < image->rows; ++y) {
    for (int x = 0; x < image->cols; ++x) {
      (*image)(y, x) =
          ToPixel(shade(x,
                        y,
                        (static_cast<float>(x) + 0.5f) * pixel.x(),
                        (static_cast<float>(y) + 0.5f) * pixel.y()));
    }
  }
}

// How many stones of that length a side of the image holds.
int Stones(int pixels, float pixel, float length) {
  return static_cast<int>(
      std::lround(static_cast<float>(pixels) * pixel / length));
}

// Share of the stone in a pixel at that distance from its edge.
float Inside(float edge, float joint, float pixel) {
  return SmoothStep((edge - 0.5f * joint) / std::max(pixel, 0.001f) + 0.5f);
}

Cell CellOf(float u, float v, float width, float height, float shift) {
  Cell cell;
  cell.row = static_cast<int>(v / height);
  const float along = u + (cell.row % 2 != 0 ? shift : 0.0f);
  cell.column = static_cast<int>(along / width);
  cell.x = along - static_cast<float>(cell.column) * width;
  cell.y = v - static_cast<float>(cell.row) * height;
  cell.edge = std::min(std::min(cell.x, width - cell.x),
                       std::min(cell.y, height - cell.y));
  return cell;
}

// ---- walls -----------------------------------------------------------------

void PaintPlaster(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  const cv::Size size = image->size();
  const cv::Mat1f mottle = FractalNoise(size, 5, 5, 5, random);
  const cv::Mat1f grain =
      PeriodicNoise(size, size.width / 2, size.height / 2, random);
  image->setTo(ToPixel(color));
  Tone(mottle, 0.045f, image);
  Tone(grain, 0.018f, image);
}

void PaintPaint(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  const cv::Size size = image->size();
  // A roller leaves upright bands and a fine grain.
  const cv::Mat1f bands = PeriodicNoise(size, 14, 3, random);
  const cv::Mat1f grain =
      PeriodicNoise(size, size.width / 3, size.height / 5, random);
  image->setTo(ToPixel(color));
  Tone(bands, 0.012f, image);
  Tone(grain, 0.010f, image);
}

void PaintBrick(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  constexpr float kWidth = 0.25f;
  constexpr float kHeight = 0.08f;
  constexpr float kJoint = 0.011f;
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kBrick, *image);
  const int columns = Stones(image->cols, pixel.x(), kWidth);
  const int rows = Stones(image->rows, pixel.y(), kHeight);
  const Table light(columns, rows, random);
  const Table hue(columns, rows, random);
  const cv::Size size = image->size();
  const cv::Mat1f grain = FractalNoise(size, 40, 30, 3, random);
  const cv::Mat1f wobble = PeriodicNoise(size, 160, 100, random);
  const cv::Vec3f mortar(176, 182, 186);
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    Cell cell = CellOf(u, v, kWidth, kHeight, 0.5f * kWidth);
    const float inside =
        Inside(cell.edge + 0.0015f * wobble(y, x), kJoint, pixel.x());
    const float tone =
        1.0f + 0.17f * light(cell.column, cell.row) + 0.14f * grain(y, x);
    cv::Vec3f brick = color * tone;
    const float red = 0.09f * hue(cell.column, cell.row);
    brick[0] *= 1.0f - red;
    brick[2] *= 1.0f + red;
    return Mix(mortar * (1.0f + 0.06f * grain(y, x)), brick, inside);
  });
}

// ---- floors ----------------------------------------------------------------

// Wood of one board: `grain` runs along x in the image, shifted for each.
float WoodTone(const cv::Mat1f& grain, int x, int y, float light) {
  return 1.0f + 0.13f * light + 0.14f * grain(y, x);
}

void PaintPlanks(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  constexpr float kLength = 1.2f;
  constexpr float kWidth = 0.12f;
  constexpr int kShifts = 24;  // Steps of the boards' ends along a row.
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kPlanks, *image);
  const int columns = Stones(image->cols, pixel.x(), kLength);
  const int rows = Stones(image->rows, pixel.y(), kWidth);
  const Table light(columns, rows, random);
  std::vector<float> shifts;
  for (int i = 0; i < rows; ++i) {
    shifts.push_back(kLength * static_cast<float>(random->Index(kShifts)) /
                     static_cast<float>(kShifts));
  }
  const cv::Mat1f grain = FractalNoise(image->size(), 5, 12 * rows, 3, random);
  const float period = static_cast<float>(columns) * kLength;
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    const int row = static_cast<int>(v / kWidth);
    const float along =
        std::fmod(u + shifts[static_cast<std::size_t>(row)], period);
    const Cell cell = CellOf(along, v, kLength, kWidth, 0.0f);
    const float tone = WoodTone(grain, x, y, light(cell.column, cell.row));
    // A joint is a dark line of 2 mm.
    const float inside = Inside(cell.edge, 0.002f, pixel.y());
    return color * (tone * (0.45f + 0.55f * inside));
  });
}

void PaintParquet(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  constexpr float kSquare = 0.3f;
  constexpr int kFingers = 5;
  constexpr float kFinger = kSquare / kFingers;
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kParquet, *image);
  const int squares = Stones(image->cols, pixel.x(), kSquare);
  const Table light(squares * kFingers, squares * kFingers, random);
  const cv::Size size = image->size();
  const cv::Mat1f lying = FractalNoise(size, 12, 160, 2, random);
  const cv::Mat1f standing = FractalNoise(size, 160, 12, 2, random);
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    const Cell square = CellOf(u, v, kSquare, kSquare, 0.0f);
    const bool lies = (square.column + square.row) % 2 == 0;
    const float across = lies ? square.y : square.x;
    const int finger =
        std::min(static_cast<int>(across / kFinger), kFingers - 1);
    const float in_finger = across - static_cast<float>(finger) * kFinger;
    const float edge =
        std::min(square.edge, std::min(in_finger, kFinger - in_finger));
    const float shade = light(square.column * kFingers + finger,
                              square.row * kFingers + (lies ? 0 : 1));
    const float tone = WoodTone(lies ? lying : standing, x, y, shade);
    const float inside = Inside(edge, 0.0015f, pixel.x());
    return color * (tone * (0.5f + 0.5f * inside));
  });
}

void PaintTiles(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  constexpr float kTile = 0.3f;
  constexpr float kJoint = 0.005f;
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kTiles, *image);
  const int tiles = Stones(image->cols, pixel.x(), kTile);
  const Table light(tiles, tiles, random);
  const cv::Mat1f cloud = FractalNoise(image->size(), 24, 24, 4, random);
  const cv::Vec3f joint = color * 0.62f;
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    const Cell cell = CellOf(u, v, kTile, kTile, 0.0f);
    const float tone =
        1.0f + 0.07f * light(cell.column, cell.row) + 0.10f * cloud(y, x);
    return Mix(joint, color * tone, Inside(cell.edge, kJoint, pixel.x()));
  });
}

void PaintCarpet(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  const cv::Size size = image->size();
  const cv::Mat1f wear = FractalNoise(size, 3, 3, 3, random);
  const cv::Mat1f loops =
      PeriodicNoise(size, size.width / 2, size.height / 2, random);
  const cv::Mat1f flecks =
      PeriodicNoise(size, size.width / 5, size.height / 5, random);
  const cv::Vec3f other =
      cv::Vec3f(color[1], color[2], color[0]) * 0.55f + cv::Vec3f(60, 60, 60);
  ForEachPixel(image, {0.0f, 0.0f}, [&](int x, int y, float, float) {
    const float fleck = SmoothStep((flecks(y, x) - 0.45f) / 0.2f);
    const float tone = 1.0f + 0.06f * wear(y, x) + 0.16f * loops(y, x);
    return Mix(color, other, 0.7f * fleck) * tone;
  });
}

// ---- ceilings, furniture ---------------------------------------------------

void PaintCeilingPanels(const cv::Vec3f& color,
                        Random* random,
                        cv::Mat3b* image) {
  constexpr float kPanel = 0.6f;
  constexpr float kRail = 0.024f;
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kCeilingPanels, *image);
  const int panels = Stones(image->cols, pixel.x(), kPanel);
  const Table light(panels, panels, random);
  const cv::Size size = image->size();
  const cv::Mat1f worms = PeriodicNoise(size, 170, 130, random);
  const cv::Mat1f patches = PeriodicNoise(size, 40, 40, random);
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    const Cell cell = CellOf(u, v, kPanel, kPanel, 0.0f);
    // Fissures: where the fine noise is high, in patches.
    const float fissure =
        SmoothStep((worms(y, x) + 0.35f * patches(y, x) - 0.55f) / 0.2f);
    const cv::Vec3f panel =
        color * (1.0f + 0.02f * light(cell.column, cell.row) - 0.13f * fissure);
    const float inside = Inside(cell.edge, kRail, pixel.x());
    // The rail's shadow on the panel.
    const float groove = SmoothStep((cell.edge - 0.5f * kRail) / 0.008f);
    const cv::Vec3f rail = color * 1.03f;
    return Mix(rail, panel * (0.72f + 0.28f * groove), inside);
  });
}

void PaintFabric(const cv::Vec3f& color, Random* random, cv::Mat3b* image) {
  constexpr float kThread = 0.004f;
  constexpr int kChecks = 6;  // Bands of the check over the period.
  const Eigen::Vector2f pixel = PixelSize(PatternKind::kFabric, *image);
  const Table bands(kChecks, 2, random);
  const cv::Size size = image->size();
  const cv::Mat1f grain =
      PeriodicNoise(size, size.width / 2, size.height / 2, random);
  const Eigen::Vector2f period(pixel.x() * static_cast<float>(image->cols),
                               pixel.y() * static_cast<float>(image->rows));
  ForEachPixel(image, pixel, [&](int x, int y, float u, float v) {
    const int warp = static_cast<int>(u / kThread);
    const int weft = static_cast<int>(v / kThread);
    const bool is_warp = (warp + weft) % 2 == 0;
    const float band =
        is_warp ? bands(static_cast<int>(u / period.x() * kChecks), 0)
                : bands(static_cast<int>(v / period.y() * kChecks), 1);
    const float over = is_warp ? 1.0f : 0.93f;
    return color * (over * (1.0f + 0.16f * band + 0.08f * grain(y, x)));
  });
}

}  // namespace

Eigen::Vector2d PeriodOf(PatternKind kind) {
  switch (kind) {
    case PatternKind::kBrick:
      return {3.0, 2.56};  // 12 bricks, 32 courses.
    case PatternKind::kPlanks:
      return {3.6, 2.4};  // 3 boards, 20 rows.
    case PatternKind::kParquet:
      return {2.4, 2.4};  // 8 squares.
    case PatternKind::kTiles:
      return {2.4, 2.4};  // 8 tiles.
    case PatternKind::kCarpet:
      return {2.0, 2.0};
    case PatternKind::kCeilingPanels:
      return {2.4, 2.4};  // 4 panels.
    case PatternKind::kFabric:
      return {0.48, 0.48};  // 120 threads.
    case PatternKind::kPlaster:
    case PatternKind::kPaint:
      return {2.5, 2.5};
    default:
      return {1.0, 1.0};
  }
}

cv::Vec3b SurfaceColorOf(PatternKind kind) {
  switch (kind) {
    case PatternKind::kPlaster:
      return {206, 216, 220};
    case PatternKind::kPaint:
      return {212, 218, 214};
    case PatternKind::kBrick:
      return {118, 142, 186};
    case PatternKind::kPlanks:
      return {112, 152, 186};
    case PatternKind::kParquet:
      return {100, 146, 184};
    case PatternKind::kTiles:
      return {172, 178, 180};
    case PatternKind::kCarpet:
      return {148, 138, 132};
    case PatternKind::kCeilingPanels:
      return {226, 230, 230};
    case PatternKind::kFabric:
      return {150, 116, 96};
    default:
      return {220, 222, 222};
  }
}

void PaintSurface(PatternKind kind,
                  const cv::Vec3b& color,
                  std::uint64_t seed,
                  cv::Mat3b* image) {
  Random random(seed);
  switch (kind) {
    case PatternKind::kPlain:
      image->setTo(color);
      return;
    case PatternKind::kPlaster:
      PaintPlaster(color, &random, image);
      return;
    case PatternKind::kPaint:
      PaintPaint(color, &random, image);
      return;
    case PatternKind::kBrick:
      PaintBrick(color, &random, image);
      return;
    case PatternKind::kPlanks:
      PaintPlanks(color, &random, image);
      return;
    case PatternKind::kParquet:
      PaintParquet(color, &random, image);
      return;
    case PatternKind::kTiles:
      PaintTiles(color, &random, image);
      return;
    case PatternKind::kCarpet:
      PaintCarpet(color, &random, image);
      return;
    case PatternKind::kCeilingPanels:
      PaintCeilingPanels(color, &random, image);
      return;
    case PatternKind::kFabric:
      PaintFabric(color, &random, image);
      return;
    default:
      WAYMARK_CHECK(!IsOnePiece(kind), static_cast<int>(kind));
  }
}

}  // namespace waymark
