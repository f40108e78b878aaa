// Every step of the published method to a corridor's pose, and of ours,
// replaced or left out.
#include "estimation/corridor/corridor_tracker.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/corridor_methods.h"
#include "tests/bench/measure.h"

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kFrames = 20;  // A world; four minutes on one core.
constexpr int kFullFrames = 100;

// The median of all candidates, where both walls have some.
void TakeMedian(const Given& given, CorridorEstimate* found) {
  std::vector<double> candidates;
  bool has_left = false;
  bool has_right = false;
  for (const SeenLine& line : given.lines) {
    const CorridorEdge edge =
        ClassifyLine(given.view, line, *found->heading, {});
    const auto y = LateralCandidate(
        given.view, line, edge, given.corridor, *found->heading);
    if (!y) continue;
    candidates.push_back(*y);
    (edge == CorridorEdge::kFloorLeft || edge == CorridorEdge::kCeilingLeft
         ? has_left
         : has_right) = true;
  }
  found->y.reset();
  if (has_left && has_right) {
    found->y = Quantile(std::move(candidates), 0.5);
    found->covariance(0, 0) = 0.03 * 0.03;
  }
}

void TakeConstantErrors(const Given& /*given*/, CorridorEstimate* found) {
  const PaperPoseOptions paper;
  found->covariance.setZero();
  if (found->y) found->covariance(0, 0) = paper.sigma_m * paper.sigma_m;
  found->covariance(1, 1) = paper.sigma_rad * paper.sigma_rad;
}

void TakePose(const JointPose& pose, CorridorEstimate* found) {
  found->y = pose.y;
  found->heading = pose.heading;
  found->covariance = pose.covariance;
}

AxisPrior HeadingOf(const CorridorPrior& prior) {
  return {prior.X_LR.heading, std::sqrt(prior.covariance(2, 2))};
}

// Our heading before the published position.
void TakeOurHeading(const Given& given, CorridorEstimate* found) {
  found->y.reset();
  const auto heading =
      EstimateAxisHeading(given.view, given.lines, HeadingOf(given.prior), {});
  if (!heading) return;
  TakePose(
      EstimatePaperPose(given.view, given.corridor, given.lines, *heading, {}),
      found);
}

// Our position without what was believed of it.
void ForgetPosition(const Given& given, CorridorEstimate* found) {
  found->y.reset();
  const auto heading =
      EstimateAxisHeading(given.view, given.lines, HeadingOf(given.prior), {});
  if (!heading) return;
  TakePose(
      EstimateJointPose(
          given.view, given.corridor, given.lines, *heading, std::nullopt, {}),
      found);
}

Method Varied(const std::string& name,
              CorridorTrackerOptions base,
              const std::function<void(CorridorTrackerOptions*)>& change) {
  if (change) change(&base);
  return {name, base, {}};
}

using Options = CorridorTrackerOptions;

void SuppressAsCanny(Options* o) {
  o->lines.edges.suppression = EdgeSuppression::kFourDirections;
}
void LeaveApart(Options* o) {
  o->lines.merger.max_gap_px = 1e-3;
}
void TestNothing(Options* o) {
  o->gate.min_regular = -1.0;
}
void LookByTables(Options* o) {
  o->lines.scheme = LineScheme::kSegmentedHough;
  o->lines.hough.form = HoughForm::kLiteral;
}

std::vector<Method> PublishedVariants() {
  std::vector<Method> methods;
  const auto vary = [&](const std::string& name,
                        const std::function<void(Options*)>& change) {
    methods.push_back(Varied("published: " + name, PublishedOptions(), change));
  };
  const auto amend = [&](const std::string& name, auto how) {
    methods.push_back({"published: " + name, PublishedOptions(), how});
  };
  vary("all steps", {});
  vary("suppression of Canny", SuppressAsCanny);
  vary("Hough of words",
       [](Options* o) { o->lines.hough.form = HoughForm::kWords; });
  vary("edge chains, no Hough",
       [](Options* o) { o->lines.scheme = LineScheme::kEdgeChains; });
  vary("no merging", LeaveApart);
  vary("no gate by the prior",
       [](Options* o) { o->paper.vanishing.gate_sigmas = 100.0; });
  for (const int num : {10, 100}) {
    vary(std::to_string(num) + " intersections kept",
         [num](Options* o) { o->paper.vanishing.num_kept = num; });
  }
  // Far more than there are.
  vary("mean of intersections",
       [](Options* o) { o->paper.vanishing.num_kept = 1000000; });
  vary("mean of candidates",
       [](Options* o) { o->paper.lateral.num_kept = 1000000; });
  amend("median of candidates", TakeMedian);
  for (const int num : {2, 3, 6, 8}) {
    vary(std::to_string(num) + " candidates kept",
         [num](Options* o) { o->paper.lateral.num_kept = num; });
  }
  vary("one wall is enough",
       [](Options* o) { o->paper.lateral.needs_both_walls = false; });
  vary("no test of faults", TestNothing);
  amend("our heading", TakeOurHeading);
  vary("our position and heading",
       [](Options* o) { o->method = CorridorMethod::kJoint; });
  return methods;
}

std::vector<Method> OurVariants() {
  std::vector<Method> methods;
  const auto vary = [&](const std::string& name,
                        const std::function<void(Options*)>& change) {
    methods.push_back(Varied("ours: " + name, {}, change));
  };
  vary("all steps", {});
  vary("suppression of Canny", SuppressAsCanny);
  vary("Hough by tables", LookByTables);
  vary("no merging", LeaveApart);
  methods.push_back({"ours: constant errors", {}, TakeConstantErrors});
  methods.push_back({"ours: no prior of the position", {}, ForgetPosition});
  vary("no test of faults", TestNothing);
  vary("published position and heading",
       [](Options* o) { o->method = CorridorMethod::kPaper; });
  return methods;
}

std::vector<BenchRow> AblationOf(const std::vector<Method>& methods,
                                 const std::vector<Views>& all) {
  std::vector<BenchRow> rows;
  std::optional<PoseScore> base;  // Of the first.
  for (const Method& method : methods) {
    PoseScore score;
    for (const Views& views : all) AddTo(method, views, &score);
    const auto add = [&](const std::string& what,
                         const std::string& unit,
                         const PoseFigure& of) {
      BenchRow row = RowOf("Y10",
                           method.name + ", " + what,
                           of(score),
                           unit,
                           static_cast<std::size_t>(score.num_frames));
      if (base) {
        row.peer = methods.front().name;
        row.peer_value = of(*base);
      }
      rows.push_back(std::move(row));
    };
    add("accepted", "%", Accepted);
    add("position, median", "cm", PositionAt(0.5));
    add("position, p95", "cm", PositionAt(0.95));
    add("heading, median", "deg", HeadingAt(0.5));
    add("beyond 4 sigma", "%", BeyondFour);
    add("squared error by stated, median", "", [](const PoseScore& of) {
      return Quantile(of.nees, 0.5);
    });
    add("lines and pose", "ms", MedianTime);
    if (!base) base = score;
  }
  return rows;
}

std::vector<BenchRow> BenchAblation(bool full) {
  const std::vector<Views> all = RenderViews(full ? kFullFrames : kFrames);
  std::vector<BenchRow> rows = AblationOf(PublishedVariants(), all);
  for (BenchRow& row : AblationOf(OurVariants(), all)) {
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "corridor_ablation",
      {{"Y10-ablation",
        "each step of both methods replaced or left out, all worlds together",
        waymark::BenchAblation}});
}
