// Lines: edge images, segmented Hough transforms, segments of grey images.

#include "estimation/lines/line_extractor.h"
#include "estimation/lines/segment_merger.h"
#include "estimation/lines/segmented_hough.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/hough_accuracy.h"
#include "tests/bench/line_frames.h"
#include "tests/bench/line_race.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>
#include <opencv2/ximgproc/fast_line_detector.hpp>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

std::vector<LineFrame> AllFrames(bool full) {
  std::vector<LineFrame> frames = RenderedLineFrames(full ? 40 : 10);
  const std::vector<LineFrame> york = YorkFrames(full ? 51 : 12);
  if (york.empty()) std::printf("lines: no York photographs, WAYMARK_DATA\n");
  frames.insert(frames.end(), york.begin(), york.end());
  return frames;
}

std::vector<std::vector<FoundSegment>> FindAll(
    const std::vector<LineFrame>& frames,
    const std::function<std::vector<FoundSegment>(const cv::Mat1b&)>& find) {
  std::vector<std::vector<FoundSegment>> found;
  found.reserve(frames.size());
  for (const LineFrame& frame : frames) found.push_back(find(frame.image));
  return found;
}

// ---- Y1: the edge image ----------------------------------------------------

std::vector<BenchRow> BenchEdges(bool full) {
  cv::setNumThreads(1);
  const std::vector<LineFrame> frames = AllFrames(full);
  const std::vector<LineFrame> rendered = RenderedLineFrames(full ? 40 : 10);
  EdgeImageOptions classic;
  classic.suppression = EdgeSuppression::kFourDirections;
  EdgeDetector two_axes;
  EdgeDetector four_directions(classic);
  std::vector<Contender> contenders{
      {"two axes", [&](const LineFrame& f) { two_axes.Detect(f.image); }},
      {"four directions",
       [&](const LineFrame& f) { four_directions.Detect(f.image); }},
      {"cv::Canny", [](const LineFrame& f) { (void)CannyOf(f.image); }}};
  Race(frames, full ? 5 : 3, &contenders);
  std::vector<BenchRow> rows;
  BenchRow time =
      TimeRow("Y1", "edge image, 640x480", contenders[0], contenders[2]);
  time.goal = "<= 1 ms";
  time.holds = time.value <= 1.0;
  rows.push_back(time);
  double num_two = 0.0;
  double num_four = 0.0;
  // The same smoothing and thresholds by cv::Canny on our gradients.
  double num_canny = 0.0;
  for (const LineFrame& frame : frames) {
    const EdgeImage& edges = two_axes.Detect(frame.image);
    num_two += cv::countNonZero(edges.ToMat());
    const cv::Mat1s dx(
        edges.height, edges.stride, const_cast<std::int16_t*>(edges.dx.data()));
    const cv::Mat1s dy(
        edges.height, edges.stride, const_cast<std::int16_t*>(edges.dy.data()));
    cv::Mat1b map;
    const EdgeImageOptions options;
    cv::Canny(dx.colRange(0, edges.width).clone(),
              dy.colRange(0, edges.width).clone(),
              map,
              128.0 * options.low,
              128.0 * options.high);
    num_canny += cv::countNonZero(map);
    num_four += cv::countNonZero(four_directions.Detect(frame.image).ToMat());
  }
  const auto n = static_cast<double>(frames.size());
  BenchRow count;
  count.id = "Y1";
  count.name = "edge pixels a frame, two axes";
  count.value = num_two / n;
  count.unit = "px";
  count.peer = "cv::Canny on the same gradients";
  count.peer_value = num_canny / n;
  count.ratio = num_canny / num_two;
  count.goal = "thinner";
  count.holds = num_two < num_canny;
  count.runs = static_cast<std::int64_t>(frames.size());
  rows.push_back(count);
  count.name = "edge pixels a frame, four directions";
  count.value = num_four / n;
  count.ratio = num_canny / num_four;
  count.goal.clear();
  count.holds.reset();
  rows.push_back(count);
  for (const bool is_classic : {false, true}) {
    LineExtractorOptions options;
    if (is_classic) options.edges = classic;
    LineExtractor extractor(options);
    const LineScore score =
        ScoreSegments(rendered, FindAll(rendered, [&](const cv::Mat1b& image) {
                        return FoundFrom(extractor.Extract(image));
                      }));
    BenchRow accuracy;
    accuracy.id = "Y1";
    accuracy.name = std::string("line offset, median, ") +
                    (is_classic ? "four directions" : "two axes");
    accuracy.value = score.median_offset_px;
    accuracy.unit = "px";
    accuracy.runs = static_cast<std::int64_t>(rendered.size());
    rows.push_back(accuracy);
  }
  return rows;
}

