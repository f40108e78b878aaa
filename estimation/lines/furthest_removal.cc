#include "estimation/lines/furthest_removal.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace waymark {
namespace {

using Eigen::Vector2d;

// Fewer points than this are looked at one by one.
constexpr int kLeafSize = 8;

// A quad-tree whose nodes remember their furthest point, where the centre was
// when they found it, and how far it may go before that can change: the
// distance to the nearest bisector between it and a point it won against. The
// centre of gravity moves by the n-th part of a distance at a time, so few of n
// nodes have to look again, however many points are nearly as far.
class QuadTree {
 public:
  explicit QuadTree(std::span<const Eigen::Vector2d> points)
      : points_(points),
        order_(points.size()),
        leaf_of_(points.size(), -1),
        is_removed_(points.size(), 0) {
    std::iota(order_.begin(), order_.end(), 0);
    Build(-1, 0, static_cast<int>(points.size()));
  }

  // Index of the furthest point from `centre`.
  int Furthest(const Vector2d& centre) {
    Update(0, centre);
    return At(0).best;
  }

  void Remove(int index) {
    is_removed_[static_cast<std::size_t>(index)] = 1;
    for (int i = leaf_of_[static_cast<std::size_t>(index)]; i >= 0;
         i = At(i).parent) {
      At(i).radius = -1.0;
    }
  }

  [[nodiscard]] bool IsRemoved(int index) const {
    return is_removed_[static_cast<std::size_t>(index)] != 0;
  }
  [[nodiscard]] std::int64_t num_visits() const { return num_visits_; }

 private:
  struct Node {
    int parent = -1;
    int begin = 0;  // Of order_, for leaves.
    int end = 0;
    std::array<int, 4> children{-1, -1, -1, -1};
    bool is_leaf = true;
    bool has_looked = false;
    int best = -1;         // Of the points that are left; -1: none is.
    double squared = 0.0;  // Its distance from `centre`.
    Vector2d centre = Vector2d::Zero();
    double radius = -1.0;  // About `centre`, within which it stays the best.
  };

