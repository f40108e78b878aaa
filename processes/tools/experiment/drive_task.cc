#include "processes/tools/experiment/drive_task.h"

#include "drivers/simulator/world_layout.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace waymark {
namespace {

// Appends what follows points[first] up to points[last].
void AppendSimplified(const std::vector<Eigen::Vector2d>& points,
                      std::size_t first,
                      std::size_t last,
                      double tolerance,
                      std::vector<Eigen::Vector2d>* out) {
  double farthest = tolerance;
  std::size_t middle = last;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double distance =
        DistanceToSegment(points[first], points[last], points[i]);
    if (distance <= farthest) continue;
    farthest = distance;
    middle = i;
  }
  if (middle != last) {
    AppendSimplified(points, first, middle, tolerance, out);
    AppendSimplified(points, middle, last, tolerance, out);
  } else {
    out->push_back(points[last]);
  }
}

}  // namespace

std::vector<Eigen::Vector2d> Simplified(
    const std::vector<Eigen::Vector2d>& points, double tolerance) {
  std::vector<Eigen::Vector2d> simple{points.front()};
  if (points.size() > 1) {
    AppendSimplified(points, 0, points.size() - 1, tolerance, &simple);
  }
  return simple;
}

DriveTaskMaker::DriveTaskMaker(const ObstacleMap& map,
                               const DriveTaskOptions& options,
                               const Eigen::Vector2d& p_W)
    : options_(options),
      shortest_(map, options.radius),
      clear_(map, options.radius + options.clearance),
      places_(clear_.ReachableFrom(p_W)) {
  if (places_.empty()) {
    throw std::invalid_argument(
        "nothing can be reached from the start with this clearance");
  }
}

DriveTask DriveTaskMaker::Make(std::uint64_t seed) const {
  Random random(SeedFor(seed, "drive_task"));
  // From a corner of a small room there may be no way of that length.
  constexpr int kMaxStarts = 20;
  for (int i = 0; i < kMaxStarts; ++i) {
    if (auto task = MakeOne(&random)) return *std::move(task);
  }
  throw std::invalid_argument(
      "found no goals between task.min_way_m and task.max_way_m");
}

std::optional<DriveTask> DriveTaskMaker::MakeOne(Random* random) const {
  const auto pick = [&] { return places_[random->Index(places_.size())]; };
  DriveTask task;
  Eigen::Vector2d from = pick();
  for (const Eigen::Vector2d& person : options_.people) {
    if ((person - from).norm() < options_.radius + options_.people_gap) {
      return std::nullopt;
    }
  }
  task.X_WR = {from.x(), from.y(), random->Uniform(-kPi, kPi)};
  constexpr int kMaxDraws = 100;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const Eigen::Vector2d goal = pick();
    if ((goal - from).norm() > options_.max_way) continue;
    const auto way = clear_.Shortest(from, goal);
    // The shortest is no longer.
    if (!way || way->length < options_.min_way) continue;
    const auto shortest = shortest_.Shortest(from, goal);
    if (!shortest || shortest->length < options_.min_way ||
        shortest->length > options_.max_way) {
      continue;
    }
    // Far below the clearance, above what the robot can follow.
    constexpr double kTolerance = 0.03;
    const auto corners = Simplified(way->points, kTolerance);
    task.waypoints.insert(
        task.waypoints.end(), corners.begin() + 1, corners.end());
    task.goals.push_back(goal);
    task.shortest_m += shortest->length;
    from = goal;
    if (static_cast<int>(task.goals.size()) == options_.num_goals) return task;
  }
  return std::nullopt;
}

}  // namespace waymark
