#include "estimation/lines/manhattan_directions.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kNumBins = 90;  // Of a right angle: a degree each.

struct Line {
  LineDirection direction;
  Vector3d normal;
  double length;
};

struct Hypothesis {
  Matrix3d R_CM;
  double score;
};

class Search {
 public:
  Search(std::vector<Line> lines, const ManhattanOptions& options)
      : lines_(std::move(lines)),
        options_(options),
        odds_(options.inlier_share / (3.0 * (1.0 - options.inlier_share)) *
              std::sqrt(0.5 * kPi)) {}

  std::vector<Hypothesis> Proposals() const {
    std::vector<Hypothesis> found;
    const std::size_t num =
        std::min(lines_.size(), static_cast<std::size_t>(options_.num_seeds));
    for (std::size_t i = 0; i < num; ++i) {
      for (std::size_t j = i + 1; j < num; ++j) {
        const Vector3d axis = lines_[i].normal.cross(lines_[j].normal);
        // Pieces of one line propose nothing.
        if (axis.norm() < 0.02) continue;
        found.push_back(Complete(axis.normalized()));
      }
    }
    std::stable_sort(
        found.begin(), found.end(), [](const auto& a, const auto& b) {
          return a.score > b.score;
        });
    return found;
  }

  // How far from chance that the line runs along n_C, and its error.
  double Belief(const Line& line, const Vector3d& n_C, double* sigma) const {
    const LineDirection& d = line.direction;
    const double along = std::abs(d.along_C.dot(n_C));
    *sigma = std::hypot(d.Sigma(n_C), options_.model_sigma_rad * along);
    const double z = d.across_C.dot(n_C) / *sigma;
    const double angle = *sigma / std::max(along, *sigma);
    return odds_ / angle * std::exp(-0.5 * z * z);
  }

  double Support(const Matrix3d& R_CM) const {
    double support = 0.0;
    for (const Line& line : lines_) {
      double sum = 1.0;
      double sigma = 0.0;
      for (int k = 0; k < 3; ++k) sum += Belief(line, R_CM.col(k), &sigma);
      support += std::log(sum);
    }
    return support;
  }

  // Returns the information on a turn of R_CM in C.
  Matrix3d Refine(Matrix3d* R_CM) const {
    constexpr int kMaxIterations = 30;
    constexpr double kConverged = 1e-11;
    Matrix3d information;
    for (int i = 0; i < kMaxIterations; ++i) {
      information.setZero();
      Vector3d pull = Vector3d::Zero();
      for (const Line& line : lines_) {
        std::array<double, 3> belief{};
        std::array<double, 3> sigma{};
        double sum = 1.0;
        for (int k = 0; k < 3; ++k) {
          const auto at = static_cast<std::size_t>(k);
          belief[at] = Belief(line, R_CM->col(k), &sigma[at]);
          sum += belief[at];
        }
        for (int k = 0; k < 3; ++k) {
          const auto at = static_cast<std::size_t>(k);
          const Vector3d n_C = R_CM->col(k);
          // across' (turn x n) = turn' (n x across).
          const Vector3d slope = n_C.cross(line.direction.across_C) / sigma[at];
          const double weight = belief[at] / sum;
          information += weight * slope * slope.transpose();
          pull -= weight * slope * line.direction.across_C.dot(n_C) / sigma[at];
        }
      }
      const Eigen::FullPivLU<Matrix3d> lu(information);
      if (!lu.isInvertible()) break;
      const Vector3d turn = lu.solve(pull);
      if (turn.norm() > 0.2) break;  // Off its own maximum: left as it is.
      if (turn.norm() > 0.0) {
        *R_CM = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * *R_CM;
      }
      if (turn.norm() < kConverged) break;
    }
    return information;
  }

