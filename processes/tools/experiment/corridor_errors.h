// How far the estimated pose is off in a corridor, over a run.
#pragma once

#include "estimation/filter/estimate_types.h"
#include "estimation/geometry/pose2.h"
#include "processes/support/local_bus.h"

#include <waymark/odometry_parameters_t.hpp>

#include <Eigen/Core>

#include <optional>
#include <utility>
#include <vector>

namespace waymark {

// Listens to TRUTH, POSE, ODOMETRY and ODOMETRY_PARAMETERS.
class CorridorErrors {
 public:
  struct Errors {
    std::int64_t num = 0;
    double max_y_m = 0.0;
    double max_heading_rad = 0.0;
    double sum_y2 = 0.0;
    double sum_heading2 = 0.0;
    double max_y_sigmas = 0.0;
    double max_heading_sigmas = 0.0;
    [[nodiscard]] double rms_y_m() const;
    [[nodiscard]] double rms_heading_rad() const;
  };

  // `blind_way_m`: where the camera is blind; errors from there to relocate_m
  // behind it count as those of the blind. Outlived by `bus`'s world.
  CorridorErrors(const Pose2& X_WL,
                 const std::optional<Eigen::Vector2d>& blind_way_m,
                 double relocate_m,
                 LocalBus* bus);

  [[nodiscard]] const Errors& seeing() const { return seeing_; }
  [[nodiscard]] const Errors& blind() const { return blind_; }
  // Largest distance of the true robot from the axis, m.
  [[nodiscard]] double max_offset_m() const { return max_offset_m_; }
  // Largest lateral error of dead reckoning from the true start, m.
  [[nodiscard]] double reckoned_m() const { return reckoned_m_; }
  // Of sight, until y was within 3 cm for good; 0 without a blind stretch.
  [[nodiscard]] double relocated_m() const { return relocated_m_; }
  // The newest that pose_filter learned, and all of them with their times.
  [[nodiscard]] const std::vector<OdometryParameters>& learned() const {
    return learned_;
  }

 private:
  void OnPose(const PoseEstimate& estimate);
  void OnReckoned(const PoseEstimate& reckoned);

  Pose2 X_WL_;
  std::optional<Eigen::Vector2d> blind_way_m_;
  double relocate_m_;
  std::optional<Pose2> X_WR_;  // The last TRUTH,
  Time truth_time_;            // its time,
  double way_m_ = 0.0;         // and how far it came.
  Errors seeing_;
  Errors blind_;
  double max_offset_m_ = 0.0;
  double relocated_m_ = 0.0;
  double reckoned_m_ = 0.0;
  std::optional<Pose2> X_WO_;
  std::vector<OdometryParameters> learned_;
};

}  // namespace waymark
