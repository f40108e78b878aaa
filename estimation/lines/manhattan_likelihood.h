// How likely it is that the lines of an image run along the axes of a rotation.
#pragma once

#include "estimation/lines/line_direction.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace waymark {

// How a line fits an axis.
struct AxisFit {
  double belief = 0.0;  // How far from chance that it runs along it; else 0.
  double z = 0.0;       // Sigmas off.
  double sigma = 0.0;   // Of across_C' n_C.
};

// A mixture for each line: along one of the three axes, with normal errors, or
// along any direction, as chance has it. Gravity, where it is known, pulls
// against column 2.
class ManhattanLikelihood {
 public:
  // weights: of each line's word, in (0, 1]: pieces of one line share one.
  // model_sigma_rad: of edges against their axis, beside the lines' own errors.
  // inlier_share: of lines along an axis, in (0, 1).
  ManhattanLikelihood(std::vector<LineDirection> lines,
                      std::vector<double> weights,
                      const std::optional<DirectionPrior>& gravity,
                      double model_sigma_rad,
                      double inlier_share);

  // That a line runs along one axis rather than any, times its error in rad.
  [[nodiscard]] static double OddsOf(double inlier_share);

  [[nodiscard]] AxisFit FitOf(const LineDirection& line,
                              const Eigen::Vector3d& n_C) const;
  // The axis a line is closest to, in sigmas; -1 where it is beyond all.
  [[nodiscard]] int ClosestAxis(const LineDirection& line,
                                const Eigen::Matrix3d& R_CM) const;
  // Logarithm of the likelihood over that of chance.
  [[nodiscard]] double Support(const Eigen::Matrix3d& R_CM) const;

  // Toward the nearest maximum, by expectation and maximisation. False where
  // lines leave a turn open.
  [[nodiscard]] bool Climb(Eigen::Matrix3d* R_CM,
                           int max_steps,
                           double converged) const;

  // To the maximum with each line left to the axis it is closest to, so that
  // chance neighbours of two axes bend neither: by Newton's method, damped as
  // far as the likelihood asks for it. Returns the covariance of a turn in C,
  // to first order; nothing where lines leave a turn open.
  [[nodiscard]] std::optional<Eigen::Matrix3d> Settle(
      Eigen::Matrix3d* R_CM) const;

 private:
  // Sums over lines, each with its weight times w, what it counts as one of its
  // axis.
  struct Normal {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();

    void Add(const LineDirection& line,
             const Eigen::Vector3d& n_C,
             const AxisFit& fit,
             double weight);
  };
  // The same, how the pull changes with a turn, and its own error.
  struct Tails : Normal {
    double support = 0.0;
    Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();

    [[nodiscard]] Eigen::Matrix3d Covariance() const;
  };
  // A line and its axis, its error held as it was at one rotation: what Tails
  // are the slope of.
  struct Held {
    int axis = -1;
    double sigma = 0.0;
    double odds = 0.0;
  };

  [[nodiscard]] Tails TailsOf(const Eigen::Matrix3d& R_CM,
                              bool is_free,
                              std::vector<Held>* held) const;
  [[nodiscard]] double Support(const std::vector<Held>& held,
                               const Eigen::Matrix3d& R_CM) const;
  [[nodiscard]] double GravitySupport(const Eigen::Matrix3d& R_CM) const;
  // Returns the information.
  Eigen::Matrix3d AddGravity(const Eigen::Matrix3d& R_CM, Normal* normal) const;

  std::vector<LineDirection> lines_;
  std::vector<double> weights_;
  std::optional<DirectionPrior> gravity_;
  double model_variance_;
  double odds_;
};

}  // namespace waymark
