// The corridor's pose from rendered frames: how often, how exact, how honest.
#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "estimation/base/random.h"
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/corridor_file.h"
#include "processes/convert/world_file.h"
#include "tests/bench/bench_report.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr int kFrames = 50;        // A world.
constexpr int kFullFrames = 2500;  // 10,000 in all.
constexpr double kPriorY = 0.15;   // m, 1 sigma.
const double kPriorHeading = RadiansFromDegrees(5.0);
const double kMaxHeading = RadiansFromDegrees(25.0);
constexpr double kRobotRadius = 0.25;  // m.

// Of this process: other programs on the machine do not count.
double CpuMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) +
         1e-6 * static_cast<double>(now.tv_nsec);
}

// The smallest value that a share of them does not exceed; 0 of none.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(
      std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

bool IsFree(const World& world,
            const std::vector<Pose2>& people,
            const Pose2& X_WR) {
  for (const WorldFurniture& thing : world.furniture) {
    const double reach = 0.5 * std::hypot(thing.size.x(), thing.size.y());
    if ((thing.at - X_WR.position()).norm() < reach + kRobotRadius) {
      return false;
    }
  }
  return std::all_of(people.begin(), people.end(), [&](const Pose2& person) {
    return (person.position() - X_WR.position()).norm() >
           kPersonRadius + kRobotRadius;
  });
}

// What came of the frames of one world.
struct Outcome {
  int num_frames = 0;
  std::vector<double> y_errors;        // Of accepted frames, m.
  std::vector<double> heading_errors;  // rad.
  std::vector<double> worst_sigmas;    // Larger of both.
  std::vector<double> times_ms;        // Lines and pose.
  [[nodiscard]] double Share(double num) const { return num / num_frames; }
};

Outcome Run(const std::string& name, int num_frames, std::uint64_t seed) {
  const World world = LoadWorldFile(FindWorldFile(name));
  const CorridorGeometry corridor =
      LoadCorridorFile(FindCorridorFile(name)).front();
  const CameraDescription camera =
      LoadCameraFile(FindCameraFile("perspective"));
  const Renderer renderer(BuildScene(world));
  const People people(world, {});
  const CameraView view{camera.model, camera.size};
  const CameraRays rays(view);
  CorridorTracker tracker(view, {});
  Random random(SeedFor(seed, name));
  Outcome outcome;
  while (outcome.num_frames < num_frames) {
    Pose2 X_LR;
    // As far from ends and walls as a robot stands.
    X_LR.x = random.Uniform(corridor.x_min + 0.4, corridor.x_max - 0.4);
    const double side = 0.5 * corridor.width.value() - kRobotRadius - 0.05;
    X_LR.y = random.Uniform(-side, side);
    const double turn = random.Uniform() < 0.5 ? 0.0 : kPi;
    X_LR.heading = WrapAngle(turn + random.Uniform(-kMaxHeading, kMaxHeading));
    const Pose2 X_WR = corridor.X_WL * X_LR;
    const auto X_WP2 = people.PosesAt(random.Uniform(0.0, 60.0), X_WR);
    if (!IsFree(world, X_WP2, X_WR)) continue;
    ++outcome.num_frames;
    std::vector<Eigen::Isometry3d> X_WP;
    for (const Pose2& pose : X_WP2) X_WP.push_back(SpatialPose(pose));
    const cv::Mat3b image =
        renderer.Render(rays, SpatialPose(X_WR) * camera.X_RC, X_WP).image;
    cv::Mat1b grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    CorridorPrior prior;
    prior.X_LR = X_LR;
    prior.X_LR.y += random.Normal(kPriorY);
    prior.X_LR.heading = WrapAngle(X_LR.heading + random.Normal(kPriorHeading));
    prior.covariance.diagonal() << kPriorY * kPriorY, kPriorY * kPriorY,
        kPriorHeading * kPriorHeading;
    const double begin = CpuMilliseconds();
    const CorridorEstimate found =
        tracker.Estimate(grey, camera.X_RC, corridor, prior);
    outcome.times_ms.push_back(CpuMilliseconds() - begin);
    if (found.status != CorridorStatus::kAccepted) continue;
    const double y = std::abs(found.y.value() - X_LR.y);
    const double heading =
        std::abs(WrapAngle(found.heading.value() - X_LR.heading));
    outcome.y_errors.push_back(y);
    outcome.heading_errors.push_back(heading);
    outcome.worst_sigmas.push_back(
        std::max(y / std::sqrt(found.covariance(0, 0)),
                 heading / std::sqrt(found.covariance(1, 1))));
  }
  return outcome;
}

