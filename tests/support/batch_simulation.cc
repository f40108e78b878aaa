#include "tests/support/batch_simulation.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <Eigen/LU>

#include <cmath>

namespace waymark {
namespace {

Pose2 Disturb(const Pose2& X,
              const BatchSimulationOptions& options,
              Random* random) {
  double sigma_m = options.is_exact ? 0.0 : options.sigma_m;
  double sigma_rad = options.is_exact ? 0.0 : options.sigma_rad;
  if (random->Uniform() < options.outlier_share) {
    sigma_m = options.outlier_m;
    sigma_rad = options.outlier_m;
  }
  const double dx = random->Normal(sigma_m);
  const double dy = random->Normal(sigma_m);
  const double heading = random->Normal(sigma_rad);
  return {X.x + dx, X.y + dy, WrapAngle(X.heading + heading)};
}

Eigen::Matrix3d Covariance(const BatchSimulationOptions& options) {
  return Eigen::Vector3d(options.sigma_m, options.sigma_m, options.sigma_rad)
      .cwiseAbs2()
      .asDiagonal();
}

// 13 states: pose, (k_right, k_left, B), (x, y, yaw, offset), pose at the last
// start of a relative motion.
using State = Eigen::Matrix<double, 13, 13>;

void Update(const Eigen::Matrix<double, 3, 13>& H,
            const Eigen::Matrix3d& R,
            int rows,
            State* P) {
  const Eigen::MatrixXd h = H.topRows(rows);
  const Eigen::MatrixXd S =
      h * *P * h.transpose() + R.topLeftCorner(rows, rows);
  const Eigen::MatrixXd K = *P * h.transpose() * S.inverse();
  const Eigen::MatrixXd A = State::Identity() - K * h;
  // Joseph's form stays positive over thousands of updates.
  *P = A * *P * A.transpose() + K * R.topLeftCorner(rows, rows) * K.transpose();
}

}  // namespace

BatchSimulation SimulateBatch(const BatchSimulationOptions& options,
                              const Driver& driver) {
  BatchSimulation simulation;
  simulation.truth = SimulateDrive(options.drive, driver);
  Random random(options.drive.seed * 7919 + 17);
  const Duration offset = DurationFromSeconds(options.time_offset_s);
  BatchLog& log = simulation.log;
  Pose2 X_WS0;
  Time from;
  for (std::size_t i = 0; i < simulation.truth.size(); ++i) {
    const SimulatedReading& reading = simulation.truth[i];
    log.encoders.push_back({reading.time,
                            static_cast<std::int64_t>(i),
                            std::llround(reading.right_ticks),
                            std::llround(reading.left_ticks)});
    const Pose2 X_WS = reading.X_WR * options.X_RS;
    if (options.fix_every > 0 &&
        i % static_cast<std::size_t>(options.fix_every) == 0) {
      AbsoluteFix fix;
      fix.time = reading.time + offset;
      fix.seq = static_cast<std::int64_t>(log.fixes.size());
      fix.source = options.source;
      fix.has = {true, true, options.has_heading};
      fix.value = Disturb(X_WS, options, &random).vector();
      fix.covariance = Covariance(options);
      fix.X_RS = options.X_RS_nominal;
      log.fixes.push_back(fix);
    }
    if (options.motion_every > 0 &&
        i % static_cast<std::size_t>(options.motion_every) == 0) {
      if (i > 0) {
        RelativeMotion motion;
        motion.from = from + offset;
        motion.time = reading.time + offset;
        motion.seq = static_cast<std::int64_t>(log.motions.size());
        motion.source = options.source;
        motion.X_S0S1 = Disturb(Between(X_WS0, X_WS), options, &random);
        motion.covariance = Covariance(options);
        motion.X_RS = options.X_RS_nominal;
        log.motions.push_back(motion);
      }
      X_WS0 = X_WS;
      from = reading.time;
    }
  }
  return simulation;
}

Driver MixedDriver(double forward) {
  return [=](double t, const Pose2&) {
    // 12 s of each; radius 0.5 m.
    switch (static_cast<int>(t / 12.0) % 4) {
      case 0:
        return DriveCommand{forward, forward / 0.5};
      case 1:
        return DriveCommand{forward, 0.0};
      case 2:
        return DriveCommand{forward, -forward / 0.5};
      default:
        return DriveCommand{forward, 0.2 * forward};
    }
  };
}

Eigen::Matrix<double, 7, 7> CramerRaoBound(
    const BatchSimulationOptions& options,
    const BatchSimulation& simulation,
    const Eigen::Vector3d& prior_sigma,
    const BatchSensorOptions& sensor) {
  State P = State::Zero();
  // The solver's own wide prior on the first pose.
  P.topLeftCorner<3, 3>() =
      Eigen::Vector3d(10.0, 10.0, 10.0).cwiseAbs2().asDiagonal();
  P.diagonal().segment<3>(3) = prior_sigma.cwiseAbs2();
  const double position = sensor.position ? sensor.sigma_position_m : 0.0;
  const double yaw = sensor.yaw ? sensor.sigma_yaw_rad : 0.0;
  const double time = sensor.time_offset ? sensor.sigma_time_offset_s : 0.0;
  P.diagonal().segment<4>(6) =
      Eigen::Vector4d(position, position, yaw, time).cwiseAbs2();
  const Eigen::Matrix3d R = Covariance(options);
  const double period = 1.0 / options.drive.rate_hz;
  const auto& truth = simulation.truth;
  // Derivatives of X_WS by pose and sensor at reading i.
  const auto sensor_at = [&](std::size_t i) {
    Eigen::Matrix<double, 3, 7> d = Eigen::Matrix<double, 3, 7>::Zero();
    const ComposeJacobians compose =
        JacobiansOfCompose(truth[i].X_WR, options.X_RS);
    d.leftCols<3>() = compose.d_AB;
    d.block<3, 3>(0, 3) = compose.d_BC;
    if (i + 1 < truth.size()) {
      // By the ticks: the noise of a step is no velocity that anybody could
      // tell a clock by.
      const Eigen::Vector3d velocity =
          IntegrateTicks({truth[i + 1].right_ticks - truth[i].right_ticks,
                          truth[i + 1].left_ticks - truth[i].left_ticks},
                         options.drive.parameters,
                         options.drive.noise,
                         options.drive.integration)
              .X_R0R1.vector() /
          period;
      d.col(6) = -compose.d_AB *
                 JacobiansOfCompose(truth[i].X_WR, Pose2{}).d_BC * velocity;
    }
    return d;
  };
  std::size_t from = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0) {
      const WheelTicks ticks{truth[i].right_ticks - truth[i - 1].right_ticks,
                             truth[i].left_ticks - truth[i - 1].left_ticks};
      const DriveStep step = IntegrateTicks(ticks,
                                            options.drive.parameters,
                                            options.drive.noise,
                                            options.drive.integration);
      const ComposeJacobians compose =
          JacobiansOfCompose(truth[i - 1].X_WR, step.X_R0R1);
      State F = State::Identity();
      F.block<3, 3>(0, 0) = compose.d_AB;
      F.block<3, 3>(0, 3) = compose.d_BC * step.d_parameters;
      P = F * P * F.transpose();
      P.topLeftCorner<3, 3>() +=
          compose.d_BC * step.covariance * compose.d_BC.transpose();
    }
    const Eigen::Matrix<double, 3, 7> d = sensor_at(i);
    if (options.fix_every > 0 &&
        i % static_cast<std::size_t>(options.fix_every) == 0) {
      Eigen::Matrix<double, 3, 13> H = Eigen::Matrix<double, 3, 13>::Zero();
      H.leftCols<3>() = d.leftCols<3>();
      H.block<3, 4>(0, 6) = d.rightCols<4>();
      Update(H, R, options.has_heading ? 3 : 2, &P);
    }
    if (options.motion_every > 0 &&
        i % static_cast<std::size_t>(options.motion_every) == 0) {
      if (i > 0) {
        const Pose2 X_WS0 = truth[from].X_WR * options.X_RS;
        const BetweenJacobians between =
            JacobiansOfBetween(X_WS0, truth[i].X_WR * options.X_RS);
        const Eigen::Matrix<double, 3, 7> d_from = sensor_at(from);
        Eigen::Matrix<double, 3, 13> H = Eigen::Matrix<double, 3, 13>::Zero();
        H.leftCols<3>() = between.d_AC * d.leftCols<3>();
        H.block<3, 4>(0, 6) = between.d_AC * d.rightCols<4>() +
                              between.d_AB * d_from.rightCols<4>();
        H.rightCols<3>() = between.d_AB * d_from.leftCols<3>();
        Update(H, R, 3, &P);
      }
      // The clone becomes the present pose.
      P.rightCols<3>() = P.leftCols<3>().eval();
      P.bottomRows<3>() = P.topRows<3>().eval();
      from = i;
    }
  }
  return P.block<7, 7>(3, 3);
}

}  // namespace waymark
