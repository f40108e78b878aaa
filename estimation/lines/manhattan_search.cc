#include "estimation/lines/manhattan_search.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// What two lines say of their axis is that good, rad: edges are allowed twice
// as much beside a proposal.
constexpr double kSearchSigma = 0.015;
constexpr std::size_t kNumBins = 90;  // Of a right angle: a degree each.
constexpr std::size_t kNumAxes = 16;  // Proposed axes that are completed,
constexpr int kNumHeadings = 3;       // by so many headings each.
constexpr double kDistinct = 0.035;   // Of rotations: two degrees.
// Of axes: seven degrees. All that lie near a strong one are strong.
constexpr double kApart = 0.12;

// atan(y / x) for 0 <= y and 0 <= x, to 0.0040: less than half a bin.
double CoarseAngle(double y, double x) {
  const auto octant = [](double r) { return r * (0.7854 + 0.273 * (1.0 - r)); };
  return y <= x ? octant(x > 0.0 ? y / x : 0.0) : 0.5 * kPi - octant(x / y);
}

bool IsSame(const Matrix3d& a, const Matrix3d& b) {
  const Matrix3d cosines = (a.transpose() * b).cwiseAbs();
  return cosines.rowwise().maxCoeff().minCoeff() > std::cos(kDistinct);
}

}  // namespace

ManhattanSearch::ManhattanSearch(std::span<const LineDirection> lines,
                                 double odds)
    : lines_(lines.begin(), lines.end()),
      blocks_((lines.size() + kBlock - 1) / kBlock) {
  normals_.reserve(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const LineDirection& line = lines[i];
    normals_.push_back(line.Normal());
    Block& block = blocks_[i / kBlock];
    const std::size_t lane = i % kBlock;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      block.across[k][lane] = static_cast<float>(line.across_C[at]);
      block.along[k][lane] = static_cast<float>(line.along_C[at]);
    }
    const double variance =
        line.sigma_rad * line.sigma_rad + kSearchSigma * kSearchSigma;
    block.variance_px[lane] = static_cast<float>(line.sigma_px * line.sigma_px);
    block.variance_rad[lane] = static_cast<float>(variance);
    // Lines that know their direction worse than chance are worth nothing.
    block.height[lane] =
        static_cast<float>(std::max(0.0, std::log(odds / std::sqrt(variance))));
  }
}

void ManhattanSearch::HalfSquares(const Block& block,
                                  const Vector3f& n_C,
                                  Lanes* half_squares) {
  const float x = n_C.x();
  const float y = n_C.y();
  const float z = n_C.z();
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float across = block.across[0][i] * x + block.across[1][i] * y +
                         block.across[2][i] * z;
    const float along =
        block.along[0][i] * x + block.along[1][i] * y + block.along[2][i] * z;
    const float variance = block.variance_px[i] * (z * z) +
                           block.variance_rad[i] * (along * along);
    // Not 0 / 0 in lanes without a line.
    (*half_squares)[i] = 0.5F * across * across / (variance + 1e-20F);
  }
}

double ManhattanSearch::Worth(const Vector3d& n_C) const {
  const Vector3f n = n_C.cast<float>();
  Lanes sum{};
  Lanes half_squares;
  for (const Block& block : blocks_) {
    HalfSquares(block, n, &half_squares);
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float worth = block.height[i] - half_squares[i];
      sum[i] += worth > 0.0F ? worth : 0.0F;
    }
  }
  double worth = 0.0;
  for (const float lane : sum) worth += static_cast<double>(lane);
  return worth;
}

double ManhattanSearch::Worth(const Matrix3d& R_CM) const {
  const Matrix3f R = R_CM.cast<float>();
  Lanes sum{};
  std::array<Lanes, 3> half_squares;
  for (const Block& block : blocks_) {
    for (std::size_t k = 0; k < 3; ++k) {
      HalfSquares(block, R.col(static_cast<Eigen::Index>(k)), &half_squares[k]);
    }
    for (std::size_t i = 0; i < kBlock; ++i) {
      float least = half_squares[0][i];
      least = half_squares[1][i] < least ? half_squares[1][i] : least;
      least = half_squares[2][i] < least ? half_squares[2][i] : least;
      const float worth = block.height[i] - least;
      sum[i] += worth > 0.0F ? worth : 0.0F;
    }
  }
  double worth = 0.0;
  for (const float lane : sum) worth += static_cast<double>(lane);
  return worth;
}

