#include "estimation/filter/fix_model.h"

#include "estimation/geometry/angle.h"

namespace waymark {

FixPrediction PredictFix(const AbsoluteFix& fix, const Pose2& X_WR) {
  const Pose2 X_WS = X_WR * fix.X_RS;
  const Pose2 X_FS = Between(fix.X_WF, X_WS);
  const Eigen::Matrix3d d_pose = JacobiansOfBetween(fix.X_WF, X_WS).d_AC *
                                 JacobiansOfCompose(X_WR, fix.X_RS).d_AB;

  Eigen::Vector3d residual = fix.value - X_FS.vector();
  residual(2) = WrapAngle(residual(2));
  FixPrediction prediction;
  int index[3];
  int n = 0;
  for (int i = 0; i < 3; ++i) {
    if (fix.has[static_cast<std::size_t>(i)]) index[n++] = i;
  }
  prediction.residual.resize(n);
  prediction.d_pose.resize(n, 3);
  prediction.covariance.resize(n, n);
  for (int i = 0; i < n; ++i) {
    prediction.residual(i) = residual(index[i]);
    prediction.d_pose.row(i) = d_pose.row(index[i]);
    for (int j = 0; j < n; ++j) {
      prediction.covariance(i, j) = fix.covariance(index[i], index[j]);
    }
  }
  return prediction;
}

}  // namespace waymark