// ---- Y2, Y4: segments of an edge map ---------------------------------------

std::vector<BenchRow> BenchHough(bool full) {
  cv::setNumThreads(1);
  std::vector<LineFrame> frames = AllFrames(full);
  std::vector<LineFrame> rendered;
  for (LineFrame& frame : frames) {
    if (!frame.edges.empty()) rendered.push_back(frame);
    frame.image = CannyOf(frame.image);
  }
  SegmentedHoughOptions literal_options;
  literal_options.form = HoughForm::kLiteral;
  const SegmentedHough literal(literal_options);
  const SegmentedHough words;
  SegmentMerger merger;
  EdgeImage edges;
  LineParts parts;
  const auto segments_of = [&](const SegmentedHough& hough,
                               const cv::Mat1b& map) {
    SetEdgeBits(map, &edges);
    hough.Find(edges, &parts);
    return merger.Merge(parts, map.cols, map.rows);
  };
  std::vector<Contender> contenders{
      {"10x10 tables",
       [&](const LineFrame& f) { (void)segments_of(literal, f.image); }},
      {"8x8 words",
       [&](const LineFrame& f) { (void)segments_of(words, f.image); }},
      {"cv::HoughLines 1 px 1 degree", [](const LineFrame& f) {
         std::vector<cv::Vec2f> lines;
         // A fourth of the smaller side must lie on a line.
         cv::HoughLines(f.image, lines, 1.0, CV_PI / 180.0, 120);
       }}};
  Race(frames, full ? 5 : 3, &contenders);
  std::vector<BenchRow> rows;
  BenchRow fast = TimeRow("Y4",
                          "segmented Hough and merging, 8x8 words",
                          contenders[1],
                          contenders[2]);
  fast.published = 15.0;
  fast.goal = "15 times faster, goal 25";
  fast.holds = *fast.ratio >= 15.0;
  BenchRow slow = TimeRow("Y4",
                          "segmented Hough and merging, 10x10 tables",
                          contenders[0],
                          contenders[2]);
  slow.published = 15.0;
  rows.push_back(fast);
  rows.push_back(slow);
  for (const SegmentedHough* hough : {&literal, &words}) {
    const LineScore score =
        ScoreSegments(rendered, FindAll(rendered, [&](const cv::Mat1b& image) {
                        return FoundFrom(segments_of(*hough, CannyOf(image)));
                      }));
    const std::string name = hough == &literal ? "10x10 tables" : "8x8 words";
    BenchRow row;
    row.id = "Y2";
    row.name = "segments of an edge map, " + name + ": offset, median";
    row.value = score.median_offset_px;
    row.unit = "px";
    row.runs = static_cast<std::int64_t>(rendered.size());
    rows.push_back(row);
    row.name = "segments of an edge map, " + name + ": recall";
    row.value = score.recall;
    row.unit = "at precision " + std::to_string(score.precision).substr(0, 4);
    rows.push_back(row);
  }
  for (BenchRow& row : HoughAccuracyRows(rendered, [&](const cv::Mat1b& map) {
         return FoundFrom(segments_of(words, map));
       })) {
    rows.push_back(std::move(row));
  }
  return rows;
}

// ---- Y4-grey: segments of a grey image --------------------------------------

std::vector<FoundSegment> FoundFrom(const std::vector<cv::Vec4f>& lines) {
  std::vector<FoundSegment> found;
  for (const cv::Vec4f& l : lines) {
    found.push_back({{static_cast<double>(l[0]), static_cast<double>(l[1])},
                     {static_cast<double>(l[2]), static_cast<double>(l[3])}});
  }
  return found;
}

struct NamedScore {
  std::string name;
  LineScore score;
};