Vector3d ManhattanSearch::Polished(Vector3d n_C) const {
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d scatter = Matrix3d::Zero();
    Lanes half_squares;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      HalfSquares(blocks_[b], n_C.cast<float>(), &half_squares);
      for (std::size_t i = 0; i < kBlock; ++i) {
        if (half_squares[i] >= blocks_[b].height[i]) continue;
        const LineDirection& line = lines_[b * kBlock + i];
        const double along = line.along_C.dot(n_C);
        const double variance =
            static_cast<double>(blocks_[b].variance_px[i]) * n_C.z() * n_C.z() +
            static_cast<double>(blocks_[b].variance_rad[i]) * along * along;
        scatter += line.across_C * (line.across_C / variance).transpose();
      }
    }
    Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
    solver.computeDirect(scatter);
    const Vector3d n = solver.eigenvectors().col(0);
    // Of lines through one point alone, or none.
    if (!n.allFinite()) break;
    n_C = n;
  }
  return n_C;
}

std::vector<ManhattanSearch::Axis> ManhattanSearch::Axes(int num_seeds) const {
  std::vector<Axis> all;
  const std::size_t num =
      std::min(lines_.size(), static_cast<std::size_t>(num_seeds));
  for (std::size_t i = 0; i < num; ++i) {
    for (std::size_t j = i + 1; j < num; ++j) {
      const Vector3d n = normals_[i].cross(normals_[j]);
      const double norm = n.norm();
      // Pieces of one line propose nothing.
      if (norm < 0.02) continue;
      all.push_back({n / norm, Worth(Vector3d(n / norm))});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Axis& a, const Axis& b) {
    return a.worth > b.worth;
  });
  std::vector<Axis> axes;
  for (const Axis& axis : all) {
    if (axes.size() == kNumAxes) break;
    const bool is_known =
        std::any_of(axes.begin(), axes.end(), [&](const Axis& other) {
          return std::abs(other.n_C.dot(axis.n_C)) > std::cos(kApart);
        });
    if (!is_known) axes.push_back(axis);
  }
  for (Axis& axis : axes) axis.n_C = Polished(axis.n_C);
  return axes;
}

void ManhattanSearch::Complete(const Vector3d& axis_C,
                               std::vector<Rotation>* found) const {
  const Vector3d e1 = axis_C.unitOrthogonal();
  const Vector3d e2 = axis_C.cross(e1);
  const Vector3f n_C = axis_C.cast<float>();
  std::array<double, kNumBins> bins{};
  Lanes half_squares{};
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const double a = normals_[i].dot(e1);
    const double b = normals_[i].dot(e2);
    // Where the line meets the plane across the axis, modulo a right angle:
    // a cos(h) + b sin(h) = 0.
    const double heading = a * b < 0.0 ? CoarseAngle(std::abs(a), std::abs(b))
                                       : CoarseAngle(std::abs(b), std::abs(a));
    const auto bin = static_cast<std::size_t>(
        heading * (static_cast<double>(kNumBins) / (0.5 * kPi)));
    const std::size_t lane = i % kBlock;
    const Block& block = blocks_[i / kBlock];
    if (lane == 0) HalfSquares(block, n_C, &half_squares);
    // Lines along the axis say nothing of headings about it, and those across
    // it little.
    if (half_squares[lane] < block.height[lane]) continue;
    bins[bin % kNumBins] +=
        static_cast<double>(block.height[lane]) * (a * a + b * b);
  }
  const auto smooth = [&](std::size_t i) {
    return bins[i] + 0.7 * (bins[(i + 1) % kNumBins] +
                            bins[(i + kNumBins - 1) % kNumBins]);
  };
  std::vector<std::pair<double, std::size_t>> peaks;
  for (std::size_t i = 0; i < kNumBins; ++i) {
    const double here = smooth(i);
    if (here > 0.0 && here >= smooth((i + kNumBins - 1) % kNumBins) &&
        here > smooth((i + 1) % kNumBins)) {
      peaks.emplace_back(-here, i);
    }
  }
  std::sort(peaks.begin(), peaks.end());
  if (peaks.size() > kNumHeadings) peaks.resize(kNumHeadings);
  for (const auto& [ignored, bin] : peaks) {
    const double h = (static_cast<double>(bin) + 0.5) * 0.5 * kPi / kNumBins;
    Matrix3d R_CM;
    R_CM.col(0) = std::cos(h) * e1 + std::sin(h) * e2;
    R_CM.col(1) = axis_C.cross(R_CM.col(0));
    R_CM.col(2) = axis_C;
    found->push_back({R_CM, Worth(R_CM)});
  }
}

