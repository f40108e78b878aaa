// Line segments of a grey image.
#pragma once

#include "estimation/lines/edge_chains.h"
#include "estimation/lines/edge_image.h"
#include "estimation/lines/line_types.h"
#include "estimation/lines/segment_merger.h"
#include "estimation/lines/segmented_hough.h"

#include <opencv2/core/mat.hpp>

namespace waymark {

enum class LineScheme {
  kSegmentedHough,  // The paper's: tiles of the edge image, joined.
  kEdgeChains,      // Edges followed along their gradient, joined.
};

struct LineExtractorOptions {
  EdgeImageOptions edges;
  LineScheme scheme = LineScheme::kEdgeChains;
  SegmentedHoughOptions hough;  // For kSegmentedHough.
  EdgeChainOptions chains;      // For kEdgeChains.
  SegmentMergerOptions merger;
  // Pixels whose crest lies farther than this from their line do not support
  // it; in (0, 5].
  double max_distance_px = 0.7;
  // Of the pixels of a segment this share at least must be left; in (0, 1].
  double min_support = 0.5;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Extracts the segments of images, one after another, and keeps the memory.
//
// The edge image, short pieces of lines, longer ones from them, and a fit to
// the crests of the gradient at their pixels, which are found to a fraction of
// a pixel. The result has polarity, its pixels are those crests. Its order and
// all its values depend on the image and the options alone.
class LineExtractor {
 public:
  explicit LineExtractor(const LineExtractorOptions& options = {});

  // Any size, none included; at most 32767 pixels a side (throws
  // std::invalid_argument).
  [[nodiscard]] LineSet Extract(const cv::Mat1b& image);

  // Of the last image; there must have been one.
  [[nodiscard]] const EdgeImage& edges() const { return *edges_; }

 private:
  // Appends the refined form of a segment, unless too little is left of it.
  void Refine(const LineSet& coarse, const LineSegment& segment, LineSet* set);

  LineExtractorOptions options_;
  EdgeDetector detector_;
  SegmentedHough hough_;
  EdgeChainFinder chains_;
  SegmentMerger merger_;
  const EdgeImage* edges_ = nullptr;
  LineParts parts_;
  std::vector<Eigen::Vector2f> crests_;
};

}  // namespace waymark
