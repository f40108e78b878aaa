// The corridor's pose from rendered frames: how often, how exact, how honest.
#include "estimation/base/random.h"
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/geometry/angle.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/corridor_pose_frames.h"
#include "tests/bench/corridor_worst.h"
#include "tests/bench/measure.h"

#include <opencv2/core.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kFrames = 50;        // A world.
constexpr int kFullFrames = 2000;  // 10,000 in all.
constexpr std::size_t kWorst = 5;
// Of frames that nothing was tuned on; whoever tunes takes others.
constexpr std::uint64_t kSeed = 6;
constexpr double kHardlyKnownX = 5.0;  // m.
constexpr int kTurningShare = 4;  // So many times fewer frames of robots that
                                  // may look any way, as on the spot.

std::string WorstPage(bool full) {
  // A short run leaves the page of a long one.
  return full ? "out/bench/corridor_worst.html"
              : "out/bench/corridor_worst_of_few.html";
}

// Our answers, and the time of EdgeDrawing's lines of the same frames.
struct Run {
  PoseScore score;
  PoseScore lost;  // Where along the corridor it is, it hardly knows.
  PoseScore turning;
  std::vector<double> edge_drawing_ms;
};

Run RunWorld(const std::string& world,
             int num_frames,
             std::uint64_t seed,
             WorstFrames* worst) {
  CorridorPoseFrames frames(world, seed);
  const CameraDescription& camera = frames.camera();
  CorridorTracker tracker({camera.model, camera.size}, {});
  const auto drawing = cv::ximgproc::createEdgeDrawing();
  std::vector<cv::Vec4f> lines;
  Random random(SeedFor(seed, world + " lost"));
  Run run;
  for (int i = 0; i < num_frames; ++i) {
    const CorridorPoseFrame frame = frames.Next();
    const double begin = CpuSeconds();
    const LineSet seen = tracker.FindLines(frame.image);
    const CorridorEstimate found =
        tracker.EstimateFrom(seen, camera.X_RC, frame.corridor, frame.prior);
    const double end = CpuSeconds();
    run.score.Add(found, frame.X_LR, 1e3 * (end - begin));
    CorridorPrior lost = frame.prior;
    lost.X_LR.x = std::clamp(frame.X_LR.x + random.Normal(kHardlyKnownX),
                             frame.corridor.x_min,
                             frame.corridor.x_max);
    lost.covariance(0, 0) = kHardlyKnownX * kHardlyKnownX;
    run.lost.Add(tracker.EstimateFrom(seen, camera.X_RC, frame.corridor, lost),
                 frame.X_LR,
                 0.0);
    const double begin_drawing = CpuSeconds();
    drawing->detectEdges(frame.image);
    drawing->detectLines(lines);
    run.edge_drawing_ms.push_back(1e3 * (CpuSeconds() - begin_drawing));
    worst->Add(world + ", frame " + std::to_string(i),
               frame,
               found,
               frame.corridor,
               camera);
  }
  CorridorPoseFrames any(world, seed + 1000, 0.5 * kPi);
  for (int i = 0; i < num_frames / kTurningShare; ++i) {
    const CorridorPoseFrame frame = any.Next();
    run.turning.Add(
        tracker.Estimate(frame.image, camera.X_RC, frame.corridor, frame.prior),
        frame.X_LR,
        0.0);
  }
  return run;
}

