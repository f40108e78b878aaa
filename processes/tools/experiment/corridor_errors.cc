#include "processes/tools/experiment/corridor_errors.h"

#include "estimation/geometry/angle.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"

#include <waymark/pose_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace waymark {
namespace {

constexpr double kRelocatedM = 0.03;  // As published, Y19.

// y and heading of R in L, and their sigmas, from a pose in W.
Eigen::Vector2d SigmasIn(const Pose2& X_WL, const Eigen::Matrix3d& P_WR) {
  const Eigen::Vector2d across(-std::sin(X_WL.heading), std::cos(X_WL.heading));
  return {
      std::sqrt(across.dot(P_WR.topLeftCorner<2, 2>() * across)),
      std::sqrt(P_WR(2, 2)),
  };
}

void Add(const Eigen::Vector2d& error,
         const Eigen::Vector2d& sigma,
         CorridorErrors::Errors* errors) {
  const Eigen::Vector2d size = error.cwiseAbs();
  ++errors->num;
  errors->max_y_m = std::max(errors->max_y_m, size(0));
  errors->max_heading_rad = std::max(errors->max_heading_rad, size(1));
  errors->sum_y2 += size(0) * size(0);
  errors->sum_heading2 += size(1) * size(1);
  // A start that is exactly known has no sigma.
  for (int i = 0; i < 2; ++i) {
    if (sigma(i) == 0.0) continue;
    double& most = i == 0 ? errors->max_y_sigmas : errors->max_heading_sigmas;
    most = std::max(most, size(i) / sigma(i));
  }
}

double Rms(double sum, std::int64_t num) {
  return num > 0 ? std::sqrt(sum / static_cast<double>(num)) : 0.0;
}

}  // namespace

double CorridorErrors::Errors::rms_y_m() const {
  return Rms(sum_y2, num);
}

double CorridorErrors::Errors::rms_heading_rad() const {
  return Rms(sum_heading2, num);
}

CorridorErrors::CorridorErrors(
    const Pose2& X_WL,
    const std::optional<Eigen::Vector2d>& blind_way_m,
    double relocate_m,
    LocalBus* bus)
    : X_WL_(X_WL), blind_way_m_(blind_way_m), relocate_m_(relocate_m) {
  bus->bus()->Subscribe<truth_t>(
      kTruth, Keep::All(), [this](const truth_t& truth, Time time) {
        const Pose2 X_WR{truth.x, truth.y, truth.heading};
        if (X_WR_) way_m_ += (X_WR.position() - X_WR_->position()).norm();
        X_WR_ = X_WR;
        truth_time_ = time;
      });
  bus->bus()->Subscribe<pose_t>(
      kPose, Keep::All(), [this](const pose_t& message, Time) {
        std::string reason;
        const auto estimate = PoseEstimateFromMessage(message, &reason);
        if (estimate && estimate->is_known) OnPose(*estimate);
      });
  bus->bus()->Subscribe<pose_t>(
      kOdometry, Keep::All(), [this](const pose_t& message, Time) {
        std::string reason;
        const auto reckoned = PoseEstimateFromMessage(message, &reason);
        if (reckoned && reckoned->is_known) OnReckoned(*reckoned);
      });
  bus->bus()->Subscribe<odometry_parameters_t>(
      kOdometryParameters,
      Keep::All(),
      [this](const odometry_parameters_t& message, Time) {
        std::string reason;
        const auto values = OdometryParametersFromMessage(message, &reason);
        if (values && values->is_known && values->source == "online") {
          learned_.push_back(*values);
        }
      });
}

void CorridorErrors::OnReckoned(const PoseEstimate& reckoned) {
  if (!X_WR_ || reckoned.time != truth_time_) return;
  if (!X_WO_) X_WO_ = *X_WR_ * Inverse(reckoned.X_WR);
  const double error =
      Between(X_WL_, *X_WO_ * reckoned.X_WR).y - Between(X_WL_, *X_WR_).y;
  reckoned_m_ = std::max(reckoned_m_, std::abs(error));
}

void CorridorErrors::OnPose(const PoseEstimate& estimate) {
  if (!X_WR_ || estimate.time != truth_time_) return;
  const Pose2 X_LR = Between(X_WL_, *X_WR_);
  const Pose2 estimated_LR = Between(X_WL_, estimate.X_WR);
  const Eigen::Vector2d error(estimated_LR.y - X_LR.y,
                              WrapAngle(estimated_LR.heading - X_LR.heading));
  max_offset_m_ = std::max(max_offset_m_, std::abs(X_LR.y));
  const bool is_blind = blind_way_m_ && way_m_ >= (*blind_way_m_)(0) &&
                        way_m_ < (*blind_way_m_)(1) + relocate_m_;
  Add(error,
      SigmasIn(X_WL_, estimate.covariance),
      is_blind ? &blind_ : &seeing_);
  if (blind_way_m_ && way_m_ >= (*blind_way_m_)(1) &&
      std::abs(error(0)) > kRelocatedM) {
    relocated_m_ = way_m_ - (*blind_way_m_)(1);
  }
}

}  // namespace waymark
