// How well lines of edge maps lie on exact edges, beside cv::HoughLines.
#pragma once

#include "tests/bench/bench_report.h"
#include "tests/bench/line_frames.h"

#include <opencv2/core.hpp>

#include <functional>
#include <vector>

namespace waymark {

// cv::Canny's usual thresholds on unsmoothed Sobel sums.
[[nodiscard]] cv::Mat1b CannyOf(const cv::Mat1b& image);

// Rows of Y4: `find` and cv::HoughLines on the same edge maps of frames with
// exact edges.
[[nodiscard]] std::vector<BenchRow> HoughAccuracyRows(
    const std::vector<LineFrame>& rendered,
    const std::function<std::vector<FoundSegment>(const cv::Mat1b&)>& find);

}  // namespace waymark
