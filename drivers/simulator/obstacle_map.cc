#include "drivers/simulator/obstacle_map.h"

#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace waymark {
namespace {

constexpr double kCell = 0.25;  // m; about what a robot moves in a second.
// That is 500 m square; beyond it cells grow.
constexpr double kMaxCells = 4e6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d NearestOn(const Segment2& s, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = s.b - s.a;
  const double length2 = along.squaredNorm();
  if (length2 == 0.0) return s.a;
  const double t = along.dot(p - s.a) / length2;
  return s.a + std::clamp(t, 0.0, 1.0) * along;
}

// Between which x a segment is at heights y from `low` to `high`, where some of
// it is.
std::pair<double, double> StretchIn(const Segment2& s,
                                    double low,
                                    double high) {
  const Eigen::Vector2d along = s.b - s.a;
  double from = 0.0;
  double to = 1.0;
  if (along.y() != 0.0) {
    const double ta = std::clamp((low - s.a.y()) / along.y(), 0.0, 1.0);
    const double tb = std::clamp((high - s.a.y()) / along.y(), 0.0, 1.0);
    std::tie(from, to) = std::minmax(ta, tb);
  }
  const double xa = s.a.x() + from * along.x();
  const double xb = s.a.x() + to * along.x();
  return {std::min(xa, xb), std::max(xa, xb)};
}

// Smallest t >= 0 with |o + t d| = radius, entering; infinite without. Starts
// outside, but for rounding: then it enters at once.
double EnterCircle(const Eigen::Vector2d& o,
                   const Eigen::Vector2d& d,
                   double radius) {
  const double a = d.squaredNorm();
  const double half_b = o.dot(d);
  if (a == 0.0 || half_b >= 0.0) return kInfinity;
  const double discriminant =
      half_b * half_b - a * (o.squaredNorm() - radius * radius);
  if (discriminant < 0.0) return kInfinity;
  // The smaller root, without cancellation.
  return std::max(0.0,
                  (o.squaredNorm() - radius * radius) /
                      (-half_b + std::sqrt(discriminant)));
}

// When a point at o that moves by d first is `radius` from a segment.
double TimeOfImpact(const Eigen::Vector2d& o,
                    const Eigen::Vector2d& d,
                    const Segment2& s,
                    double radius) {
  const Eigen::Vector2d from_nearest = o - NearestOn(s, o);
  if (from_nearest.norm() <= radius) {
    // The distance to a convex set is convex along the way: where it does not
    // shrink now, it never will.
    return from_nearest.dot(d) < 0.0 ? 0.0 : kInfinity;
  }
  double first = std::min(EnterCircle(o - s.a, d, radius),
                          EnterCircle(o - s.b, d, radius));
  const double length = (s.b - s.a).norm();
  if (length == 0.0) return first;
  const Eigen::Vector2d along = (s.b - s.a) / length;
  const double height = Cross(along, o - s.a);
  const double climb = Cross(along, d);
  if (height * climb < 0.0) {
    const double t = std::max(0.0, std::abs(height) - radius) / std::abs(climb);
    const double foot = along.dot(o + t * d - s.a);
    if (foot >= 0.0 && foot <= length) first = std::min(first, t);
  }
  return first;
}

// Distance along a ray of unit direction; infinite without a hit.
double RayToSegment(const Eigen::Vector2d& o,
                    const Eigen::Vector2d& direction,
                    const Segment2& s) {
  const Eigen::Vector2d along = s.b - s.a;
  const double slope = Cross(direction, along);
  if (slope == 0.0) return kInfinity;
  const double t = Cross(s.a - o, along) / slope;
  const double share = Cross(s.a - o, direction) / slope;
  return t >= 0.0 && share >= 0.0 && share <= 1.0 ? t : kInfinity;
}

double AngleToNormal(const Eigen::Vector2d& direction,
                     const Eigen::Vector2d& normal) {
  const double c = std::abs(direction.dot(normal)) / normal.norm();
  return std::acos(std::min(1.0, c));
}

}  // namespace

Pose2 PoseAlong(const ArcMotion& motion, double share) {
  const double turn = share * motion.turn;
  const double half = 0.5 * turn;
  // sin(h) / h; the series is exact to double precision there.
  const double chord =
      std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
  const double length = share * motion.distance * chord;
  return {length * std::cos(half), length * std::sin(half), WrapAngle(turn)};
}

