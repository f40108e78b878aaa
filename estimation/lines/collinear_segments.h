// Segments that are pieces of one line in the image, as one.
#pragma once

#include "estimation/lines/line_types.h"

#include <span>
#include <vector>

namespace waymark {

struct CollinearOptions {
  // Of a piece's ends from the line of the longest piece, px; in (0, 10].
  double max_distance_px = 1.5;
  // Between pieces, in lengths of what is joined so far; in [0, 100].
  double max_gap = 3.0;
  int max_lines = 1500;  // The longest are looked at; at least 1.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct JoinedSegments {
  // The longest first, ties in the order of their longest pieces.
  std::vector<LineSegment> segments;
  // Of each that was given, shortest ones left out included: how many pieces
  // its line has.
  std::vector<int> num_pieces;
};

// Joins pieces that lie along one line, a row of windows for example: what
// they say of their direction is one line's, however many they are. Each
// longest piece takes the shorter ones along it. A joined segment is the line
// of least squares of its pieces' offsets and directions, by their errors, to
// the outermost ends; its pixels are those of its longest piece.
//
// Cost O(N^2). Throws std::logic_error for segments that LineDirections
// refuses.
[[nodiscard]] JoinedSegments JoinCollinear(
    std::span<const LineSegment> segments, const CollinearOptions& options);

}  // namespace waymark
