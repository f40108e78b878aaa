// Short line pieces from an edge map, tile by tile.
#pragma once

#include "estimation/lines/edge_image.h"
#include "estimation/lines/line_parts.h"

#include <memory>

namespace waymark {

enum class HoughForm {
  // As published [1]: a Hough transform of each 10 x 10 sub-image by tables,
  // from pixel to cells and from cell to pixels. The fullest cell takes its
  // pixels out of the others, until none is full enough.
  kLiteral,
  // Tiles of 8 x 8 pixels as one 64-bit word. Connected pixels that lie on a
  // line by their sums, which tables give row by row, are a piece as they are;
  // from others the fullest of a table of lines takes its pixels by one AND.
  kWords,
};

struct SegmentedHoughOptions {
  HoughForm form = HoughForm::kWords;
  int min_pixels = 4;       // Of a piece; in [2, 8].
  double max_rms_px = 0.5;  // Of a piece's pixels across its line, in (0, 2].

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Needs the bits of the edge image alone. Pixels of pieces are each counted
// once; a piece has no direction. Time is proportional to the number of tiles
// with edges.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009, section III.A.
class SegmentedHough {
 public:
  explicit SegmentedHough(const SegmentedHoughOptions& options = {});
  ~SegmentedHough();
  SegmentedHough(SegmentedHough&&) noexcept;
  SegmentedHough& operator=(SegmentedHough&&) noexcept;

  void Find(const EdgeImage& edges, LineParts* parts) const;

 private:
  struct Tables;

  void FindLiteral(const EdgeImage& edges, LineParts* parts) const;
  void FindWords(const EdgeImage& edges, LineParts* parts) const;

  SegmentedHoughOptions options_;
  std::unique_ptr<const Tables> tables_;
};

}  // namespace waymark
