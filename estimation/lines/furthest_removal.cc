#include "estimation/lines/furthest_removal.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace waymark {
namespace {

// Fewer points than this are looked at one by one.
constexpr int kLeafSize = 8;

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
  int Furthest(const Eigen::Vector2d& centre) {
    best_ = -1;
    best_squared_ = -1.0;
    Search(0, centre);
    return best_;
  }

  void Remove(int index) {
    is_removed_[static_cast<std::size_t>(index)] = 1;
    for (int i = leaf_of_[static_cast<std::size_t>(index)]; i >= 0;
         i = nodes_[static_cast<std::size_t>(i)].parent) {
      Tighten(i);
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
    // Of the points that are left; empty if lowest_index is the largest int.
    Eigen::Array2d low;
    Eigen::Array2d high;
    int lowest_index = 0;
  };

  Node& At(int i) { return nodes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Eigen::Vector2d& Point(int i) const {
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
      Tighten(self);
      return self;
    }
    Tighten(self);
    At(self).is_leaf = false;
    const Eigen::Array2d middle = 0.5 * At(self).low + 0.5 * At(self).high;
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
    for (std::size_t i = 0; i < 4; ++i) {
      if (bounds[i] == bounds[i + 1]) continue;
      const int child = Build(self, bounds[i], bounds[i + 1]);
      At(self).children[i] = child;
    }
    return self;
  }

  void Include(Node* node,
               const Eigen::Array2d& low,
               const Eigen::Array2d& high,
               int index) {
    ++num_visits_;
    node->low = node->low.min(low);
    node->high = node->high.max(high);
    node->lowest_index = std::min(node->lowest_index, index);
  }

  void Tighten(int i) {
    Node& node = At(i);
    node.low.setConstant(std::numeric_limits<double>::infinity());
    node.high.setConstant(-std::numeric_limits<double>::infinity());
    node.lowest_index = std::numeric_limits<int>::max();
    if (!node.is_leaf) {
      for (const int child : node.children) {
        if (child < 0) continue;
        const Node& c = At(child);
        Include(&node, c.low, c.high, c.lowest_index);
      }
      return;
    }
    for (int k = node.begin; k < node.end; ++k) {
      const int point = order_[static_cast<std::size_t>(k)];
      if (IsRemoved(point)) continue;
      Include(&node, Point(point), Point(point), point);
    }
  }

  // No point of the node is further; exact also after rounding, because
  // rounding keeps the order.
  [[nodiscard]] static double Bound(const Node& node,
                                    const Eigen::Vector2d& centre) {
    const Eigen::Array2d d =
        (centre.array() - node.low).max(node.high - centre.array());
    return d.x() * d.x() + d.y() * d.y();
  }

  [[nodiscard]] bool IsBetter(double squared, int index) const {
    return squared > best_squared_ ||
           (squared == best_squared_ && index < best_);
  }

  void Search(int i, const Eigen::Vector2d& centre) {
    const Node& node = At(i);
    ++num_visits_;
    if (node.is_leaf) {
      for (int k = node.begin; k < node.end; ++k) {
        const int point = order_[static_cast<std::size_t>(k)];
        if (IsRemoved(point)) continue;
        ++num_visits_;
        const Eigen::Vector2d d = centre - Point(point);
        const double squared = d.x() * d.x() + d.y() * d.y();
        if (!IsBetter(squared, point)) continue;
        best_squared_ = squared;
        best_ = point;
      }
      return;
    }
    std::array<std::pair<double, int>, 4> next;
    std::size_t num = 0;
    for (const int child : node.children) {
      if (child < 0) continue;
      ++num_visits_;
      if (At(child).lowest_index == std::numeric_limits<int>::max()) continue;
      std::pair<double, int> entry(Bound(At(child), centre), child);
      // The most promising first.
      for (std::size_t k = 0; k < num; ++k) {
        if (entry.first > next[k].first) std::swap(entry, next[k]);
      }
      next[num++] = entry;
    }
    for (std::size_t k = 0; k < num; ++k) {
      const auto& [bound, child] = next[k];
      if (IsBetter(bound, At(child).lowest_index)) Search(child, centre);
    }
  }

  std::span<const Eigen::Vector2d> points_;
  std::vector<int> order_;
  std::vector<int> leaf_of_;
  std::vector<char> is_removed_;
  std::vector<Node> nodes_;
  int best_ = -1;
  double best_squared_ = -1.0;
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