 private:
  Hypothesis Complete(const Vector3d& axis) const {
    const Vector3d e1 = axis.unitOrthogonal();
    const Vector3d e2 = axis.cross(e1);
    std::array<double, kNumBins> bins{};
    double score = 0.0;
    for (const Line& line : lines_) {
      double sigma = 0.0;
      const double own = Belief(line, axis, &sigma);
      const double weight = line.length * own / (1.0 + own);
      score += weight;
      const double a = line.normal.dot(e1);
      const double b = line.normal.dot(e2);
      const double heading = std::atan2(-a, b) + kPi;
      const auto bin = static_cast<std::size_t>(heading / (0.5 * kPi) *
                                                static_cast<double>(kNumBins));
      // A plane across the axis says nothing of headings about it.
      bins[bin % kNumBins] += (line.length - weight) * (a * a + b * b);
    }
    const auto smooth = [&](std::size_t i) {
      return bins[i] + 0.7 * (bins[(i + 1) % kNumBins] +
                              bins[(i + kNumBins - 1) % kNumBins]);
    };
    std::size_t best = 0;
    for (std::size_t i = 1; i < kNumBins; ++i) {
      if (smooth(i) > smooth(best)) best = i;
    }
    const double h = (static_cast<double>(best) + 0.5) * 0.5 * kPi / kNumBins;
    Matrix3d R_CM;
    R_CM.col(0) = axis;
    R_CM.col(1) = std::cos(h) * e1 + std::sin(h) * e2;
    R_CM.col(2) = axis.cross(R_CM.col(1));
    return {R_CM, score + smooth(best)};
  }

  std::vector<Line> lines_;
  ManhattanOptions options_;
  double odds_;
};

}  // namespace

void ManhattanOptions::Check() const {
  if (max_lines < 3) throw std::invalid_argument("max_lines: at least 3");
  if (num_seeds < 3) throw std::invalid_argument("num_seeds: at least 3");
  if (num_refined < 1) throw std::invalid_argument("num_refined: at least 1");
  if (!(model_sigma_rad > 0.0) || !(model_sigma_rad <= 0.1)) {
    throw std::invalid_argument("model_sigma_rad must be in (0, 0.1]");
  }
  if (!(inlier_share > 0.0) || !(inlier_share < 1.0)) {
    throw std::invalid_argument("inlier_share must be in (0, 1)");
  }
}

std::optional<ManhattanDirections> FindManhattanDirections(
    std::span<const LineSegment> lines,
    const PinholeView& view,
    const ManhattanOptions& options) {
  options.Check();
  const std::vector<LineDirection> directions = LineDirections(lines, view);
  std::vector<Line> sorted;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    sorted.push_back({directions[i],
                      directions[i].Normal(),
                      (lines[i].b - lines[i].a).norm()});
  }
  std::stable_sort(
      sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
        return a.length > b.length;
      });
  if (sorted.size() > static_cast<std::size_t>(options.max_lines)) {
    sorted.erase(sorted.begin() + options.max_lines, sorted.end());
  }
  const Search search(std::move(sorted), options);
  std::optional<ManhattanDirections> best;
  double most = 0.0;
  int num_left = options.num_refined;
  for (const Hypothesis& hypothesis : search.Proposals()) {
    if (num_left-- == 0) break;
    Matrix3d R_CM = hypothesis.R_CM;
    const Eigen::FullPivLU<Matrix3d> lu(search.Refine(&R_CM));
    const double support = search.Support(R_CM);
    if (!lu.isInvertible() || support <= most) continue;
    most = support;
    best = ManhattanDirections{R_CM, lu.inverse(), {}};
  }
  if (!best) return std::nullopt;
  std::array<int, 3> num_of_axis{};
  for (const LineDirection& direction : directions) {
    int axis = -1;
    double most_belief = 1.0;
    for (int k = 0; k < 3; ++k) {
      double sigma = 0.0;
      const double belief = search.Belief(
          {direction, direction.Normal(), 0.0}, best->R_CM.col(k), &sigma);
      if (belief > most_belief) {
        most_belief = belief;
        axis = k;
      }
    }
    best->axis_of_line.push_back(axis);
    if (axis >= 0) ++num_of_axis[static_cast<std::size_t>(axis)];
  }
  const auto num_seen = std::count_if(
      num_of_axis.begin(), num_of_axis.end(), [](int num) { return num > 0; });
  if (num_seen < 2) return std::nullopt;
  return best;
}

}  // namespace waymark
