#include "tests/bench/york_bench.h"

#include "estimation/geometry/angle.h"
#include "estimation/lines/line_extractor.h"
#include "estimation/lines/manhattan_directions.h"
#include "tests/bench/line_frames.h"
#include "tests/bench/measure.h"
#include "tests/bench/vanishing_peers.h"
#include "tests/support/york_urban.h"

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Method {
  std::string name;
  std::function<std::optional<Matrix3d>(std::size_t image)> find;
  std::vector<double> angles_deg{};
  std::vector<double> seconds{};
};

std::optional<Matrix3d> Ours(std::span<const LineSegment> lines) {
  const ManhattanReport report =
      FindManhattanDirections(lines, YorkView(), std::nullopt, {});
  if (!report.directions) return std::nullopt;
  return report.directions->R_CM;
}

std::vector<LineSegment> SegmentsFrom(const std::vector<cv::Vec4f>& lines) {
  std::vector<LineSegment> segments;
  for (const cv::Vec4f& l : lines) {
    const Vector2d a(static_cast<double>(l[0]), static_cast<double>(l[1]));
    const Vector2d b(static_cast<double>(l[2]), static_cast<double>(l[3]));
    if (a != b) segments.push_back(SegmentBetween(a, b));
  }
  return segments;
}

// That of time is the estimator's; from pixels finding the lines counts too.
enum class Goals { kNone, kAccuracy, kAll };

void AddScores(const Method& method,
               const Method* peer,
               Goals goals,
               std::vector<BenchRow>* rows) {
  const DirectionScore score = ScoreAngles(method.angles_deg);
  const DirectionScore other =
      peer == nullptr ? DirectionScore{} : ScoreAngles(peer->angles_deg);
  const auto add = [&](const std::string& what,
                       const std::string& unit,
                       double value,
                       double peer_value,
                       double goal,
                       bool is_more_better,
                       bool has_goal) {
    rows->push_back(RowOf("Y8",
                          method.name + ", " + what,
                          value,
                          unit,
                          method.angles_deg.size() / 3));
    BenchRow& row = rows->back();
    if (peer != nullptr) {
      row.peer = peer->name;
      row.peer_value = peer_value;
      row.ratio = is_more_better ? value / peer_value : peer_value / value;
    }
    if (!has_goal) return;
    char text[32];
    std::snprintf(text, sizeof text, is_more_better ? ">= %g" : "<= %g", goal);
    row.goal = text;
    row.holds = is_more_better ? value >= goal : value <= goal;
  };
  const bool is_judged = goals != Goals::kNone;
  add("AUC@3", "", score.auc_3, other.auc_3, 0.66, true, is_judged);
  add("AUC@5", "", score.auc_5, other.auc_5, 0.80, true, is_judged);
  add("AUC@10", "", score.auc_10, other.auc_10, 0.90, true, is_judged);
  add("median",
      "deg",
      score.median_deg,
      other.median_deg,
      0.8,
      false,
      is_judged);
  if (method.seconds.empty()) return;
  add("time",
      "ms",
      1e3 * Median(method.seconds),
      peer == nullptr ? 0.0 : 1e3 * Median(peer->seconds),
      2.5,
      false,
      goals == Goals::kAll);
}

}  // namespace

std::vector<BenchRow> BenchYork(bool full) {
  cv::setNumThreads(1);
  const std::vector<YorkPhotograph> photographs = ReadYorkPhotographs();
  const std::vector<LineFrame> images = YorkFrames(51);
  if (photographs.empty() || images.size() != photographs.size()) {
    std::printf("vanishing: no York photographs, WAYMARK_DATA\n");
    return {};
  }
  LineExtractor extractor;
  const auto lsd = cv::createLineSegmentDetector(cv::LSD_REFINE_STD);
  const auto given = [&](std::size_t i) {
    return std::span<const LineSegment>(photographs[i].segments);
  };
  std::vector<Method> methods{
      {"given segments", [&](std::size_t i) { return Ours(given(i)); }},
      {"from pixels",
       [&](std::size_t i) {
         return Ours(extractor.Extract(images[i].image).segments);
       }},
      {"2-line search, given segments",
       [&](std::size_t i) { return TwoLineSearch(given(i), YorkView()); }},
      {"LSD from pixels, ours after it",
       [&](std::size_t i) {
         std::vector<cv::Vec4f> lines;
         lsd->detect(images[i].image, lines);
         return Ours(SegmentsFrom(lines));
       }},
      {"LSD from pixels, 2-line search after it", [&](std::size_t i) {
         std::vector<cv::Vec4f> lines;
         lsd->detect(images[i].image, lines);
         return TwoLineSearch(SegmentsFrom(lines), YorkView());
       }}};
  if (full) {
    methods.push_back(
        {"2-line search of all pairs, given segments", [&](std::size_t i) {
           return TwoLineSearchOfAllPairs(given(i), YorkView());
         }});
  }
  Method ceiling{"the labels' nearest rotation", {}};
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const Matrix3d& truth = photographs[i].axes_C;
    const auto judge = [&](const Matrix3d& found, Method* method) {
      for (const double angle : AxisAngles(truth, found)) {
        method->angles_deg.push_back(DegreesFromRadians(angle));
      }
    };
    for (Method& method : methods) {
      std::optional<Matrix3d> found;
      method.seconds.push_back(CpuSecondsOf([&] { found = method.find(i); }));
      // No answer: as wrong as can be.
      if (!found) method.angles_deg.insert(method.angles_deg.end(), 3, 90.0);
      if (found) judge(*found, &method);
    }
    judge(NearestOrthogonal(truth), &ceiling);
  }
  std::vector<BenchRow> rows;
  AddScores(methods[0], &methods[2], Goals::kAll, &rows);
  AddScores(methods[1], &methods[4], Goals::kAccuracy, &rows);
  AddScores(methods[3], &methods[4], Goals::kNone, &rows);
  if (full) AddScores(methods[5], nullptr, Goals::kNone, &rows);
  AddScores(ceiling, nullptr, Goals::kNone, &rows);
  return rows;
}

}  // namespace waymark