BenchRow Row(const std::string& id,
             const std::string& world,
             const std::string& what,
             double value,
             const std::string& unit,
             const std::string& goal,
             std::optional<bool> holds,
             std::size_t runs) {
  BenchRow row;
  row.id = id;
  row.name = world + ", " + what;
  row.value = value;
  row.unit = unit;
  row.goal = goal;
  row.holds = holds;
  row.runs = static_cast<std::int64_t>(runs);
  return row;
}

std::vector<BenchRow> RowsOf(const std::string& world,
                             const Outcome& outcome,
                             double least_accepted) {
  const std::size_t num = outcome.y_errors.size();
  const auto frames = static_cast<std::size_t>(outcome.num_frames);
  const auto beyond = [&](double sigmas) {
    const auto count = std::count_if(outcome.worst_sigmas.begin(),
                                     outcome.worst_sigmas.end(),
                                     [&](double s) { return s > sigmas; });
    return num == 0
               ? 0.0
               : 100.0 * static_cast<double>(count) / static_cast<double>(num);
  };
  const double accepted = 100.0 * outcome.Share(static_cast<double>(num));
  const double y50 = 100.0 * Quantile(outcome.y_errors, 0.5);
  const double y99 = 100.0 * Quantile(outcome.y_errors, 0.99);
  const double h50 = DegreesFromRadians(Quantile(outcome.heading_errors, 0.5));
  const double h99 = DegreesFromRadians(Quantile(outcome.heading_errors, 0.99));
  const double ms = Quantile(outcome.times_ms, 0.5);
  std::vector<BenchRow> rows;
  const auto add = [&](const std::string& id,
                       const std::string& what,
                       double value,
                       const std::string& unit,
                       const std::string& goal,
                       std::optional<bool> holds,
                       std::size_t runs) {
    rows.push_back(Row(id, world, what, value, unit, goal, holds, runs));
  };
  add("Y18",
      "frames accepted (prior 15 cm, 5 deg)",
      accepted,
      "%",
      ">= " + std::to_string(static_cast<int>(least_accepted)),
      accepted >= least_accepted,
      frames);
  add("Y18", "position, median", y50, "cm", "<= 1", y50 <= 1.0, num);
  rows.back().published = 1.2;
  const double y95 = 100.0 * Quantile(outcome.y_errors, 0.95);
  add("Y18", "position, p95", y95, "cm", "", std::nullopt, num);
  add("Y18", "position, p99", y99, "cm", "<= 3", y99 <= 3.0, num);
  const double most = 100.0 * Quantile(outcome.y_errors, 1.0);
  add("Y18", "position, largest", most, "cm", "", std::nullopt, num);
  rows.back().published = 11.8;
  add("Y8", "heading, median", h50, "deg", "<= 0.1", h50 <= 0.1, num);
  rows.back().published = 0.3;
  add("Y8", "heading, p99", h99, "deg", "<= 0.5", h99 <= 0.5, num);
  add("Y12",
      "beyond 4 sigma",
      beyond(4.0),
      "%",
      "<= 0.1",
      beyond(4.0) <= 0.1,
      num);
  add("Y12", "beyond 6 sigma", beyond(6.0), "%", "0", beyond(6.0) == 0.0, num);
  add("Y18", "lines and pose, one core", ms, "ms", "", std::nullopt, frames);
  return rows;
}

std::vector<BenchRow> BenchPose(bool full) {
  cv::setNumThreads(1);
  const std::vector<std::pair<std::string, double>> worlds = {
      {"corridor_plain", 90.0},
      {"corridor_textured", 75.0},
      {"corridor_office", 75.0},
      {"corridor_mouth", 75.0}};
  std::vector<BenchRow> rows;
  for (const auto& [world, least_accepted] : worlds) {
    // Seed 1 is what is reported; others are for whoever tunes.
    const Outcome outcome = Run(world, full ? kFullFrames : kFrames, 1);
    for (BenchRow& row : RowsOf(world, outcome, least_accepted)) {
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
      "corridor",
      {{"Y18",
        "pose in a corridor from rendered frames (f 457 px, 640x480)",
        waymark::BenchPose}});
}
