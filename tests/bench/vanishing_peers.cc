#include "tests/bench/vanishing_peers.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct PlainLine {
  Vector3d normal;  // Unit, of the plane through the camera and the line.
  Vector2d along;   // Unit, in the image.
  double length;
};

std::vector<PlainLine> PlainLines(std::span<const LineSegment> lines,
                                  const PinholeView& view) {
  std::vector<PlainLine> plain;
  for (const LineSegment& line : lines) {
    const auto ray = [&](const Vector2d& p) {
      return Vector3d(
          (p.x() - view.cx) / view.fx, (p.y() - view.cy) / view.fy, 1.0);
    };
    plain.push_back({ray(line.a).cross(ray(line.b)).normalized(),
                     (line.b - line.a).normalized(),
                     (line.b - line.a).norm()});
  }
  return plain;
}

// Votes over the half sphere z >= 0, a degree a cell.
class SphereGrid {
 public:
  void Add(const Vector3d& n, double weight) { cells_[CellOf(n)] += weight; }
  [[nodiscard]] double At(const Vector3d& n) const { return cells_[CellOf(n)]; }
  // Each cell takes in its neighbours, as [1] does.
  void Spread() {
    const std::vector<double> before = cells_;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        double sum = 0.0;
        for (int dr = -1; dr <= 1; ++dr) {
          for (int dc = -1; dc <= 1; ++dc) {
            const int r = std::clamp(row + dr, 0, kRows - 1);
            const int c = (column + dc + kColumns) % kColumns;
            sum += before[static_cast<std::size_t>(r * kColumns + c)];
          }
        }
        const auto i = static_cast<std::size_t>(row * kColumns + column);
        cells_[i] = before[i] + sum / 9.0;
      }
    }
  }

 private:
  static constexpr int kRows = 90;
  static constexpr int kColumns = 360;
  static std::size_t CellOf(Vector3d n) {
    if (n.z() < 0.0) n = -n;
    const double polar = DegreesFromRadians(std::acos(std::min(1.0, n.z())));
    const double around = DegreesFromRadians(std::atan2(n.x(), n.y())) + 180.0;
    const int row = std::min(static_cast<int>(polar), kRows - 1);
    const int column = static_cast<int>(around) % kColumns;
    return static_cast<std::size_t>(row * kColumns + column);
  }
  std::vector<double> cells_ = std::vector<double>(kRows * kColumns, 0.0);
};

SphereGrid VotesOf(const std::vector<PlainLine>& lines) {
  SphereGrid grid;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      const Vector3d n = lines[i].normal.cross(lines[j].normal);
      const double norm = n.norm();
      if (norm < 1e-9) continue;  // One line: no intersection.
      const Vector2d& a = lines[i].along;
      const Vector2d& b = lines[j].along;
      const double angle = std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()),
                                      std::abs(a.dot(b)));
      grid.Add(n / norm,
               lines[i].length * lines[j].length * std::sin(2.0 * angle));
    }
  }
  grid.Spread();
  return grid;
}

// The best second and third direction for the first.
void TryAxis(const Vector3d& axis,
             const SphereGrid& grid,
             double* most,
             Matrix3d* best) {
  const Vector3d e1 = axis.unitOrthogonal();
  const Vector3d e2 = axis.cross(e1);
  const double own = grid.At(axis);
  // The second and third change places after a right angle; the paper tries
  // all 360 degrees, to the same result.
  static const std::array<Vector2d, 90> kTurns = [] {
    std::array<Vector2d, 90> turns;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double turn = RadiansFromDegrees(static_cast<double>(i));
      turns[i] = {std::cos(turn), std::sin(turn)};
    }
    return turns;
  }();
  for (const Vector2d& turn : kTurns) {
    const Vector3d second = turn.x() * e1 + turn.y() * e2;
    const Vector3d third = axis.cross(second);
    const double score = own + grid.At(second) + grid.At(third);
    if (score <= *most) continue;
    *most = score;
    *best << axis, second, third;
  }
}

// Least squares of the rotation to the lines near each axis.
void RefineRotation(const std::vector<PlainLine>& lines, Matrix3d* R_CM) {
  const double wide = RadiansFromDegrees(6.0);  // The gate of [1].
  const double narrow = RadiansFromDegrees(2.0);
  for (int round = 0; round < 10; ++round) {
    const double gate = std::sin(round < 3 ? wide : narrow);
    Matrix3d information = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    for (const PlainLine& line : lines) {
      Eigen::Index k = 0;
      const Vector3d off = R_CM->transpose() * line.normal;
      if (off.cwiseAbs().minCoeff(&k) > gate) continue;
      const Vector3d slope = R_CM->col(k).cross(line.normal);
      information += line.length * slope * slope.transpose();
      pull -= line.length * off[k] * slope;
    }
    const Vector3d turn = information.ldlt().solve(pull);
    if (!turn.allFinite() || turn.norm() > 0.2) return;
    if (turn.norm() < 1e-12) return;
    *R_CM = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * *R_CM;
  }
}

