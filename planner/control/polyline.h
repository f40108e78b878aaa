// A way of straight pieces.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace waymark {

class Polyline {
 public:
  // At least one point; no two in a row are equal.
  explicit Polyline(std::vector<Eigen::Vector2d> points);

  [[nodiscard]] const std::vector<Eigen::Vector2d>& points() const {
    return points_;
  }
  // From the first point to each, m.
  [[nodiscard]] double LengthTo(std::size_t index) const {
    return lengths_[index];
  }
  [[nodiscard]] double length() const { return lengths_.back(); }

  // At `s` along it, m; beyond its end straight on.
  [[nodiscard]] Eigen::Vector2d PointAt(double s) const;
  // Change of direction at an inner point, rad, left positive.
  [[nodiscard]] double TurnAt(std::size_t index) const;

  struct Foot {
    double s = 0.0;
    double offset = 0.0;  // Distance from the line, m, left positive.
  };
  // The nearest place between s = `from` and `to`.
  [[nodiscard]] Foot Project(const Eigen::Vector2d& p,
                             double from,
                             double to) const;

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> lengths_;
};

}  // namespace waymark
