#include "drivers/simulator/geodesic.h"

#include "drivers/simulator/option_range.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace waymark {
namespace {

constexpr float kUnreached = std::numeric_limits<float>::infinity();

double LengthOf(const std::vector<Eigen::Vector2d>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += (points[i] - points[i - 1]).norm();
  }
  return length;
}

// Corners kept, with points between them at most `spacing` apart.
std::vector<Eigen::Vector2d> Densified(
    const std::vector<Eigen::Vector2d>& points, double spacing) {
  std::vector<Eigen::Vector2d> dense{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    const double n = std::ceil(step.norm() / spacing);
    for (double k = 1.0; k <= n; k += 1.0) {
      dense.push_back(points[i - 1] + k / n * step);
    }
  }
  return dense;
}

}  // namespace

Geodesic::Geodesic(const ObstacleMap& map, double radius, double cell)
    : map_(map), radius_(radius), cell_(cell) {
  RequireAbove0("radius", radius);
  RequireAbove0("cell", cell);
  RequireWithin("cell", cell, 0.0, radius);
  const double margin = radius + kMargin;
  low_ = map.low() - Eigen::Vector2d(margin, margin);
  const Eigen::Vector2d size =
      map.high() - map.low() + 2.0 * Eigen::Vector2d(margin, margin);
  num_x_ = static_cast<Cell>(size.x() / cell) + 1;
  num_y_ = static_cast<Cell>(size.y() / cell) + 1;
  // Between two neighbours (at most sqrt(2) cells apart) that are this far from
  // everything, all is `radius` away.
  const double needed = std::hypot(radius, cell / std::sqrt(2.0));
  is_free_.assign(static_cast<std::size_t>(num_x_ * num_y_), 0);
  for (Cell c = 0; c < num_x_ * num_y_; ++c) {
    is_free_[static_cast<std::size_t>(c)] =
        map.Nearest(MiddleOf(c), needed) ? 0 : 1;
  }
}

Eigen::Vector2d Geodesic::MiddleOf(Cell cell) const {
  const Cell x = cell % num_x_;
  const Cell y = cell / num_x_;
  return low_ + cell_ * Eigen::Vector2d(static_cast<double>(x) + 0.5,
                                        static_cast<double>(y) + 0.5);
}

bool Geodesic::IsFree(const Eigen::Vector2d& a,
                      const Eigen::Vector2d& b) const {
  const Eigen::Vector2d way = b - a;
  const Pose2 X_WR{a.x(), a.y(), std::atan2(way.y(), way.x())};
  return !map_.FirstContact(X_WR, {way.norm(), 0.0}, radius_);
}

std::optional<Geodesic::Cell> Geodesic::CellBeside(
    const Eigen::Vector2d& p_W) const {
  if (map_.Nearest(p_W, radius_)) return std::nullopt;
  const auto x = static_cast<Cell>(std::floor((p_W.x() - low_.x()) / cell_));
  const auto y = static_cast<Cell>(std::floor((p_W.y() - low_.y()) / cell_));
  constexpr Cell kReach = 3;  // Cells: farther from a wall than one is free.
  std::optional<Cell> best;
  double best_way = std::numeric_limits<double>::infinity();
  for (Cell j = std::max<Cell>(0, y - kReach);
       j <= std::min(num_y_ - 1, y + kReach);
       ++j) {
    for (Cell i = std::max<Cell>(0, x - kReach);
         i <= std::min(num_x_ - 1, x + kReach);
         ++i) {
      const Cell cell = j * num_x_ + i;
      const double way = (MiddleOf(cell) - p_W).norm();
      if (way >= best_way || !is_free_[static_cast<std::size_t>(cell)] ||
          !IsFree(p_W, MiddleOf(cell))) {
        continue;
      }
      best = cell;
      best_way = way;
    }
  }
  return best;
}

// Upwind solution of |grad d| = 1 from the neighbours that have a distance.
double Geodesic::Solve(const std::vector<float>& distances, Cell cell) const {
  const Cell x = cell % num_x_;
  const Cell y = cell / num_x_;
  const auto at = [&](Cell i, Cell j) {
    if (i < 0 || j < 0 || i >= num_x_ || j >= num_y_) return kUnreached;
    return distances[static_cast<std::size_t>(j * num_x_ + i)];
  };
  const double a = std::min(at(x - 1, y), at(x + 1, y));
  const double b = std::min(at(x, y - 1), at(x, y + 1));
  const double gap = std::abs(a - b);
  if (!(gap < cell_)) return std::min(a, b) + cell_;
  return 0.5 * (a + b + std::sqrt(2.0 * cell_ * cell_ - gap * gap));
}

