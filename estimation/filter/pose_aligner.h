// First pose from a stretch of driving: no start known, any heading.
#pragma once

#include "estimation/filter/fix_model.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/filter/odometry_ekf.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct PoseAlignerOptions {
  int min_fixes = 3;  // Before that a faulty one could not be told.
  int max_fixes = 40;
  // Known where the standard deviations are below these.
  double max_heading_sigma = 0.1;   // rad.
  double max_position_sigma = 1.0;  // m, in the worst direction.
  // True: one direction of the position may stay as uncertain as its prior
  // (lateral measurements only).
  bool allow_partial = false;
  double position_sigma = 100.0;  // Prior about the first position, m.
  // Another heading must be this much less likely (-2 log likelihood).
  double min_separation = 20.0;
};

// Answer of the aligner, or why there is none.
struct Alignment {
  bool is_known = false;
  std::string reason;      // Empty where is_known.
  bool disagrees = false;  // The fixes contradict the wheels or each other.
  Pose2 X_WR;              // Now: after the last motion.
  WheelParameters parameters;
  // As OdometryEkf::covariance().
  OdometryEkf::Matrix6 covariance = OdometryEkf::Matrix6::Zero();
  int num_fixes = 0;  // Used; the others were faulty.
};

// Collects motion and fixes from the first fix on and solves for the pose at
// the first fix and the wheel parameters together: Gauss-Newton from several
// headings, each iteration one Kalman pass over the whole stretch, linearised
// at the path that the last iteration gave. So unlike in an EKF that starts
// with an unknown heading, every Jacobian is taken near the solution. The
// process noise of the wheels is part of the pass. At most a quarter of the
// fixes may disagree; they are left out. Where they are so gross that good ones
// look as faulty, there is no answer.
//
// Copyable, deterministic. Cost of Solve: some 10 ms for 40 fixes along 20 m
// without heading measurements, a tenth with.
class PoseAligner {
 public:
  // `guess` is used only for what the fixes do not measure.
  PoseAligner(const PoseAlignerOptions& options,
              const OdometryEkfOptions& model,
              const WheelParameters& parameters,
              const Eigen::Matrix3d& parameter_covariance,
              const Pose2& guess);

  void AddMotion(const WheelTicks& ticks);
  // False where the fix was not taken: without a heading, and less than 2 cm
  // from the last one. Standing still shows no heading, and would push out the
  // fixes that do. Where it is full, forgets the first fix and every second of
  // the others.
  bool AddFix(const AbsoluteFix& fix);
  // Forgets the first fix, on which the prior rests: a faulty one there cannot
  // be told from the others.
  void DropFirst();
  [[nodiscard]] int num_fixes() const { return static_cast<int>(legs_.size()); }
  [[nodiscard]] Alignment Solve() const;

 private:
  // A fix and the motion since then, until the next fix.
  struct Leg {
    AbsoluteFix fix;
    std::vector<WheelTicks> motion;
  };
  struct Pass;
  [[nodiscard]] Pass RunPass(const Pose2& start,
                             const Eigen::Vector3d& q,
                             const std::vector<char>& used) const;
  [[nodiscard]] std::string Unmeasured(const Pass& pass) const;
  [[nodiscard]] std::optional<Pass> Iterate(double heading) const;
  [[nodiscard]] std::vector<double> StartHeadings() const;
  [[nodiscard]] Pose2 StartPosition(double heading) const;

  PoseAlignerOptions options_;
  OdometryEkfOptions model_;
  Eigen::Vector3d q_;  // Prior of the parameters in kTurn form.
  Eigen::Matrix3d q_covariance_;
  Pose2 guess_;
  std::vector<Leg> legs_;
  double travel_ = 0.0;  // Since the last fix taken, m.
};

}  // namespace waymark
