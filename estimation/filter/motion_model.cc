#include "estimation/filter/motion_model.h"

#include "estimation/geometry/angle.h"

namespace waymark {

MotionPrediction PredictMotion(const RelativeMotion& motion,
                               const Pose2& X_WR0,
                               const Pose2& X_WR1) {
  const Pose2 X_WS0 = X_WR0 * motion.X_RS;
  const Pose2 X_WS1 = X_WR1 * motion.X_RS;
  const ComposeJacobians from = JacobiansOfCompose(X_WR0, motion.X_RS);
  const ComposeJacobians to = JacobiansOfCompose(X_WR1, motion.X_RS);
  const BetweenJacobians between = JacobiansOfBetween(X_WS0, X_WS1);

  MotionPrediction prediction;
  prediction.residual = motion.X_S0S1.vector() - Between(X_WS0, X_WS1).vector();
  prediction.residual(2) = WrapAngle(prediction.residual(2));
  prediction.d_from = between.d_AB * from.d_AB;
  prediction.d_to = between.d_AC * to.d_AB;
  prediction.d_mounting = between.d_AB * from.d_BC + between.d_AC * to.d_BC;
  return prediction;
}

}  // namespace waymark