// Recall and offset of the first two, ours, beside each of the others.
std::vector<BenchRow> ScoreRows(const std::string& worlds,
                                const std::vector<NamedScore>& scores,
                                std::size_t num_frames) {
  std::vector<BenchRow> rows;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [name, ours] = scores[i];
    for (std::size_t k = 2; k < scores.size(); ++k) {
      const auto& [peer, theirs] = scores[k];
      BenchRow recall;
      recall.id = "Y4-grey";
      recall.name = "recall, " + worlds + ", " + name;
      recall.value = ours.recall;
      recall.unit =
          "at precision " + std::to_string(ours.precision).substr(0, 4);
      recall.peer =
          peer + " at " + std::to_string(theirs.precision).substr(0, 4);
      recall.peer_value = theirs.recall;
      recall.ratio = recall.value / std::max(1e-9, theirs.recall);
      recall.goal = "higher";
      recall.holds = *recall.ratio > 1.0;
      recall.runs = static_cast<std::int64_t>(num_frames);
      rows.push_back(recall);
      BenchRow offset = recall;
      offset.name = "offset, median, " + worlds + ", " + name;
      offset.value = ours.median_offset_px;
      offset.unit = "px";
      offset.peer = peer;
      offset.peer_value = theirs.median_offset_px;
      offset.ratio = *offset.peer_value / std::max(1e-9, offset.value);
      offset.goal = "<= 0.15 px";
      offset.holds = offset.value <= 0.15;
      rows.push_back(offset);
    }
    BenchRow sigma;
    sigma.id = "Y4-grey";
    sigma.name = "offset over its sigma, median, " + worlds + ", " + name;
    sigma.value = ours.median_ratio;
    sigma.unit = "sigma";
    sigma.goal = "0.67 of a normal error";
    sigma.runs = static_cast<std::int64_t>(num_frames);
    rows.push_back(sigma);
  }
  return rows;
}

std::vector<BenchRow> BenchGrey(bool full) {
  cv::setNumThreads(1);
  const std::vector<LineFrame> frames = AllFrames(full);
  LineExtractorOptions tile_options;
  tile_options.scheme = LineScheme::kSegmentedHough;
  LineExtractor chains;
  LineExtractor tiles(tile_options);
  const auto lsd = cv::createLineSegmentDetector(cv::LSD_REFINE_STD);
  const auto fld = cv::ximgproc::createFastLineDetector();
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  using Find = std::function<std::vector<FoundSegment>(const cv::Mat1b&)>;
  struct Method {
    std::string name;
    Find find;
  };
  const std::vector<Method> methods{
      {"edge chains",
       [&](const cv::Mat1b& i) { return FoundFrom(chains.Extract(i)); }},
      {"segmented Hough",
       [&](const cv::Mat1b& i) { return FoundFrom(tiles.Extract(i)); }},
      {"LSD",
       [&](const cv::Mat1b& i) {
         std::vector<cv::Vec4f> lines;
         lsd->detect(i, lines);
         return FoundFrom(lines);
       }},
      {"FastLineDetector",
       [&](const cv::Mat1b& i) {
         std::vector<cv::Vec4f> lines;
         fld->detect(i, lines);
         return FoundFrom(lines);
       }},
      {"EdgeDrawing", [&](const cv::Mat1b& i) {
         std::vector<cv::Vec4f> lines;
         drawing->detectEdges(i);
         drawing->detectLines(lines);
         return FoundFrom(lines);
       }}};
  std::vector<Contender> contenders;
  for (const Method& method : methods) {
    contenders.push_back({method.name, [&method](const LineFrame& frame) {
                            (void)method.find(frame.image);
                          }});
  }
  Race(frames, full ? 5 : 2, &contenders);
  std::vector<BenchRow> rows;
  for (std::size_t ours = 0; ours < 2; ++ours) {
    for (std::size_t peer = 2; peer < methods.size(); ++peer) {
      BenchRow time = TimeRow("Y4-grey",
                              "grey image to segments, " + methods[ours].name,
                              contenders[ours],
                              contenders[peer]);
      time.goal = "faster";
      time.holds = *time.ratio > 1.0;
      rows.push_back(time);
    }
  }
  for (const FrameLooks looks : {FrameLooks::kPlain, FrameLooks::kDrawn}) {
    const std::vector<LineFrame> rendered =
        RenderedLineFrames(full ? 40 : 10, looks);
    std::vector<NamedScore> scores;
    for (const Method& method : methods) {
      scores.push_back(
          {method.name,
           ScoreSegments(rendered, FindAll(rendered, method.find))});
    }
    for (BenchRow& row : ScoreRows(
             looks == FrameLooks::kPlain ? "plain worlds" : "drawn worlds",
             scores,
             rendered.size())) {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "lines",
      {{"Y1", "edge images: time, edge pixels, accuracy", waymark::BenchEdges},
       {"Y4", "segments of edge maps (Y2, Y4)", waymark::BenchHough},
       {"Y4-grey", "segments of grey images", waymark::BenchGrey}});
}
