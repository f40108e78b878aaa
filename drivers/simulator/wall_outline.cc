#include "drivers/simulator/wall_outline.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace waymark {
namespace {

using Eigen::Vector2d;

// Directions along the edges of pixels: right, down, left, up.
constexpr std::array<std::array<int, 2>, 4> kSteps{
    {{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

// A corner of an outline of pixels, and the length of the side that leads to
// the next.
struct Corner {
  int x = 0;
  int y = 0;
  int direction = 0;  // Of the side that leaves.
  int length = 0;     // Of that side, pixels.
};

class OutlineTracer {
 public:
  explicit OutlineTracer(const cv::Mat1b& mask)
      : mask_(mask), seen_(mask.rows + 1, mask.cols + 1, std::uint8_t{0}) {}

  // All closed paths with the region on the left: leftward along the upper
  // side of a pixel.
  std::vector<std::vector<Corner>> All() {
    std::vector<std::vector<Corner>> paths;
    for (int y = 0; y < mask_.rows; ++y) {
      for (int x = 0; x < mask_.cols; ++x) {
        // An upper side of a region that no path has passed.
        if (IsIn(x, y) && !IsIn(x, y - 1) && seen_(y, x) == 0) {
          paths.push_back(Trace(x + 1, y));
        }
      }
    }
    return paths;
  }

 private:
  [[nodiscard]] bool IsIn(int x, int y) const {
    return x >= 0 && y >= 0 && x < mask_.cols && y < mask_.rows &&
           mask_(y, x) != 0;
  }

  // The pixels to the left and right of the edge that leaves a corner.
  [[nodiscard]] bool CanLeave(int x, int y, int direction) const {
    switch (direction) {
      case 0:  // Right: region above.
        return IsIn(x, y - 1) && !IsIn(x, y);
      case 1:  // Down: region on the right.
        return IsIn(x, y) && !IsIn(x - 1, y);
      case 2:  // Left: region below.
        return IsIn(x - 1, y) && !IsIn(x - 1, y - 1);
      default:  // Up: region on the left.
        return IsIn(x - 1, y - 1) && !IsIn(x, y - 1);
    }
  }

  std::vector<Corner> Trace(int start_x, int start_y) {
    std::vector<Corner> path;
    int x = start_x;
    int y = start_y;
    int direction = 2;
    do {
      if (path.empty() || path.back().direction != direction) {
        path.push_back({x, y, direction, 0});
      }
      ++path.back().length;
      if (direction == 2) seen_(y, x - 1) = 1;
      x += kSteps[static_cast<std::size_t>(direction)][0];
      y += kSteps[static_cast<std::size_t>(direction)][1];
      direction = NextDirection(x, y, direction);
    } while (x != start_x || y != start_y || direction != 2);
    // The start may lie within a side.
    if (path.size() > 1 && path.front().direction == path.back().direction) {
      path.front().x = path.back().x;
      path.front().y = path.back().y;
      path.front().length += path.back().length;
      path.pop_back();
    }
    return path;
  }

  // Where pixels touch at a corner, on to the other one.
  [[nodiscard]] int NextDirection(int x, int y, int direction) const {
    for (const int turn : {1, 0, 3}) {
      const int next = (direction + turn) % 4;
      if (CanLeave(x, y, next)) return next;
    }
    return (direction + 2) % 4;  // Not reached: every path goes on.
  }

  const cv::Mat1b& mask_;
  cv::Mat1b seen_;  // Upper sides of pixels.
};

// Of the two sides that meet at a corner of a digital straight line, one is one
// pixel long; a corner of two longer sides is one of the wall, as is the end of
// a thin wall, whose long sides go off the same way or which turns thrice.
std::vector<bool> TrueCorners(const std::vector<Corner>& path) {
  const std::size_t n = path.size();
  const auto turn = [&](std::size_t i) {
    return (path[i % n].direction - path[(i + n - 1) % n].direction + 4) % 4;
  };
  const auto is_long = [&](std::size_t i) { return path[i % n].length > 1; };
  std::vector<bool> is_true(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_long(i + n - 1) && is_long(i)) is_true[i] = true;
    const std::size_t next = (i + 1) % n;
    if (turn(i) != turn(next)) continue;
    if ((is_long(i + n - 1) && is_long(next)) || turn(i) == turn(next + 1)) {
      is_true[i] = true;
      is_true[next] = true;
    }
    if (turn(i) == turn(next + 1)) is_true[(next + 1) % n] = true;
  }
  return is_true;
}

Vector2d PointOf(const Corner& corner) {
  return {static_cast<double>(corner.x), static_cast<double>(corner.y)};
}

double DistanceToLine(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double length = along.norm();
  if (!(length > 0.0)) return (p - a).norm();
  return std::abs(along.x() * (p.y() - a.y()) - along.y() * (p.x() - a.x())) /
         length;
}

// Douglas and Peucker between the ends of a chain; appends all but the last.
void Simplify(const std::vector<Vector2d>& chain,
              double tolerance,
              std::vector<Vector2d>* out) {
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, chain.size() - 1}};
  while (!parts.empty()) {
    const auto [first, last] = parts.back();
    parts.pop_back();
    std::size_t furthest = first;
    double distance = tolerance;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = DistanceToLine(chain[i], chain[first], chain[last]);
      if (d > distance) {
        distance = d;
        furthest = i;
      }
    }
    if (furthest == first) {
      out->push_back(chain[first]);
    } else {
      parts.emplace_back(furthest, last);  // Taken after the other.
      parts.emplace_back(first, furthest);
    }
  }
}

std::vector<Vector2d> OutlineOf(const std::vector<Corner>& path,
                                double tolerance) {
  std::vector<Vector2d> outline;
  // Below half a pixel a stair is as good as a corner.
  const std::vector<bool> is_true = tolerance < 0.5
                                        ? std::vector<bool>(path.size(), true)
                                        : TrueCorners(path);
  std::size_t start = 0;
  while (start < path.size() && !is_true[start]) ++start;
  start %= path.size();
  std::vector<Vector2d> chain{PointOf(path[start])};
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Corner& corner = path[(start + k) % path.size()];
    const std::size_t next = (start + k + 1) % path.size();
    const bool ends = is_true[next] || k + 1 == path.size();
    // The middle of a side is on the line that its stair stands for; a long
    // side has the middles of its pixels.
    const auto& step = kSteps[static_cast<std::size_t>(corner.direction)];
    const Vector2d along(step[0], step[1]);
    if (!(ends && chain.size() == 1)) {
      chain.push_back(PointOf(corner) + 0.5 * along);
      if (corner.length > 1) {
        chain.push_back(PointOf(corner) + (corner.length - 0.5) * along);
      }
    }
    if (ends) {
      chain.push_back(PointOf(path[next]));
      Simplify(chain, tolerance, &outline);
      chain = {PointOf(path[next])};
    }
  }
  return outline;
}

}  // namespace

std::vector<std::vector<Vector2d>> WallOutlines(const cv::Mat1b& mask,
                                                double tolerance) {
  std::vector<std::vector<Vector2d>> outlines;
  for (const std::vector<Corner>& path : OutlineTracer(mask).All()) {
    outlines.push_back(OutlineOf(path, tolerance));
  }
  return outlines;
}

}  // namespace waymark