Matrix3d ManhattanSearch::Polished(Matrix3d R_CM, bool has_axis) const {
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d information = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    std::array<Lanes, 3> half_squares;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Block& block = blocks_[b];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d n = R_CM.col(static_cast<Eigen::Index>(k));
        HalfSquares(block, n.cast<float>(), &half_squares[k]);
      }
      for (std::size_t i = 0; i < kBlock; ++i) {
        std::size_t best = 0;
        if (half_squares[1][i] < half_squares[0][i]) best = 1;
        if (half_squares[2][i] < half_squares[best][i]) best = 2;
        if (half_squares[best][i] >= block.height[i]) continue;
        const LineDirection& line = lines_[b * kBlock + i];
        const Vector3d n = R_CM.col(static_cast<Eigen::Index>(best));
        const double along = line.along_C.dot(n);
        const double variance =
            static_cast<double>(block.variance_px[i]) * n.z() * n.z() +
            static_cast<double>(block.variance_rad[i]) * along * along;
        // across' (turn x n) = turn' (n x across).
        const Vector3d slope = n.cross(line.across_C);
        information += slope * (slope / variance).transpose();
        pull -= slope * (line.across_C.dot(n) / variance);
      }
    }
    if (has_axis) {  // It is known: turns about it alone.
      const Vector3d axis = R_CM.col(2);
      pull = axis * axis.dot(pull);
      information = axis.dot(information * axis) * Matrix3d::Identity();
    }
    const Vector3d turn = information.ldlt().solve(pull);
    // Off its own maximum, or along one axis alone: left as it is.
    if (!turn.allFinite() || turn.norm() > 0.1) break;
    if (turn.norm() > 0.0) {
      R_CM = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * R_CM;
    }
  }
  return R_CM;
}

std::vector<Matrix3d> ManhattanSearch::Propose(
    int num_seeds, const std::optional<Vector3d>& axis_C, int num) const {
  std::vector<Rotation> found;
  if (axis_C) {
    Complete(*axis_C, &found);
  } else {
    for (const Axis& axis : Axes(num_seeds)) Complete(axis.n_C, &found);
  }
  const auto by_worth = [](const Rotation& a, const Rotation& b) {
    return a.worth > b.worth;
  };
  const auto keep_distinct = [&](std::size_t most) {
    std::stable_sort(found.begin(), found.end(), by_worth);
    std::vector<Rotation> distinct;
    for (const Rotation& rotation : found) {
      if (distinct.size() == most) break;
      const bool is_known = std::any_of(
          distinct.begin(), distinct.end(), [&](const Rotation& other) {
            return IsSame(other.R_CM, rotation.R_CM);
          });
      if (!is_known) distinct.push_back(rotation);
    }
    found = std::move(distinct);
  };
  // Three times as many are polished as are wanted: it changes their order.
  keep_distinct(3 * static_cast<std::size_t>(num));
  for (Rotation& rotation : found) {
    rotation.R_CM = Polished(rotation.R_CM, axis_C.has_value());
    rotation.worth = Worth(rotation.R_CM);
  }
  keep_distinct(static_cast<std::size_t>(num));
  std::vector<Matrix3d> rotations;
  for (const Rotation& rotation : found) rotations.push_back(rotation.R_CM);
  return rotations;
}

}  // namespace waymark
