#include "estimation/batch/batch_marginal.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <map>
#include <utility>

namespace waymark {
namespace {

using RowMajorX =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Where a block's columns are: in the poses' part or in the parameters' part.
struct Columns {
  bool is_pose = false;
  std::array<int, 4> column{-1, -1, -1, -1};
};

class Assembler {
 public:
  Assembler(const BatchInput& input, const BatchState& state) {
    columns_[state.wheels.data()] = {false, {0, 1, 2, -1}};
    num_parameters_ = 3;
    for (std::size_t i = 0; i < state.sensors.size(); ++i) {
      const std::array<bool, 4> is_estimated = input.sensors[i].IsEstimated();
      std::array<int, 4> column{-1, -1, -1, -1};
      for (std::size_t k = 0; k < 4; ++k) {
        if (is_estimated[k]) column[k] = num_parameters_++;
      }
      sensor_columns_.push_back(column);
      columns_[state.sensors[i].data()] = {false, column};
    }
    for (const auto& log : state.logs) {
      for (const auto& keyframe : log) {
        columns_[keyframe.pose.data()] = {
            true, {num_poses_, num_poses_ + 1, num_poses_ + 2, -1}};
        num_poses_ += 3;
      }
    }
    H_pp_.setZero(num_parameters_, num_parameters_);
    H_xp_.setZero(num_poses_, num_parameters_);
  }

  void Add(const BatchFactor& factor) {
    const int rows = factor.cost->num_residuals();
    const auto& sizes = factor.cost->parameter_block_sizes();
    Eigen::VectorXd r(rows);
    std::vector<RowMajorX> J;
    std::vector<double*> pointers;
    J.reserve(sizes.size());
    for (const int size : sizes) {
      J.emplace_back(rows, size);
      pointers.push_back(J.back().data());
    }
    if (!factor.cost->Evaluate(
            factor.blocks.data(), r.data(), pointers.data())) {
      return;
    }
    const double weight = WeightOf(factor, r.squaredNorm());
    if (factor.kind != FactorKind::kPrior) {
      // Squared once more, so that a gross outlier vanishes here altogether.
      weighted_squares_ += weight * weight * r.squaredNorm();
      weighted_residuals_ += weight * weight * rows;
    }
    for (std::size_t a = 0; a < J.size(); ++a) {
      for (std::size_t b = 0; b < J.size(); ++b) {
        AddBlock(columns_.at(factor.blocks[a]),
                 columns_.at(factor.blocks[b]),
                 weight * J[a].transpose() * J[b]);
      }
    }
  }

  std::optional<BatchMarginal> Marginal() {
    Eigen::MatrixXd information = H_pp_;
    if (num_poses_ > 0) {
      Eigen::SparseMatrix<double> H_xx(num_poses_, num_poses_);
      H_xx.setFromTriplets(H_xx_.begin(), H_xx_.end());
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H_xx);
      if (solver.info() != Eigen::Success) return std::nullopt;
      information -= H_xp_.transpose() * solver.solve(H_xp_);
    }
    const Eigen::LLT<Eigen::MatrixXd> llt(
        0.5 * (information + information.transpose()));
    if (llt.info() != Eigen::Success || !information.allFinite()) {
      return std::nullopt;
    }
    BatchMarginal marginal;
    marginal.covariance =
        llt.solve(Eigen::MatrixXd::Identity(num_parameters_, num_parameters_));
    marginal.sensor_columns = sensor_columns_;
    marginal.weighted_squares = weighted_squares_;
    marginal.num_residuals = weighted_residuals_;
    return marginal;
  }

 private:
  static double WeightOf(const BatchFactor& factor, double squares) {
    const int rows = factor.cost->num_residuals();
    if (factor.loss == nullptr || rows > 3 || squares <= InlierGate(rows)) {
      return 1.0;
    }
    double rho[3];
    factor.loss->Evaluate(squares, rho);
    return rho[1];
  }

  void AddBlock(const Columns& a,
                const Columns& b,
                const Eigen::MatrixXd& block) {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      const int row = a.column[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < block.cols(); ++j) {
        const int column = b.column[static_cast<std::size_t>(j)];
        if (row < 0 || column < 0) continue;
        if (a.is_pose && b.is_pose) {
          H_xx_.emplace_back(row, column, block(i, j));
        } else if (a.is_pose) {
          H_xp_(row, column) += block(i, j);
        } else if (!b.is_pose) {
          H_pp_(row, column) += block(i, j);
        }
      }
    }
  }

  std::map<const double*, Columns> columns_;
  std::vector<std::array<int, 4>> sensor_columns_;
  int num_poses_ = 0;
  int num_parameters_ = 0;
  double weighted_squares_ = 0.0;
  double weighted_residuals_ = 0.0;
  std::vector<Eigen::Triplet<double>> H_xx_;
  Eigen::MatrixXd H_xp_;
  Eigen::MatrixXd H_pp_;
};

}  // namespace

std::optional<BatchMarginal> ComputeMarginal(
    const BatchInput& input,
    const BatchState& state,
    const std::vector<BatchFactor>& factors) {
  Assembler assembler(input, state);
  for (const BatchFactor& factor : factors) assembler.Add(factor);
  return assembler.Marginal();
}

}  // namespace waymark
