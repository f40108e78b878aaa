// Lines through points by total least squares, from sums.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace waymark {

struct LineFit {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // Of length 1.
  // Mean squares of the points about the mean, along and across the line.
  double along = 0.0;
  double across = 0.0;

  // Signed, on the right of the direction on the screen.
  [[nodiscard]] double Distance(const Eigen::Vector2d& p) const {
    return direction.x() * (p.y() - mean.y()) -
           direction.y() * (p.x() - mean.x());
  }
  [[nodiscard]] double Along(const Eigen::Vector2d& p) const {
    return direction.dot(p - mean);
  }
};

// Sums of points with weights. Sums of sets add, so the line of two sets
// together costs no look at their points.
struct LineMoments {
  double n = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;

  void Add(double px, double py, double weight = 1.0) {
    n += weight;
    x += weight * px;
    y += weight * py;
    xx += weight * px * px;
    xy += weight * px * py;
    yy += weight * py * py;
  }
  LineMoments& operator+=(const LineMoments& other) {
    n += other.n;
    x += other.x;
    y += other.y;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    return *this;
  }

  // Whether the mean square across the best line is at most `limit`: the matrix
  // of the second moments less `limit` has no positive determinant, or no
  // positive value at all. Cheaper than the fit.
  [[nodiscard]] bool IsStraight(double limit) const {
    const double t = limit * n * n;
    const double a = n * xx - x * x - t;
    const double b = n * xy - x * y;
    const double c = n * yy - y * y - t;
    return a <= 0.0 || c <= 0.0 || a * c <= b * b;
  }

  // Needs n > 0. The direction of a single point is that of x; of two signs
  // the one with x > 0 (or x = 0, y > 0).
  [[nodiscard]] LineFit Fit() const {
    LineFit fit;
    const double mx = x / n;
    const double my = y / n;
    const double a = xx / n - mx * mx;
    const double b = xy / n - mx * my;
    const double c = yy / n - my * my;
    const double half = 0.5 * (a - c);
    const double root = std::sqrt(half * half + b * b);
    const double middle = 0.5 * (a + c);
    fit.mean = {mx, my};
    fit.along = middle + root;
    fit.across = std::max(0.0, middle - root);
    // The longer of the two rows of (M - least I) is the safer one.
    Eigen::Vector2d d = half >= 0.0 ? Eigen::Vector2d(root + half, b)
                                    : Eigen::Vector2d(b, root - half);
    if (d.x() < 0.0 || (d.x() == 0.0 && d.y() < 0.0)) d = -d;
    const double length = d.norm();
    if (length > 0.0) fit.direction = d / length;
    return fit;
  }
};

}  // namespace waymark
