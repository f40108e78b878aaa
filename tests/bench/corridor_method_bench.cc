// The published steps to a corridor's pose and ours on the same frames: side by
// side, and the test of faulty answers.
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/geometry/angle.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/corridor_methods.h"
#include "tests/bench/corridor_pose_frames.h"
#include "tests/bench/measure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kFrames = 50;       // A world.
constexpr int kFullFrames = 250;  // 1250 in all.
constexpr int kFaultFrames = 25;  // Each is answered five times.

// ---- side by side ----------------------------------------------------------

// A figure of ours beside the published method's.
class Beside {
 public:
  Beside(std::string world, const PoseScore& ours, const PoseScore& published)
      : world_(std::move(world)), ours_(ours), published_(published) {}

  void Add(const std::string& id,
           const std::string& what,
           const std::string& unit,
           const PoseFigure& figure,
           std::optional<double> in_paper = std::nullopt) {
    const double value = figure(ours_);
    BenchRow row = RowOf(id,
                         world_ + ", " + what,
                         value,
                         unit,
                         static_cast<std::size_t>(ours_.num_frames));
    row.published = in_paper;
    row.peer = "published steps";
    row.peer_value = figure(published_);
    rows_.push_back(std::move(row));
  }
  [[nodiscard]] const std::vector<BenchRow>& rows() const { return rows_; }

 private:
  std::string world_;
  const PoseScore& ours_;
  const PoseScore& published_;
  std::vector<BenchRow> rows_;
};

std::vector<BenchRow> BenchMethods(bool full) {
  std::vector<BenchRow> rows;
  for (const Views& views : RenderViews(full ? kFullFrames : kFrames)) {
    PoseScore ours;
    PoseScore published;
    AddTo({"", {}, {}}, views, &ours);
    AddTo({"", PublishedOptions(), {}}, views, &published);
    Beside beside(views.world, ours, published);
    beside.Add("Y9", "frames accepted", "%", Accepted);
    beside.Add("Y10", "position, median", "cm", PositionAt(0.5), 1.2);
    beside.Add("Y10", "position, p95", "cm", PositionAt(0.95));
    beside.Add("Y10", "position, largest", "cm", PositionAt(1.0), 11.8);
    beside.Add("Y8", "heading, median", "deg", HeadingAt(0.5), 0.3);
    beside.Add("Y8", "heading, p95", "deg", HeadingAt(0.95));
    beside.Add("Y8", "heading, largest", "deg", HeadingAt(1.0));
    beside.Add("Y12", "beyond 4 sigma", "%", BeyondFour);
    beside.Add("Y12", "beyond 6 sigma", "%", [](const PoseScore& score) {
      return score.PercentBeyond(6.0);
    });
    beside.Add(
        "Y12",
        "squared error by stated, median (1.39 if true)",
        "",
        [](const PoseScore& score) { return Quantile(score.nees, 0.5); });
    beside.Add("Y9", "lines and pose, one core", "ms", MedianTime);
    rows.insert(rows.end(), beside.rows().begin(), beside.rows().end());
  }
  return rows;
}

// ---- the test of faulty answers --------------------------------------------

// An answer further from the truth than four of the published errors is faulty,
// others are regular.
constexpr double kFaultyY = 4.0 * 0.03;
constexpr double kFaultyHeading = 4.0 * 0.01;
constexpr std::size_t kOthers = 4;  // Frames whose lines are seen instead.

struct Probabilities {
  std::vector<double> regular;
  std::vector<double> faulty;

  // Percent that a threshold rejects.
  [[nodiscard]] static double Rejected(const std::vector<double>& values,
                                       double threshold) {
    const auto num = std::count_if(values.begin(), values.end(), [&](double p) {
      return !(p > threshold);
    });
    return values.empty() ? 0.0
                          : 100.0 * static_cast<double>(num) /
                                static_cast<double>(values.size());
  }
  // Area under the share of faulty rejected over the share of regular rejected:
  // how often a faulty answer has the lower probability.
  [[nodiscard]] double Area() const {
    double sum = 0.0;
    for (const double f : faulty) {
      for (const double r : regular) sum += f < r ? 1.0 : f == r ? 0.5 : 0.0;
    }
    const auto num = static_cast<double>(faulty.size() * regular.size());
    return num == 0.0 ? 0.0 : sum / num;
  }
};

// Each frame is answered by its own lines, and by those of the next frames of
// its world: a vanishing point and edges that are real, but somewhere else.
Probabilities ProbabilitiesOf(Method method,
                              const std::vector<Views>& all,
                              const PriorErrors& errors) {
  method.options.gate.min_regular = -1.0;  // All are looked at.
  Probabilities result;
  LineExtractor extractor(method.options.lines);
  for (const Views& views : all) {
    Random random(SeedFor(1, views.world));
    std::vector<LineSet> lines;
    for (const CorridorPoseFrame& frame : views.frames) {
      lines.push_back(extractor.Extract(frame.image));
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Pose2& X_LR = views.frames[i].X_LR;
      const CorridorPrior prior = DrawPrior(X_LR, errors, &random);
      for (std::size_t k = 0; k <= kOthers; ++k) {
        const CorridorEstimate found = Answer(method,
                                              views,
                                              views.frames[i].corridor,
                                              lines[(i + k) % lines.size()],
                                              prior);
        if (found.status != CorridorStatus::kAccepted) continue;
        const bool is_faulty =
            std::abs(*found.y - X_LR.y) > kFaultyY ||
            std::abs(WrapAngle(*found.heading - X_LR.heading)) > kFaultyHeading;
        (is_faulty ? result.faulty : result.regular).push_back(found.p_regular);
      }
    }
  }
  return result;
}

std::vector<BenchRow> BenchFaults(bool full) {
  const auto all = RenderViews(full ? kFullFrames : kFaultFrames);
  std::vector<BenchRow> rows;
  const std::vector<std::pair<std::string, PriorErrors>> priors = {
      {"prior 15 cm, 5 deg", {}},
      {"prior 3 cm, 1 deg", {0.03, RadiansFromDegrees(1.0)}}};
  for (const Method& method :
       {Method{"published", PublishedOptions(), {}}, Method{"ours", {}, {}}}) {
    for (const auto& [known, errors] : priors) {
      const Probabilities p = ProbabilitiesOf(method, all, errors);
      const std::string of = method.name + ", " + known + ", ";
      rows.push_back(
          RowOf("Y11", of + "area under ROC", p.Area(), "", p.faulty.size()));
      for (const double threshold : {0.5, 0.8, 0.9, 0.95, 0.97, 0.99}) {
        char at[32];
        std::snprintf(at, sizeof at, "at %.2f", threshold);
        BenchRow row =
            RowOf("Y11",
                  of + "faulty accepted " + at,
                  100.0 - Probabilities::Rejected(p.faulty, threshold),
                  "%",
                  p.faulty.size());
        row.peer = "regular rejected";
        row.peer_value = Probabilities::Rejected(p.regular, threshold);
        rows.push_back(std::move(row));
      }
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
      "corridor_method",
      {{"Y9",
        "the published steps to a pose beside ours, world by world",
        waymark::BenchMethods},
       {"Y11",
        "ROC of the test of faulty answers, which other frames' lines make",
        waymark::BenchFaults}});
}
