// Extended Kalman filter over pose and wheel parameters.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "estimation/filter/drive_parameters.h"
#include "estimation/filter/fix_model.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/filter/motion_model.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

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
  // Error of the stated mounting of sensors that measure motion, as a ruler
  // and the eye leave it. Estimated for each sensor; both 0: taken as exact.
  double mounting_position_sigma = 0.01;  // m, per axis.
  double mounting_yaw_sigma = RadiansFromDegrees(2.0);
};

// Expected measurement and its uncertainty before an update.
struct Innovation {
  FixVector residual;
  // By the state. Of a fix only.
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
// Relative motions are fused by stochastic cloning [2]: the pose at the start
// of a motion is kept beside the state, with its correlations, until the motion
// is known. So is, for good, how the sensor's mounting differs from what its
// messages state: a few millimetres look like a wheel that is too large, motion
// after motion, which no noise would describe.
//
// Copyable, deterministic, no heap but for relative motions and the text of a
// fault.
//
// [1] E. Bayramoglu et al. Mobile robot navigation in a corridor using visual
//     odometry. ICAR 2009.
// [2] S. I. Roumeliotis, J. W. Burdick. Stochastic cloning: a generalized
//     framework for processing relative state measurements. ICRA 2002.
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

  // Keeps the pose of `now` as the start of a motion that ends at `until`; one
  // pose serves all motions that start at that time.
  void AddClone(Time now, Time until);
  // Forgets the starts of motions that ended before `now`.
  void DropClones(Time now);
  [[nodiscard]] bool HasClone(Time time) const;
  [[nodiscard]] int num_clones() const;
  // The mounting of the sensor of this name is estimated from now on.
  void AddMounting(const std::string& source);
  [[nodiscard]] bool HasMounting(const std::string& source) const;
  [[nodiscard]] int num_mountings() const;
  // X_RS minus what is stated, as (x, y, yaw). Needs HasMounting.
  [[nodiscard]] Eigen::Vector3d mounting_error(const std::string& source) const;
  // Both need HasClone(motion.from), and take the mounting as exact unless
  // HasMounting(motion.source). The motion ends at the state's pose.
  [[nodiscard]] Innovation Innovate(const RelativeMotion& motion) const;
  void Update(const RelativeMotion& motion);
  // Multiplies the standard deviations of the parameters, but lets none exceed
  // `max_share` of its value.
  void WidenParameters(double factor, double max_share);

  // A new start: clones are forgotten; parameters and their uncertainty stay.
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
  // What is estimated beside the state: a clone or a mounting.
  struct Extra {
    bool is_clone = false;
    Time time;                                        // Of a clone.
    Time until;                                       // Of a clone.
    std::string source;                               // Of a mounting.
    Eigen::Vector3d value = Eigen::Vector3d::Zero();  // X_WR; mounting error.
  };
  using JointMatrix = Eigen::MatrixXd;  // Of the state, then of the extras.
  // Nullptr: none.
  [[nodiscard]] const Extra* FindClone(Time time) const;
  [[nodiscard]] const Extra* FindMounting(const std::string& source) const;
  [[nodiscard]] Eigen::Index ColumnOf(const Extra* extra) const;
  void AddExtra(const Extra& extra,
                const Eigen::Matrix<double, 6, 3>& with_state,
                const Eigen::MatrixXd& with_others,
                const Eigen::Matrix3d& covariance);
  void KeepExtras(const std::function<bool(const Extra&)>& is_kept);
  [[nodiscard]] JointMatrix JointCovariance() const;
  [[nodiscard]] Innovation InnovateJoint(const RelativeMotion& motion,
                                         const JointMatrix& P,
                                         JointMatrix* H) const;
  void UpdateJoint(const Innovation& v,
                   const JointMatrix& H,
                   const JointMatrix& P);
  void Accept(const Pose2& X_WR,
              const Eigen::Vector3d& q,
              const Matrix6& P,
              const char* step);

  OdometryEkfOptions options_;
  Pose2 X_WR_;
  Eigen::Vector3d q_;  // Parameters in the form.
  Matrix6 P_ = Matrix6::Zero();
  std::vector<Extra> extras_;
  Eigen::MatrixXd cross_;  // Covariance of the state with extras, 6 x 3n.
  Eigen::MatrixXd among_;  // Covariance of the extras, 3n x 3n.
  Eigen::Vector3d prior_variances_;  // Of (k_right, k_left, B).
  std::string fault_;
};

// Why `P` is no covariance ("" if it is): not finite, not symmetric or with
// a negative eigenvalue, both to 1e-6 after scaling to unit diagonal.
[[nodiscard]] std::string CovarianceFault(const OdometryEkf::Matrix6& P);

}  // namespace waymark
