#include "estimation/filter/motion_model.h"

#include "estimation/geometry/angle.h"

#include <cmath>

namespace waymark {

MotionPrediction PredictMotion(const RelativeMotion& motion,
                               const Pose2& X_WR0,
                               const Pose2& X_WR1) {
  const Pose2 X_WS0 = X_WR0 * motion.X_RS;
  const Pose2 X_S0S1 = Between(X_WS0, X_WR1 * motion.X_RS);
  const ComposeJacobians from = JacobiansOfCompose(X_WR0, motion.X_RS);
  const ComposeJacobians to = JacobiansOfCompose(X_WR1, motion.X_RS);

  // Of p_S0S1 = R_WS0^T (p_WS1 - p_WS0) and the difference of the headings.
  const double c = std::cos(X_WS0.heading);
  const double s = std::sin(X_WS0.heading);
  Eigen::Matrix3d d_WS0;
  d_WS0 << -c, -s, X_S0S1.y, s, -c, -X_S0S1.x, 0.0, 0.0, -1.0;
  Eigen::Matrix3d d_WS1;
  d_WS1 << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;

  MotionPrediction prediction;
  prediction.residual = motion.X_S0S1.vector() - X_S0S1.vector();
  prediction.residual(2) = WrapAngle(prediction.residual(2));
  prediction.d_from = d_WS0 * from.d_AB;
  prediction.d_to = d_WS1 * to.d_AB;
  prediction.d_mounting = d_WS0 * from.d_BC + d_WS1 * to.d_BC;
  return prediction;
}

}  // namespace waymark
