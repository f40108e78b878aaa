#include "drivers/simulator/material_pattern.h"

#include "drivers/simulator/pattern_boards.h"
#include "drivers/simulator/pattern_pictures.h"
#include "drivers/simulator/pattern_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

struct PatternName {
  PatternKind kind;
  std::string_view name;
};

constexpr std::array<PatternName, 14> kNames{{
    {PatternKind::kPlain, "plain"},
    {PatternKind::kPlaster, "plaster"},
    {PatternKind::kPaint, "paint"},
    {PatternKind::kBrick, "brick"},
    {PatternKind::kPlanks, "planks"},
    {PatternKind::kParquet, "parquet"},
    {PatternKind::kDoor, "door"},
    {PatternKind::kTiles, "tiles"},
    {PatternKind::kCarpet, "carpet"},
    {PatternKind::kCeilingPanels, "ceiling_panels"},
    {PatternKind::kFabric, "fabric"},
    {PatternKind::kNoticeboard, "noticeboard"},
    {PatternKind::kPicture, "picture"},
    {PatternKind::kSign, "sign"},
}};

Eigen::Vector2d SizeOf(const PatternOptions& options) {
  if (options.size) return *options.size;
  switch (options.kind) {
    case PatternKind::kDoor:
      return {0.9, 2.05};
    case PatternKind::kNoticeboard:
      return {1.6, 1.1};
    case PatternKind::kPicture:
      return {0.9, 0.7};
    case PatternKind::kSign:
      return {0.24, 0.12};
    default:
      return PeriodOf(options.kind);
  }
}

double DensityOf(const PatternOptions& options) {
  if (options.pixels_per_metre > 0.0) return options.pixels_per_metre;
  switch (options.kind) {
    case PatternKind::kFabric:
    case PatternKind::kSign:
      return 800.0;
    case PatternKind::kPicture:
    case PatternKind::kNoticeboard:
      return 400.0;
    case PatternKind::kCarpet:
    case PatternKind::kDoor:
    case PatternKind::kPlanks:
      return 300.0;
    default:
      return 256.0;
  }
}

cv::Size PixelsOf(const PatternOptions& options) {
  if (options.kind == PatternKind::kPlain) return {1, 1};
  const Eigen::Vector2d pixels =
      (DensityOf(options) * SizeOf(options)).array().round();
  return {std::max(1, static_cast<int>(pixels.x())),
          std::max(1, static_cast<int>(pixels.y()))};
}

[[noreturn]] void Refuse(const PatternOptions& options,
                         const std::string& what) {
  throw std::invalid_argument("pattern " + NameOf(options.kind) + ": " + what);
}

}  // namespace

std::string NameOf(PatternKind kind) {
  for (const PatternName& entry : kNames) {
    if (entry.kind == kind) return std::string(entry.name);
  }
  return "unknown";
}

std::optional<PatternKind> PatternFromName(std::string_view name) {
  for (const PatternName& entry : kNames) {
    if (entry.name == name) return entry.kind;
  }
  return std::nullopt;
}

std::vector<std::string> PatternNames() {
  std::vector<std::string> names;
  for (const PatternName& entry : kNames) names.emplace_back(entry.name);
  return names;
}

bool IsOnePiece(PatternKind kind) {
  return kind == PatternKind::kDoor || kind == PatternKind::kNoticeboard ||
         kind == PatternKind::kPicture || kind == PatternKind::kSign;
}

void PatternOptions::Check() const {
  if (color) {
    for (int i = 0; i < 3; ++i) {
      const int value = (*color)[i];
      if (value < kMinPatternValue || value > kMaxPatternValue) {
        Refuse(*this,
               "color has " + std::to_string(value) + ", not in [" +
                   std::to_string(kMinPatternValue) + ", " +
                   std::to_string(kMaxPatternValue) + "]");
      }
    }
  }
  if (size && !IsOnePiece(kind)) {
    Refuse(*this, "it repeats with a period of its own and takes no size");
  }
  if (size && !((size->array() >= 0.01).all() &&
                (size->array() <= kMaxPatternSize).all())) {
    Refuse(*this, "size must be in [0.01, 10] m");
  }
  if (!(pixels_per_metre >= 0.0 && pixels_per_metre <= kMaxPatternDensity)) {
    Refuse(*this, "pixels_per_metre must be in [0, 4000], 0 for its own");
  }
  const cv::Size pixels = PixelsOf(*this);
  if (static_cast<double>(pixels.width) * pixels.height > kMaxPatternPixels) {
    Refuse(*this,
           "would have " + std::to_string(pixels.width) + " x " +
               std::to_string(pixels.height) + " pixels, more than 16777216");
  }
  if (!text.empty() && kind != PatternKind::kSign &&
      kind != PatternKind::kPicture) {
    Refuse(*this, "takes no text");
  }
  if (kind != PatternKind::kDoor && (notices != 0 || has_handle_left)) {
    Refuse(*this, "only doors have notices and handles");
  }
  for (const char c : text) {
    const bool is_printable = c >= ' ' && c <= '~';
    if (!is_printable && !(c == '\n' && kind == PatternKind::kSign)) {
      Refuse(*this, "text may have printable ASCII characters only");
    }
  }
}

PatternTexture MakePattern(const PatternOptions& options) {
  options.Check();
  PatternTexture texture;
  texture.size = SizeOf(options);
  texture.is_one_piece = IsOnePiece(options.kind);
  texture.image.create(PixelsOf(options));
  const double density = DensityOf(options);
  switch (options.kind) {
    case PatternKind::kDoor:
      PaintDoor(options.color,
                density,
                options.seed,
                options.has_handle_left,
                &texture.image);
      if (options.notices != 0) {
        PaintNotices(density, options.notices, &texture.image);
      }
      break;
    case PatternKind::kNoticeboard:
      PaintNoticeboard(options.color, density, options.seed, &texture.image);
      break;
    case PatternKind::kPicture:
      PaintFramedPicture(
          options.color, options.text, density, options.seed, &texture.image);
      break;
    case PatternKind::kSign:
      PaintSign(options.color, options.text, &texture.image);
      break;
    default:
      PaintSurface(options.kind,
                   options.color.value_or(SurfaceColorOf(options.kind)),
                   options.seed,
                   &texture.image);
  }
  return texture;
}

}  // namespace waymark
