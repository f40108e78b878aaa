#include "tests/bench/hough_accuracy.h"

#include "tests/bench/measure.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace waymark {
namespace {

// How well lines, of whatever length, lie on an exact edge: of those that pass
// both its ends within 1.5 px the nearest.
struct EdgeOffset {
  double middle_px = 0.0;  // Of the edge from the line,
  double far_px = 0.0;     // and of the end where it is farther.
};

// Of each edge of 20 px or more, in order; nullopt where no line is near.
std::vector<std::optional<EdgeOffset>> OffsetsOf(
    const std::vector<LineFrame>& frames,
    const std::vector<std::vector<FoundSegment>>& found) {
  std::vector<std::optional<EdgeOffset>> offsets;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (const TrueEdge& edge : frames[f].edges) {
      if ((edge.b - edge.a).norm() < 20.0) continue;
      std::optional<EdgeOffset> nearest;
      for (const FoundSegment& line : found[f]) {
        const Eigen::Vector2d d = (line.b - line.a).normalized();
        const Eigen::Vector2d n(-d.y(), d.x());
        const double at_a = n.dot(edge.a - line.a);
        const double at_b = n.dot(edge.b - line.a);
        const double far_px = std::max(std::abs(at_a), std::abs(at_b));
        const double middle_px = 0.5 * std::abs(at_a + at_b);
        if (far_px > 1.5 || (nearest && middle_px > nearest->middle_px)) {
          continue;
        }
        nearest = EdgeOffset{middle_px, far_px};
      }
      offsets.push_back(nearest);
    }
  }
  return offsets;
}

// The whole of each line of cv::HoughLines.
std::vector<FoundSegment> WholeLines(const std::vector<cv::Vec2f>& lines) {
  constexpr double kFar = 2000.0;  // px; beyond any corner.
  std::vector<FoundSegment> found;
  for (const cv::Vec2f& line : lines) {
    const double angle = static_cast<double>(line[1]);
    const Eigen::Vector2d n(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d foot = static_cast<double>(line[0]) * n;
    const Eigen::Vector2d d(-n.y(), n.x());
    found.push_back({foot - kFar * d, foot + kFar * d});
  }
  return found;
}

}  // namespace

cv::Mat1b CannyOf(const cv::Mat1b& image) {
  cv::Mat1b map;
  cv::Canny(image, map, 50.0, 150.0);
  return map;
}

std::vector<BenchRow> HoughAccuracyRows(
    const std::vector<LineFrame>& rendered,
    const std::function<std::vector<FoundSegment>(const cv::Mat1b&)>& find) {
  std::vector<std::vector<FoundSegment>> ours;
  std::vector<std::vector<FoundSegment>> theirs;
  for (const LineFrame& frame : rendered) {
    const cv::Mat1b map = CannyOf(frame.image);
    ours.push_back(find(map));
    std::vector<cv::Vec2f> lines;
    cv::HoughLines(map, lines, 1.0, CV_PI / 180.0, 120);
    theirs.push_back(WholeLines(lines));
  }
  const auto our = OffsetsOf(rendered, ours);
  const auto their = OffsetsOf(rendered, theirs);
  // Short edges are harder: only those count that both found.
  std::array<std::vector<double>, 2> middle;
  std::array<std::vector<double>, 2> far_end;
  std::int64_t num_ours = 0;
  std::int64_t num_theirs = 0;
  for (std::size_t i = 0; i < our.size(); ++i) {
    num_ours += our[i] ? 1 : 0;
    num_theirs += their[i] ? 1 : 0;
    if (!our[i] || !their[i]) continue;
    middle[0].push_back(our[i]->middle_px);
    middle[1].push_back(their[i]->middle_px);
    far_end[0].push_back(our[i]->far_px);
    far_end[1].push_back(their[i]->far_px);
  }
  const auto row_of = [](const std::string& name, double ours_px, double peer) {
    BenchRow row;
    row.id = "Y4";
    row.name = "8x8 words: " + name;
    row.value = ours_px;
    row.unit = "px";
    row.peer = "cv::HoughLines 1 px 1 degree";
    row.peer_value = peer;
    row.ratio = peer / std::max(1e-9, ours_px);
    row.goal = "no worse";
    row.holds = ours_px <= peer;
    return row;
  };
  std::vector<BenchRow> rows;
  if (!middle[0].empty()) {
    rows.push_back(row_of("offset from exact edges that both found, median",
                          Median(middle[0]),
                          Median(middle[1])));
    rows.push_back(row_of("the same at the edge's farther end, median",
                          Median(far_end[0]),
                          Median(far_end[1])));
    for (BenchRow& row : rows) {
      row.runs = static_cast<std::int64_t>(middle[0].size());
    }
  }
  BenchRow count = row_of("exact edges found",
                          static_cast<double>(num_ours),
                          static_cast<double>(num_theirs));
  count.unit = "";
  count.ratio = count.value / std::max(1.0, *count.peer_value);
  count.goal.clear();
  count.holds.reset();
  count.runs = static_cast<std::int64_t>(our.size());
  rows.push_back(count);
  return rows;
}

}  // namespace waymark