std::vector<BenchRow> RowsOf(const std::string& world,
                             const Run& run,
                             double least_accepted) {
  const PoseScore& score = run.score;
  const std::size_t num = score.y_errors.size();
  const auto frames = static_cast<std::size_t>(score.num_frames);
  const double accepted = score.AcceptedPercent();
  const auto y = [&](double share) {
    return 100.0 * Quantile(score.y_errors, share);
  };
  const auto heading = [&](double share) {
    return DegreesFromRadians(Quantile(score.heading_errors, share));
  };
  std::vector<BenchRow> rows;
  const auto add = [&](const std::string& id,
                       const std::string& what,
                       double value,
                       const std::string& unit,
                       const std::string& goal,
                       std::optional<bool> holds,
                       std::size_t runs) {
    rows.push_back(RowOf(id, world + ", " + what, value, unit, runs));
    rows.back().goal = goal;
    rows.back().holds = holds;
  };
  add("Y18",
      "frames accepted (prior 15 cm, 5 deg)",
      accepted,
      "%",
      ">= " + std::to_string(static_cast<int>(least_accepted)),
      accepted >= least_accepted,
      frames);
  add("Y18", "position, median", y(0.5), "cm", "<= 1", y(0.5) <= 1.0, num);
  rows.back().published = 1.2;
  add("Y18", "position, p95", y(0.95), "cm", "", std::nullopt, num);
  add("Y18", "position, p99", y(0.99), "cm", "<= 3", y(0.99) <= 3.0, num);
  add("Y18", "position, largest", y(1.0), "cm", "", std::nullopt, num);
  rows.back().published = 11.8;
  add("Y8",
      "heading, median",
      heading(0.5),
      "deg",
      "<= 0.1",
      heading(0.5) <= 0.1,
      num);
  rows.back().published = 0.3;
  add("Y8",
      "heading, p99",
      heading(0.99),
      "deg",
      "<= 0.5",
      heading(0.99) <= 0.5,
      num);
  const double beyond4 = score.PercentBeyond(4.0);
  add("Y12", "beyond 4 sigma", beyond4, "%", "<= 0.1", beyond4 <= 0.1, num);
  const double beyond6 = score.PercentBeyond(6.0);
  add("Y12", "beyond 6 sigma", beyond6, "%", "0", beyond6 == 0.0, num);
  // Of 1 sigma 2.6 would be 99 %: what is stated allows for walls that are not
  // as straight as rendered ones, and cameras not as well mounted.
  add("Y12",
      "error in stated sigmas, p99",
      Quantile(score.worst_sigmas, 0.99),
      "",
      "",
      std::nullopt,
      num);
  add("Y18",
      "accepted, x known to 5 m",
      run.lost.AcceptedPercent(),
      "%",
      "",
      std::nullopt,
      frames);
  const double lost6 = run.lost.PercentBeyond(6.0);
  add("Y12",
      "beyond 6 sigma, x known to 5 m",
      lost6,
      "%",
      "0",
      lost6 == 0.0,
      run.lost.y_errors.size());
  add("Y18",
      "accepted, any heading",
      run.turning.AcceptedPercent(),
      "%",
      "",
      std::nullopt,
      static_cast<std::size_t>(run.turning.num_frames));
  const double turning6 = run.turning.PercentBeyond(6.0);
  add("Y12",
      "beyond 6 sigma, any heading",
      turning6,
      "%",
      "0",
      turning6 == 0.0,
      run.turning.y_errors.size());
  const double ms = Quantile(score.times_ms, 0.5);
  add("Y18", "lines and pose, one core", ms, "ms", "<= 5", ms <= 5.0, frames);
  rows.back().peer = "EdgeDrawing alone";
  rows.back().peer_value = Quantile(run.edge_drawing_ms, 0.5);
  rows.back().ratio = *rows.back().peer_value / ms;
  add("Y18",
      "the same in times of EdgeDrawing",
      ms / *rows[rows.size() - 1].peer_value,
      "",
      "<= 2",
      ms <= 2.0 * *rows[rows.size() - 1].peer_value,
      frames);
  return rows;
}

std::vector<BenchRow> BenchPose(bool full) {
  cv::setNumThreads(1);
  std::vector<BenchRow> rows;
  WorstFrames worst(kWorst);
  for (const auto& [world, least_accepted] : kCorridorWorlds) {
    const Run run =
        RunWorld(world, full ? kFullFrames : kFrames, kSeed, &worst);
    for (BenchRow& row : RowsOf(world, run, least_accepted)) {
      rows.push_back(std::move(row));
    }
  }
  worst.Write(WorstPage(full));
  std::fprintf(stderr, "the worst frames: %s\n", WorstPage(full).c_str());
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(
      argc,
      argv,
      "corridor",
      {{"Y18",
        "pose in a corridor from rendered frames (f 457 px, 640x480)",
        waymark::BenchPose}});
}
