// Extended Kalman filter over pose and wheel parameters.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "estimation/filter/drive_parameters.h"
#include "estimation/filter/fix_model.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <string>

namespace waymark {

// Random walk of each parameter, as a fraction of its value: sigma per square
// root of a metre of travel and of a second. Order (k_right, k_left, B).
struct ParameterWalk {
  Eigen::Vector3d per_sqrt_metre = Eigen::Vector3d::Zero();
  Eigen::Vector3d per_sqrt_second = Eigen::Vector3d::Zero();
};

struct OdometryEkfOptions {
  DriveNoise noise;
  DriveIntegration integration = DriveIntegration::kArc;
  ParameterForm form = ParameterForm::kTurn;
  // False: the parameters keep their values; their uncertainty still counts
  // (Schmidt's consider filter).
  bool estimate_parameters = true;
  ParameterWalk walk;
};

// Expected measurement and its uncertainty before an update.
struct Innovation {
  FixVector residual;
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 3, 6> H;
  FixMatrix R;
  FixMatrix HPH;  // S = HPH + R.
};

// State (x, y, heading, parameters) of equation 5 [1], written in `form`.
// After each step the state must be finite, the covariance symmetric and
// positive semidefinite, the parameters positive. Where they are not, the
// filter stops with a fault: the state stays what it was, and Predict and
// Update do nothing from then on.
//
// Copyable, deterministic, no heap but for the text of a fault.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
class OdometryEkf {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  // Covariances may be singular: zero is exactly known.
  OdometryEkf(const OdometryEkfOptions& options,
              const Pose2& X_WR,
              const Eigen::Matrix3d& pose_covariance,
              const WheelParameters& parameters,
              const Eigen::Matrix3d& parameter_covariance);
  // With correlations; `covariance` is of (x, y, heading, k_right, k_left, B).
  OdometryEkf(const OdometryEkfOptions& options,
              const Pose2& X_WR,
              const WheelParameters& parameters,
              const Matrix6& covariance);

  // Ticks and time since the last step.
  void Predict(const WheelTicks& ticks, double seconds);
  // Motion that nothing measured: adds to the covariance of the pose.
  void AddPoseNoise(const Eigen::Matrix3d& covariance);
  [[nodiscard]] Innovation Innovate(const AbsoluteFix& fix) const;
  // Joseph form. The gate is the caller's business.
  void Update(const AbsoluteFix& fix);

  // A new start; parameters and their uncertainty stay.
  void SetPose(const Pose2& X_WR, const Eigen::Matrix3d& covariance);
  // Parameters from elsewhere; the pose stays, its correlation with them goes.
  void SetParameters(const WheelParameters& parameters,
                     const Eigen::Matrix3d& covariance);

  [[nodiscard]] const Pose2& X_WR() const { return X_WR_; }
  [[nodiscard]] Eigen::Matrix3d pose_covariance() const {
    return P_.topLeftCorner<3, 3>();
  }
  [[nodiscard]] WheelParameters parameters() const {
    return ParametersFromForm(q_, options_.form);
  }
  // Of (k_right, k_left, B), to first order.
  [[nodiscard]] Eigen::Matrix3d parameter_covariance() const;
  // Of (x, y, heading, k_right, k_left, B), to first order.
  [[nodiscard]] Matrix6 covariance() const;
  // Per parameter 1 - variance / the variance it would have had without
  // measurements (that of the last SetParameters plus the random walk since);
  // 0 where that is 0. Clamped to [0, 1].
  [[nodiscard]] Eigen::Vector3d observability() const;
  // What observability compares with; for a filter that continues another.
  [[nodiscard]] const Eigen::Vector3d& prior_variances() const {
    return prior_variances_;
  }
  void set_prior_variances(const Eigen::Vector3d& variances) {
    prior_variances_ = variances;
  }
  // Empty: healthy.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  void Accept(const Pose2& X_WR,
              const Eigen::Vector3d& q,
              const Matrix6& P,
              const char* step);

  OdometryEkfOptions options_;
  Pose2 X_WR_;
  Eigen::Vector3d q_;  // Parameters in the form.
  Matrix6 P_ = Matrix6::Zero();
  Eigen::Vector3d prior_variances_;  // Of (k_right, k_left, B).
  std::string fault_;
};

// Why `P` is no covariance ("" if it is): not finite, not symmetric or with
// a negative eigenvalue, both to 1e-6 after scaling to unit diagonal.
[[nodiscard]] std::string CovarianceFault(const OdometryEkf::Matrix6& P);

}  // namespace waymark