ObstacleMap::ObstacleMap(std::vector<Segment2> segments)
    : segments_(std::move(segments)) {
  if (!segments_.empty()) low_ = high_ = segments_.front().a;
  for (const Segment2& s : segments_) {
    WAYMARK_CHECK(s.a.allFinite() && s.b.allFinite(), s.a, s.b);
    low_ = low_.cwiseMin(s.a).cwiseMin(s.b);
    high_ = high_.cwiseMax(s.a).cwiseMax(s.b);
  }
  const Eigen::Vector2d size = high_ - low_;
  cell_ = std::max({kCell,
                    std::sqrt(size.x() / kMaxCells) * std::sqrt(size.y()),
                    size.maxCoeff() / kMaxCells});
  num_x_ = static_cast<int>(size.x() / cell_) + 1;
  num_y_ = static_cast<int>(size.y() / cell_) + 1;

  // A segment counts for every cell whose circle it crosses: a few too many.
  const double reach = cell_ * std::sqrt(0.5) * (1.0 + 1e-9);
  std::vector<std::vector<std::uint32_t>> cells(
      static_cast<std::size_t>(num_x_) * static_cast<std::size_t>(num_y_));
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment2& s = segments_[i];
    const Box box = BoxOf(s.a.cwiseMin(s.b), s.a.cwiseMax(s.b));
    for (int y = box.y0; y <= box.y1; ++y) {
      // Of the row only where the segment is, or a long one that slants would
      // cost the square of its length.
      const auto [from, to] = StretchIn(s,
                                        low_.y() + cell_ * (y + 0.5) - reach,
                                        low_.y() + cell_ * (y + 0.5) + reach);
      const int first = std::max(box.x0, CellX(from - reach));
      const int last = std::min(box.x1, CellX(to + reach));
      for (int x = first; x <= last; ++x) {
        const Eigen::Vector2d middle =
            low_ + cell_ * Eigen::Vector2d(x + 0.5, y + 0.5);
        if ((middle - NearestOn(s, middle)).norm() > reach) continue;
        cells[IndexOf(x, y)].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  cell_starts_.push_back(0);
  for (const auto& cell : cells) {
    cell_segments_.insert(cell_segments_.end(), cell.begin(), cell.end());
    cell_starts_.push_back(static_cast<std::uint32_t>(cell_segments_.size()));
  }
}

int ObstacleMap::CellX(double x) const {
  return static_cast<int>(
      std::clamp(std::floor((x - low_.x()) / cell_), 0.0, num_x_ - 1.0));
}

int ObstacleMap::CellY(double y) const {
  return static_cast<int>(
      std::clamp(std::floor((y - low_.y()) / cell_), 0.0, num_y_ - 1.0));
}

ObstacleMap::Box ObstacleMap::BoxOf(const Eigen::Vector2d& low,
                                    const Eigen::Vector2d& high) const {
  return {CellX(low.x()), CellY(low.y()), CellX(high.x()), CellY(high.y())};
}

std::size_t ObstacleMap::IndexOf(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(num_x_) +
         static_cast<std::size_t>(x);
}

std::span<const std::uint32_t> ObstacleMap::InCell(int x, int y) const {
  const std::size_t cell = IndexOf(x, y);
  return std::span(cell_segments_)
      .subspan(cell_starts_[cell], cell_starts_[cell + 1] - cell_starts_[cell]);
}

std::optional<NearestObstacle> ObstacleMap::Nearest(
    const Eigen::Vector2d& p_W,
    double max_distance,
    std::span<const Disc2> discs) const {
  NearestObstacle nearest{max_distance, p_W};
  bool found = false;
  const auto offer = [&](double distance, const Eigen::Vector2d& p) {
    if (distance > nearest.distance) return;
    nearest = {distance, p};
    found = true;
  };
  for (const Disc2& disc : discs) {
    const Eigen::Vector2d to_middle = disc.p_W - p_W;
    const double gap = to_middle.norm() - disc.radius;
    if (gap <= 0.0) {
      offer(0.0, p_W);
    } else {
      offer(gap, p_W + to_middle * (gap / (gap + disc.radius)));
    }
  }
  // Boxes that grow: a segment outside of the last one is farther than it.
  double reach = std::min(cell_, max_distance);
  for (;;) {
    const Eigen::Vector2d half(reach, reach);
    const Box box = BoxOf(p_W - half, p_W + half);
    for (int y = box.y0; y <= box.y1; ++y) {
      for (int x = box.x0; x <= box.x1; ++x) {
        for (const std::uint32_t i : InCell(x, y)) {
          const Eigen::Vector2d p = NearestOn(segments_[i], p_W);
          offer((p - p_W).norm(), p);
        }
      }
    }
    if (nearest.distance <= reach) break;
    const bool is_all = box.x0 == 0 && box.y0 == 0 && box.x1 == num_x_ - 1 &&
                        box.y1 == num_y_ - 1;
    if (is_all) break;
    reach = std::min(2.0 * reach, nearest.distance);
  }
  if (!found) return std::nullopt;
  return nearest;
}

std::optional<RayHit> ObstacleMap::CastRay(const Eigen::Vector2d& p_W,
                                           double bearing,
                                           double max_distance,
                                           std::span<const Disc2> discs) const {
  const Eigen::Vector2d direction(std::cos(bearing), std::sin(bearing));
  RayHit hit{max_distance, 0.0, kInfinity};
  bool found = false;
  for (const Disc2& disc : discs) {
    const Eigen::Vector2d o = p_W - disc.p_W;
    const bool is_inside = o.norm() <= disc.radius;
    const double t = is_inside ? 0.0 : EnterCircle(o, direction, disc.radius);
    if (t > hit.distance) continue;
    const Eigen::Vector2d normal = o + t * direction;
    hit = {t, is_inside ? 0.0 : AngleToNormal(direction, normal), kInfinity};
    found = true;
  }
  // The stretch of the ray that lies in the grid.
  double t = 0.0;
  double t_out = hit.distance;
  for (int axis = 0; axis < 2; ++axis) {
    const double to_low = low_(axis) - p_W(axis);
    const double to_high = high_(axis) - p_W(axis);
    if (direction(axis) == 0.0) {
      if (to_low > 0.0 || to_high < 0.0) t_out = -1.0;
      continue;
    }
    const double ta = to_low / direction(axis);
    const double tb = to_high / direction(axis);
    t = std::max(t, std::min(ta, tb));
    t_out = std::min(t_out, std::max(ta, tb));
  }
  // Walks from cell to cell. Rounding may take it into a neighbour of the true
  // cell where the ray runs along an edge: segments count for both.
  const Eigen::Vector2d start = p_W + t * direction;
  int x = CellX(start.x());
  int y = CellY(start.y());
  constexpr double kRounding = 1e-9;  // m.
  while (t <= t_out + kRounding) {
    for (const std::uint32_t i : InCell(x, y)) {
      const double to_wall = RayToSegment(p_W, direction, segments_[i]);
      if (to_wall > hit.distance) continue;
      const Eigen::Vector2d along = segments_[i].b - segments_[i].a;
      const Eigen::Vector2d p = p_W + to_wall * direction;
      hit = {
          to_wall,
          AngleToNormal(direction, {-along.y(), along.x()}),
          std::min((p - segments_[i].a).norm(), (p - segments_[i].b).norm())};
      found = true;
      t_out = std::min(t_out, to_wall);
    }
    const auto exit = [&](int axis, int cell) {
      if (direction(axis) == 0.0) return kInfinity;
      const double edge =
          low_(axis) + cell_ * (direction(axis) > 0.0 ? cell + 1 : cell);
      return (edge - p_W(axis)) / direction(axis);
    };
    const double exit_x = exit(0, x);
    const double exit_y = exit(1, y);
    t = std::min(exit_x, exit_y);
    if (exit_x < exit_y) {
      x += direction.x() > 0.0 ? 1 : -1;
    } else {
      y += direction.y() > 0.0 ? 1 : -1;
    }
    if (x < 0 || y < 0 || x >= num_x_ || y >= num_y_) break;
  }
  if (!found) return std::nullopt;
  return hit;
}

std::optional<ArcContact> ObstacleMap::FirstContact(
    const Pose2& X_WR,
    const ArcMotion& motion,
    double radius,
    std::span<const Disc2> discs) const {
  // Sagitta of a chord over a share 1 / n of the arc: L turn / (8 n^2). Chords
  // are short besides, so that their boxes hold few segments.
  const double bend = std::abs(motion.distance * motion.turn) / 8.0;
  const double num_chords = std::ceil(std::max(
      {1.0, std::sqrt(bend / kMaxSagitta), std::abs(motion.distance) / 0.5}));
  Eigen::Vector2d from = X_WR.position();
  for (double chord = 0.0; chord < num_chords; chord += 1.0) {
    const Eigen::Vector2d to =
        X_WR * PoseAlong(motion, (chord + 1.0) / num_chords).position();
    const Eigen::Vector2d d = to - from;
    double first = kInfinity;
    Eigen::Vector2d touched = from;
    for (const Disc2& disc : discs) {
      const Segment2 point{disc.p_W, disc.p_W};
      const double t = TimeOfImpact(from, d, point, radius + disc.radius);
      if (t > 1.0 || t >= first) continue;
      first = t;
      const Eigen::Vector2d out = from + t * d - disc.p_W;
      touched = disc.p_W + disc.radius * out.stableNormalized();
    }
    const Eigen::Vector2d margin(radius + kMaxSagitta, radius + kMaxSagitta);
    const Box box =
        BoxOf(from.cwiseMin(to) - margin, from.cwiseMax(to) + margin);
    for (int y = box.y0; y <= box.y1; ++y) {
      for (int x = box.x0; x <= box.x1; ++x) {
        for (const std::uint32_t i : InCell(x, y)) {
          const double t = TimeOfImpact(from, d, segments_[i], radius);
          if (t > 1.0 || t >= first) continue;
          first = t;
          touched = NearestOn(segments_[i], from + t * d);
        }
      }
    }
    if (first <= 1.0) return ArcContact{(chord + first) / num_chords, touched};
    from = to;
  }
  return std::nullopt;
}

}  // namespace waymark
