// Long line segments from short pieces.
#pragma once

#include "estimation/lines/line_parts.h"
#include "estimation/lines/line_types.h"
#include "estimation/lines/near_pieces.h"
#include "estimation/lines/tile_order.h"

#include <array>
#include <cstdint>
#include <vector>

namespace waymark {

struct SegmentMergerOptions {
  // Two pieces join where the ends are no farther than this from each other,
  // in (0, 64]. Three pixels in the corner of a tile, too few for a piece,
  // leave a gap of four, 5.7 px along a diagonal.
  double max_gap_px = 6.0;
  // ... and where all their pixels together lie this close to one line, root
  // mean square, and their ends within three times that. In (0, 10].
  double max_rms_px = 0.6;
  double min_length_px = 10.0;  // Shorter segments are left out. At least 1.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Traces pieces from end to end and joins two iff their combined pixels still
// describe a line [1]: by sums, in constant time for each pair. The ends are
// those of the pixels on the fitted line. Deterministic: pieces are begun in
// their order; of many continuations the one with the least error is taken, and
// of equal ones the nearest.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009, section III.A.
class SegmentMerger {
 public:
  explicit SegmentMerger(const SegmentMergerOptions& options = {});

  // Pixels of `parts` lie in [0, width) x [0, height).
  [[nodiscard]] LineSet Merge(const LineParts& parts, int width, int height);

 private:
  struct Trace {
    LineMoments moments;
    Eigen::Vector2f direction;         // From a to b, of length 1.
    std::vector<std::int32_t> ahead;   // Codes 2 part + is_turned, in order.
    std::vector<std::int32_t> behind;  // The same, away from the first.
    Eigen::Vector2f a;
    Eigen::Vector2f b;
    bool is_turned;  // Against the direction of a directed set.
  };

  // Ends of pieces, cell by cell, row after row of them: see PieceEnds.
  struct Pieces {
    std::vector<float> ax;  // Not a number once the piece is used.
    std::vector<float> ay;
    std::vector<float> bx;
    std::vector<float> by;
    std::vector<std::int32_t> part;

    void Resize(std::size_t num);
  };

  // What a trace may go on with, and the best so far.
  struct Continuation {
    std::int32_t code = -1;
    LineMoments moments;
    Eigen::Vector2f direction;
    double least = 0.0;  // Mean square across.
    float step = 0.0f;   // To its nearer end, along the trace.
  };

  [[nodiscard]] bool AreTilesCells() const;
  [[nodiscard]] int CellOf(float value) const;
  void FillCells(const LineParts& parts, int width, int height);
  // Joins the best piece at the end b of the trace; false where there is none.
  bool Extend(const LineParts& parts);
  // Takes the piece if it is better than what there is.
  void Consider(const LineParts& parts, std::int32_t code, Continuation* best);
  void Use(std::size_t part);
  void Turn();
  void Emit(const LineParts& parts, LineSet* set);
  // The pixels of the trace, from its end a to b.
  void AppendListed(const LineParts& parts,
                    std::vector<Eigen::Vector2f>* pixels) const;
  void AppendTiles(const LineParts& parts,
                   const Eigen::Vector2f& direction,
                   std::vector<Eigen::Vector2f>* pixels) const;
  void SortAlong(const Eigen::Vector2f& direction,
                 Eigen::Vector2f* pixels,
                 std::size_t num);

  SegmentMergerOptions options_;
  int num_columns_ = 0;
  int num_rows_ = 0;
  float cells_per_px_ = 0.0f;  // No continuation begins farther away.
  // Of each cell its first of pieces_, and one past the last.
  std::vector<std::int32_t> first_;
  Pieces pieces_;
  std::vector<std::array<std::int32_t, 2>> entries_of_;  // Of each part.
  std::vector<char> is_used_;
  std::vector<char> has_unused_;  // Of each row of cells: pieces passed over.
  Trace trace_;
  int first_row_ = 0;  // Of cells, where there may be unused pieces.
  FindNearPieces find_near_ = FindNearPiecesVariants().back();
  ListTilePixels list_pixels_ = ListTilePixelsVariants().back();
  std::vector<std::int32_t> near_;  // Of pieces_, as found.
  std::vector<float> places_;       // Along the trace, of its pixels.
};

// Errors of a segment of this length, px, whose pixels lie `across` (mean
// square, px^2) from it. Sets sigma_px and sigma_rad.
void SetSegmentErrors(double across, double length, LineSegment* segment);

}  // namespace waymark
