#include "drivers/simulator/triangulate.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <stdexcept>

namespace waymark {
namespace {

// Twice the area below which three corners are on one line, m^2: rounding of
// corners tens of metres from the origin.
constexpr double kFlat = 1e-9;

double TwiceArea(const Eigen::Vector2d& a,
                 const Eigen::Vector2d& b,
                 const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

class EarClipper {
 public:
  explicit EarClipper(const std::vector<Eigen::Vector2d>& outline)
      : outline_(outline), left_(outline.size()) {
    std::iota(left_.begin(), left_.end(), 0u);
  }

  std::vector<std::array<std::uint32_t, 3>> Run() {
    while (left_.size() > 3) ClipOne();
    Emit(0, 1, 2);
    return triangles_;
  }

 private:
  const Eigen::Vector2d& At(std::size_t i) const { return outline_[left_[i]]; }

  bool IsEar(std::size_t a, std::size_t b, std::size_t c) const {
    if (TwiceArea(At(a), At(b), At(c)) <= kFlat) return false;
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (i == a || i == b || i == c) continue;
      // Corners on the cut are no less in the way: they would be left out.
      if (TwiceArea(At(a), At(b), At(i)) >= -kFlat &&
          TwiceArea(At(b), At(c), At(i)) >= -kFlat &&
          TwiceArea(At(c), At(a), At(i)) >= -kFlat) {
        return false;
      }
    }
    return true;
  }

  // The ear that is least thin: by its smallest height.
  void ClipOne() {
    const std::size_t n = left_.size();
    double best = -1.0;
    std::size_t best_tip = 0;
    for (std::size_t tip = 0; tip < n; ++tip) {
      const std::size_t before = (tip + n - 1) % n;
      const std::size_t after = (tip + 1) % n;
      if (!IsEar(before, tip, after)) continue;
      const Eigen::Vector2d& p = At(before);
      const Eigen::Vector2d& q = At(tip);
      const Eigen::Vector2d& r = At(after);
      const double longest =
          std::max({(p - q).norm(), (q - r).norm(), (r - p).norm()});
      const double height = TwiceArea(p, q, r) / longest;
      if (height <= best) continue;
      best = height;
      best_tip = tip;
    }
    if (best < 0.0) {
      throw std::invalid_argument(
          "triangulate: the outline crosses itself or goes clockwise");
    }
    Emit((best_tip + n - 1) % n, best_tip, (best_tip + 1) % n);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(best_tip));
  }

  void Emit(std::size_t a, std::size_t b, std::size_t c) {
    triangles_.push_back({left_[a], left_[b], left_[c]});
  }

  const std::vector<Eigen::Vector2d>& outline_;
  std::vector<std::uint32_t> left_;  // Corners not yet cut off.
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> Triangulate(
    const std::vector<Eigen::Vector2d>& outline) {
  if (outline.size() < 3) {
    throw std::invalid_argument("triangulate: fewer than three corners");
  }
  return EarClipper(outline).Run();
}

}  // namespace waymark