// Fast marching: cells settle in the order of their distance.
std::vector<float> Geodesic::DistancesTo(Cell goal,
                                         std::optional<Cell> start) const {
  std::vector<float> distances(is_free_.size(), kUnreached);
  std::vector<char> is_settled(is_free_.size(), 0);
  using Entry = std::pair<float, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distances[static_cast<std::size_t>(goal)] = 0.0f;
  queue.emplace(0.0f, goal);
  while (!queue.empty()) {
    const Cell cell = queue.top().second;
    queue.pop();
    if (is_settled[static_cast<std::size_t>(cell)]) continue;
    is_settled[static_cast<std::size_t>(cell)] = 1;
    if (start && cell == *start) break;
    const Cell x = cell % num_x_;
    const Cell y = cell / num_x_;
    const std::pair<bool, Cell> neighbours[] = {
        {x > 0, cell - 1},
        {x < num_x_ - 1, cell + 1},
        {y > 0, cell - num_x_},
        {y < num_y_ - 1, cell + num_x_}};
    for (const auto& [exists, next] : neighbours) {
      const auto i = static_cast<std::size_t>(next);
      if (!exists || !is_free_[i] || is_settled[i]) continue;
      const auto distance = static_cast<float>(Solve(distances, next));
      if (distance >= distances[i]) continue;
      distances[i] = distance;
      queue.emplace(distance, next);
    }
  }
  return distances;
}

// Straightens windows of the path where the straight line is free, from one end
// to the other and again, until that gains nothing.
void Geodesic::Pull(double window, std::vector<Eigen::Vector2d>* points) const {
  constexpr std::size_t kPoints = 6;  // Of a window.
  constexpr double kGain = 1e-5;      // m, of all the path.
  constexpr int kMaxSweeps = 200;
  std::vector<Eigen::Vector2d> p =
      Densified(*points, window / static_cast<double>(kPoints));
  double length = LengthOf(p);
  for (int sweep = 0; sweep < kMaxSweeps && p.size() > 2; ++sweep) {
    for (std::size_t i = 0; i + 2 < p.size(); ++i) {
      const std::size_t j = std::min(i + kPoints, p.size() - 1);
      if (!IsFree(p[i], p[j])) continue;
      for (std::size_t k = i + 1; k < j; ++k) {
        p[k] = p[i] + static_cast<double>(k - i) / static_cast<double>(j - i) *
                          (p[j] - p[i]);
      }
    }
    const double shorter = LengthOf(p);
    if (shorter > length - kGain) break;
    length = shorter;
  }
  // Points that bend nothing go.
  points->assign(1, p.front());
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Eigen::Vector2d a = p[i] - points->back();
    const Eigen::Vector2d b = p[i + 1] - points->back();
    if (std::abs(a.x() * b.y() - a.y() * b.x()) > 1e-9 * b.norm()) {
      points->push_back(p[i]);
    }
  }
  points->push_back(p.back());
}

std::optional<GeodesicPath> Geodesic::Shortest(
    const Eigen::Vector2d& start_W, const Eigen::Vector2d& goal_W) const {
  if (map_.Nearest(start_W, radius_) || map_.Nearest(goal_W, radius_)) {
    return std::nullopt;
  }
  if (IsFree(start_W, goal_W)) {
    return GeodesicPath{(goal_W - start_W).norm(), {start_W, goal_W}};
  }
  // A grid may prefer another way round from the other end.
  std::optional<GeodesicPath> there = Descend(start_W, goal_W);
  std::optional<GeodesicPath> back = Descend(goal_W, start_W);
  if (!there || !back || there->length <= back->length) return there;
  std::reverse(back->points.begin(), back->points.end());
  return back;
}

std::optional<GeodesicPath> Geodesic::Descend(
    const Eigen::Vector2d& start_W, const Eigen::Vector2d& goal_W) const {
  const std::optional<Cell> from = CellBeside(start_W);
  const std::optional<Cell> to = CellBeside(goal_W);
  if (!from || !to) return std::nullopt;
  const std::vector<float> distances = DistancesTo(*to, *from);
  if (distances[static_cast<std::size_t>(*from)] == kUnreached) {
    return std::nullopt;
  }
  GeodesicPath path;
  path.points = {start_W, MiddleOf(*from)};
  for (Cell cell = *from; cell != *to;) {
    Cell best = cell;
    const Cell x = cell % num_x_;
    const Cell y = cell / num_x_;
    for (Cell j = std::max<Cell>(0, y - 1); j <= std::min(num_y_ - 1, y + 1);
         ++j) {
      for (Cell i = std::max<Cell>(0, x - 1); i <= std::min(num_x_ - 1, x + 1);
           ++i) {
        const Cell next = j * num_x_ + i;
        if (distances[static_cast<std::size_t>(next)] <
            distances[static_cast<std::size_t>(best)]) {
          best = next;
        }
      }
    }
    cell = best;
    path.points.push_back(MiddleOf(cell));
  }
  path.points.push_back(goal_W);
  // From windows that reach across rooms to those that follow a corner's arc:
  // pieces of radius / 40 about an arc are far below a percent longer.
  for (double window = 8.0; window > 0.12 * radius_; window *= 0.5) {
    Pull(window, &path.points);
  }
  path.length = LengthOf(path.points);
  return path;
}

std::vector<Eigen::Vector2d> Geodesic::ReachableFrom(
    const Eigen::Vector2d& p_W) const {
  std::vector<Eigen::Vector2d> reachable;
  const std::optional<Cell> from = CellBeside(p_W);
  if (!from) return reachable;
  const std::vector<float> distances = DistancesTo(*from, std::nullopt);
  for (Cell cell = 0; cell < num_x_ * num_y_; ++cell) {
    if (distances[static_cast<std::size_t>(cell)] < kUnreached) {
      reachable.push_back(MiddleOf(cell));
    }
  }
  return reachable;
}

}  // namespace waymark
