// Procedural looks of walls, floors, furniture and what hangs on walls.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

enum class PatternKind : std::uint8_t {
  kPlain,          // One colour, no feature at all.
  kPlaster,        // Faint mottling.
  kPaint,          // Fainter still: the marks of a roller.
  kBrick,          // Running bond.
  kPlanks,         // Boards along u.
  kParquet,        // Fingers in squares of alternating direction.
  kDoor,           // A leaf with panels and a handle. One piece.
  kTiles,          // Squares and joints.
  kCarpet,         // Loops and flecks.
  kCeilingPanels,  // Perforated panels in a grid of rails.
  kFabric,         // Woven checks.
  kNoticeboard,    // Pinned papers on cork. One piece.
  kPicture,        // A framed picture, another for every seed. One piece.
  kSign,           // Text on a plate. One piece.
};

// "plain", "plaster", "paint", "brick", "planks", "parquet", "door", "tiles",
// "carpet", "ceiling_panels", "fabric", "noticeboard", "picture", "sign".
[[nodiscard]] std::string NameOf(PatternKind kind);
[[nodiscard]] std::optional<PatternKind> PatternFromName(std::string_view name);
// All names in the order of the enumeration, for error messages.
[[nodiscard]] std::vector<std::string> PatternNames();
// True: one piece, to be stretched over the whole face it is on. False:
// repeats without a seam.
[[nodiscard]] bool IsOnePiece(PatternKind kind);

struct PatternOptions {
  PatternKind kind = PatternKind::kPlain;
  // Main colour, BGR as an image shows it, each in [kMinPatternValue,
  // kMaxPatternValue]. Absent: that of the kind; pictures and noticeboards
  // colour their frame with it.
  std::optional<cv::Vec3b> color;
  // What one piece covers, m. Absent: the usual size of the kind. A kind that
  // repeats has its own period and takes no size.
  std::optional<Eigen::Vector2d> size;
  double pixels_per_metre = 0.0;  // 0: that of the kind.
  // kSign: its lines, split at '\n'; kPicture: a title below; others: none.
  std::string text;
  std::uint64_t seed = 1;
  // kDoor only: which papers hang on it, 0 for none; and where its handle is,
  // as one looks at it.
  std::uint64_t notices = 0;
  bool has_handle_left = false;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Values that nothing goes below or above, so that no camera finds black or
// burnt pixels in a texture.
inline constexpr int kMinPatternValue = 10;
inline constexpr int kMaxPatternValue = 245;
inline constexpr double kMaxPatternSize = 10.0;        // m.
inline constexpr double kMaxPatternDensity = 4000.0;   // Pixels per metre.
inline constexpr int kMaxPatternPixels = 4096 * 4096;  // Of one texture.

struct PatternTexture {
  cv::Mat3b image;                                 // BGR; v goes down.
  Eigen::Vector2d size = Eigen::Vector2d::Ones();  // m, of one repetition.
  bool is_one_piece = false;
};

// The same options give the same bytes. Throws std::invalid_argument where
// options.Check() does. Cost: some 50 ns a pixel,
// twice that for noticeboards.
[[nodiscard]] PatternTexture MakePattern(const PatternOptions& options);

}  // namespace waymark
