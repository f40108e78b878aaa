// Which pieces may continue a line. Internal to the merging of segments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace waymark {

// Ends of pieces, cell by cell, row after row of cells. Coordinates one after
// another, for several pieces at a time: up to kPieceLanes more are read than
// are asked for. What is not a number continues nothing.
struct PieceEnds {
  const float* ax;
  const float* ay;
  const float* bx;
  const float* by;
};
inline constexpr std::size_t kPieceLanes = 8;

// At most three cells of at most three rows.
struct PieceRows {
  const std::int32_t* first;  // Piece of the first cell of the first row.
  int stride;                 // To the next row.
  int num_columns;
  int num_rows;
};

// The end of a line, and the direction in which it goes on, of length 1.
struct LineEnd {
  float x;
  float y;
  float dx;
  float dy;
  // Of the nearer end of a piece, along the line and across it, px.
  float least_step;  // Below 0: it may begin a little behind the line's end.
  float most_step;
  float aside;
  float turn;  // Across at its farther end, as a share of the distance along.
};

// Writes twice the index of each piece that may continue the line, one more
// where its b is the nearer end, in order; returns what follows the last.
using FindNearPieces = std::int32_t* (*)(const PieceEnds& ends,
                                         const PieceRows& rows,
                                         const LineEnd& line,
                                         std::int32_t* found);

// All that this processor can run, with the same results: the portable one
// first, the fastest last.
[[nodiscard]] std::vector<FindNearPieces> FindNearPiecesVariants();

}  // namespace waymark