  Node& At(int i) { return nodes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Vector2d& Point(int i) const {
    return points_[static_cast<std::size_t>(i)];
  }

  int Build(int parent, int begin, int end) {
    const int self = static_cast<int>(nodes_.size());
    nodes_.emplace_back();
    At(self).parent = parent;
    At(self).begin = begin;
    At(self).end = end;
    const auto at = [&](int i) { return order_.begin() + i; };
    if (end - begin <= kLeafSize) {
      for (int i = begin; i < end; ++i) {
        leaf_of_[static_cast<std::size_t>(*at(i))] = self;
      }
      return self;
    }
    At(self).is_leaf = false;
    const std::array<int, 5> bounds = Quarters(begin, end);
    for (std::size_t i = 0; i < 4; ++i) {
      if (bounds[i] == bounds[i + 1]) continue;
      const int child = Build(self, bounds[i], bounds[i + 1]);
      At(self).children[i] = child;
    }
    return self;
  }

  // Orders the points by the quarters of their square.
  std::array<int, 5> Quarters(int begin, int end) {
    const auto at = [&](int i) { return order_.begin() + i; };
    Vector2d low = Point(*at(begin));
    Vector2d high = low;
    for (int i = begin; i < end; ++i) {
      low = low.cwiseMin(Point(*at(i)));
      high = high.cwiseMax(Point(*at(i)));
    }
    num_visits_ += end - begin;
    const Vector2d middle = 0.5 * low + 0.5 * high;
    const auto split = [&](int from, int to, int axis) {
      return static_cast<int>(
          std::partition(at(from),
                         at(to),
                         [&](int i) { return Point(i)[axis] < middle[axis]; }) -
          order_.begin());
    };
    std::array<int, 5> bounds{begin, 0, split(begin, end, 0), 0, end};
    bounds[1] = split(bounds[0], bounds[2], 1);
    bounds[3] = split(bounds[2], bounds[4], 1);
    for (std::size_t i = 0; i < 4; ++i) {
      if (bounds[i + 1] - bounds[i] < end - begin) continue;
      // No square parts them, equal points for example: by number.
      for (int k = 1; k < 4; ++k) {
        bounds[static_cast<std::size_t>(k)] = begin + k * (end - begin) / 4;
      }
      break;
    }
    return bounds;
  }

  [[nodiscard]] static bool IsBetter(double squared, int index, const Node& n) {
    return n.best < 0 || squared > n.squared ||
           (squared == n.squared && index < n.best);
  }

  // How far the centre may go before `other`, which it lost against the node's
  // best by squares of distances, could win.
  [[nodiscard]] double Margin(const Node& node,
                              int other,
                              double squared) const {
    const double apart = (Point(node.best) - Point(other)).norm();
    // Equal points are equally far from anywhere.
    if (apart == 0.0) return std::numeric_limits<double>::infinity();
    // Both squares are rounded, here and where the centre goes, where they may
    // be four times as large.
    constexpr double kRounding = 1e-14;
    const double gap = node.squared - squared - kRounding * node.squared;
    if (!(gap > 0.0)) return 0.0;
    // The gap changes by 2 apart for each step toward the best.
    return 0.5 * gap / apart;
  }

  [[nodiscard]] static bool IsValid(const Node& node, const Vector2d& centre) {
    return (centre - node.centre).norm() < node.radius;
  }

  // No point of the node is further, whatever was removed since it looked.
  [[nodiscard]] static double Bound(const Node& node, const Vector2d& centre) {
    // Of roots and sums.
    constexpr double kRounding = 1.0 + 1e-14;
    if (!node.has_looked) return std::numeric_limits<double>::infinity();
    if (node.best < 0) return -1.0;
    return kRounding *
           (std::sqrt(node.squared) + (centre - node.centre).norm());
  }

  void Update(int i, const Vector2d& centre) {
    ++num_visits_;
    Node& node = At(i);  // No node is added any more: references stay.
    if (IsValid(node, centre)) return;
    node.has_looked = true;
    node.best = -1;
    node.centre = centre;
    node.radius = std::numeric_limits<double>::infinity();
    if (node.is_leaf) {
      UpdateLeaf(&node);
    } else {
      UpdateInner(&node);
    }
    // Of sums and differences of radii.
    node.radius *= 1.0 - 1e-12;
  }

  void UpdateInner(Node* node) {
    const Vector2d& centre = node->centre;
    // The most promising first.
    std::array<std::pair<double, int>, 4> order;
    std::size_t num = 0;
    for (const int child : node->children) {
      if (child < 0) continue;
      ++num_visits_;
      std::pair<double, int> entry(Bound(At(child), centre), child);
      for (std::size_t k = 0; k < num; ++k) {
        if (entry.first > order[k].first) std::swap(entry, order[k]);
      }
      order[num++] = entry;
    }
    std::array<bool, 4> is_known{};
    for (std::size_t k = 0; k < num; ++k) {
      const auto& [bound, child] = order[k];
      if (node->best >= 0 && bound < std::sqrt(node->squared) &&
          !IsValid(At(child), centre)) {
        continue;
      }
      Update(child, centre);
      is_known[k] = true;
      Take(SquaredOf(At(child).best, centre), At(child).best, node);
    }
    for (std::size_t k = 0; k < num; ++k) {
      const auto& [bound, child] = order[k];
      const Node& c = At(child);
      if (!is_known[k]) {
        // Both distances may change by as much as the centre goes.
        const double lead = std::sqrt(node->squared) - bound;
        node->radius = std::min(node->radius, 0.5 * lead);
        continue;
      }
      node->radius =
          std::min(node->radius, c.radius - (centre - c.centre).norm());
      if (c.best < 0 || c.best == node->best) continue;
      node->radius = std::min(node->radius,
                              Margin(*node, c.best, SquaredOf(c.best, centre)));
    }
  }

  void UpdateLeaf(Node* node) {
    const auto each = [&](auto&& look) {
      for (int k = node->begin; k < node->end; ++k) {
        const int point = order_[static_cast<std::size_t>(k)];
        if (!IsRemoved(point)) look(point, SquaredOf(point, node->centre));
      }
    };
    num_visits_ += node->end - node->begin;
    each([&](int point, double squared) { Take(squared, point, node); });
    each([&](int point, double squared) {
      if (point == node->best) return;
      node->radius = std::min(node->radius, Margin(*node, point, squared));
    });
  }

  static void Take(double squared, int point, Node* node) {
    if (point < 0 || !IsBetter(squared, point, *node)) return;
    node->best = point;
    node->squared = squared;
  }

  [[nodiscard]] double SquaredOf(int point, const Vector2d& centre) const {
    if (point < 0) return 0.0;
    const Vector2d d = centre - Point(point);
    return d.x() * d.x() + d.y() * d.y();
  }

  std::span<const Vector2d> points_;
  std::vector<int> order_;
  std::vector<int> leaf_of_;
  std::vector<char> is_removed_;
  std::vector<Node> nodes_;
  std::int64_t num_visits_ = 0;
};

}  // namespace

FurthestRemoval RemoveFurthest(std::span<const Eigen::Vector2d> points,
                               int num_kept) {
  WAYMARK_CHECK(num_kept >= 1, num_kept);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) {
    WAYMARK_CHECK(point.allFinite());
    sum += point;
  }
  FurthestRemoval result;
  if (points.empty()) return result;
  QuadTree tree(points);
  int num_left = static_cast<int>(points.size());
  while (num_left > num_kept) {
    const int furthest = tree.Furthest(sum / num_left);
    tree.Remove(furthest);
    result.removed.push_back(furthest);
    sum -= points[static_cast<std::size_t>(furthest)];
    --num_left;
  }
  // Afresh: what was taken away may have been large.
  sum.setZero();
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (tree.IsRemoved(i)) continue;
    result.kept.push_back(i);
    sum += points[static_cast<std::size_t>(i)];
  }
  result.centre = sum / num_left;
  result.num_visits = tree.num_visits();
  return result;
}

FurthestRemoval RemoveFurthest(std::span<const double> values, int num_kept) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(values.size());
  for (const double value : values) points.emplace_back(value, 0.0);
  return RemoveFurthest(points, num_kept);
}

}  // namespace waymark
