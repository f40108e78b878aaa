// Long line segments from short pieces.
#pragma once

#include "estimation/lines/line_parts.h"
#include "estimation/lines/line_types.h"

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
// their order, and of many continuations the one with the least error is taken.
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
    LineFit fit;
    std::vector<std::int32_t> ahead;   // Codes 2 part + is_turned, in order.
    std::vector<std::int32_t> behind;  // The same, away from the first.
    Eigen::Vector2f a;
    Eigen::Vector2f b;
    bool is_turned;  // Against the direction of a directed set.
  };

  // Ends of pieces, at `near`, from which they lead to `far`; cell by cell, row
  // after row of them. Coordinates one after another, for four ends at a time.
  struct Ends {
    std::vector<float> near_x;  // Infinite once the piece is used.
    std::vector<float> near_y;
    std::vector<float> far_x;
    std::vector<float> far_y;
    std::vector<std::int32_t> code;  // 2 part, + 1 where `near` is its b.

    void Resize(std::size_t num);
  };

  // What a trace may go on with, and the best so far.
  struct Continuation {
    std::int32_t code = -1;
    LineMoments moments;
    LineFit fit;
    double least = 0.0;  // Mean square across.
  };

  void FillCells(const LineParts& parts, int width, int height);
  // Joins the best piece at the end b of the trace; false where there is none.
  bool Extend(const LineParts& parts);
  // Takes the end, an index of ends_, if it is better than what there is.
  void Consider(const LineParts& parts, std::size_t end, Continuation* best);
  void Use(std::size_t part);
  void Turn();
  void Emit(const LineParts& parts, LineSet* set);

  SegmentMergerOptions options_;
  int num_columns_ = 0;
  int num_rows_ = 0;
  std::vector<std::int32_t> first_;  // End of each cell, and one past the last.
  Ends ends_;
  std::vector<std::int32_t> end_of_;  // Of each code, its index in ends_.
  std::vector<char> is_used_;
  Trace trace_;
};

// Errors of a segment of this length whose pixels lie across_px (root mean
// square) from it. Sets sigma_px and sigma_rad.
void SetSegmentErrors(double across_px, LineSegment* segment);

}  // namespace waymark