std::optional<Matrix3d> Finish(const std::vector<PlainLine>& lines,
                               double most,
                               Matrix3d R_CM) {
  if (!(most > 0.0)) return std::nullopt;
  RefineRotation(lines, &R_CM);
  return R_CM;
}

}  // namespace

std::optional<Matrix3d> TwoLineSearch(std::span<const LineSegment> lines,
                                      const PinholeView& view) {
  const std::vector<PlainLine> plain = PlainLines(lines, view);
  if (plain.size() < 2) return std::nullopt;
  const SphereGrid grid = VotesOf(plain);
  // Of both lines one direction, of three: 1/3 of half times half.
  const int num_pairs = static_cast<int>(
      std::ceil(std::log(1.0 - 0.9999) / std::log(1.0 - 0.25 / 3.0)));
  Random random(SeedFor(1, "TwoLineSearch"));
  double most = 0.0;
  Matrix3d best = Matrix3d::Identity();
  for (int i = 0; i < num_pairs; ++i) {
    const std::size_t a = random.Index(plain.size());
    const std::size_t b = random.Index(plain.size());
    const Vector3d axis = plain[a].normal.cross(plain[b].normal);
    if (axis.norm() < 1e-9) continue;
    TryAxis(axis.normalized(), grid, &most, &best);
  }
  return Finish(plain, most, best);
}

std::optional<Matrix3d> TwoLineSearchOfAllPairs(
    std::span<const LineSegment> lines, const PinholeView& view) {
  std::vector<PlainLine> plain = PlainLines(lines, view);
  const SphereGrid grid = VotesOf(plain);
  double most = 0.0;
  Matrix3d best = Matrix3d::Identity();
  for (std::size_t i = 0; i < plain.size(); ++i) {
    for (std::size_t j = i + 1; j < plain.size(); ++j) {
      const Vector3d axis = plain[i].normal.cross(plain[j].normal);
      if (axis.norm() < 1e-9) continue;
      TryAxis(axis.normalized(), grid, &most, &best);
    }
  }
  return Finish(plain, most, best);
}

std::optional<Vector3d> RansacVanishingPoint(std::span<const LineSegment> lines,
                                             const PinholeView& view,
                                             const DirectionPrior& prior,
                                             double gate_sigmas) {
  const double gate = std::cos(std::min(1.4, gate_sigmas * prior.sigma_rad));
  const double near = std::sin(RadiansFromDegrees(1.0));
  const std::vector<PlainLine> plain = PlainLines(lines, view);
  if (plain.size() < 2) return std::nullopt;
  constexpr int kNumSamples = 500;
  Random random(SeedFor(1, "RansacVanishingPoint"));
  double most = 0.0;
  Vector3d best = Vector3d::Zero();
  for (int i = 0; i < kNumSamples; ++i) {
    const std::size_t a = random.Index(plain.size());
    const std::size_t b = random.Index(plain.size());
    Vector3d n = plain[a].normal.cross(plain[b].normal);
    if (n.norm() < 0.03) continue;  // As ours: pieces of one line.
    n.normalize();
    if (n.dot(prior.n_C) < 0.0) n = -n;
    if (n.dot(prior.n_C) < gate) continue;
    double score = 0.0;
    for (const PlainLine& line : plain) {
      if (std::abs(line.normal.dot(n)) < near) score += line.length;
    }
    if (score <= most) continue;
    most = score;
    best = n;
  }
  if (!(most > 0.0)) return std::nullopt;
  for (int round = 0; round < 5; ++round) {
    Matrix3d scatter = Matrix3d::Zero();
    for (const PlainLine& line : plain) {
      if (std::abs(line.normal.dot(best)) > near) continue;
      scatter += line.length * line.normal * line.normal.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(scatter);
    const Vector3d n = solver.eigenvectors().col(0);
    best = n.dot(best) < 0.0 ? Vector3d(-n) : n;
  }
  return best;
}

std::vector<int> PlainFurthestRemoval(std::span<const Vector2d> points,
                                      int num_kept) {
  std::vector<int> left(points.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<int> order;
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& p : points) sum += p;
  while (static_cast<int>(left.size()) > num_kept) {
    const Vector2d centre = sum / static_cast<double>(left.size());
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Vector2d d = centre - points[static_cast<std::size_t>(left[i])];
      const double squared = d.squaredNorm();
      // Swapped out of order below: of equals the lowest index goes.
      if (squared > most || (squared == most && left[i] < left[best])) {
        most = squared;
        best = i;
      }
    }
    order.push_back(left[best]);
    sum -= points[static_cast<std::size_t>(left[best])];
    left[best] = left.back();
    left.pop_back();
  }
  return order;
}

}  // namespace waymark
