#include "processes/tools/experiment/corridor_learned.h"

#include "estimation/filter/posterior_bound.h"

#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

WheelParameters TrueWheels(const RobotOptions& robot) {
  return {robot.meters_per_tick * robot.right_wheel_factor,
          robot.meters_per_tick * robot.left_wheel_factor,
          robot.wheel_base * robot.wheel_base_factor};
}

}  // namespace

LearnedWheels LearnedOf(const std::vector<OdometryParameters>& all,
                        const RobotOptions& robot) {
  LearnedWheels learned;
  const WheelParameters wheels = TrueWheels(robot);
  const double ratio = wheels.k_right / wheels.k_left;
  const double base = wheels.wheel_base;
  constexpr double kClose = 0.01;
  for (const OdometryParameters& p : all) {
    const double ratio_error =
        p.parameters.k_right / p.parameters.k_left / ratio - 1.0;
    const double base_error = p.parameters.wheel_base / base - 1.0;
    const auto num = static_cast<double>(p.num_measurements);
    if (std::abs(ratio_error) > kClose) learned.num_to_ratio = num;
    if (std::abs(base_error) > kClose) learned.num_to_base = num;
    learned.ratio_error = ratio_error;
    learned.base_error = base_error;
    learned.ratio_sigmas = ratio_error * ratio /
                           std::sqrt(RatioVariance(p.parameters, p.covariance));
    learned.base_sigmas = base_error * base / std::sqrt(p.covariance(2, 2));
  }
  return learned;
}

WheelBound BoundOf(const CorridorBound& run,
                   const PoseFilterConfig& filter,
                   const RobotOptions& robot) {
  const WheelParameters wheels = TrueWheels(robot);
  PosteriorBound::Matrix6 prior = PosteriorBound::Matrix6::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double sigma = filter.nominal_sigma[k] * filter.nominal[k];
    prior(3 + i, 3 + i) = sigma * sigma;
  }
  PosteriorBound bound(wheels,
                       {robot.wheel_variance, robot.base_variance},
                       DriveIntegration::kArc,
                       prior);
  run.Follow(&bound);
  const Eigen::Matrix3d P = bound.parameter_covariance();
  return {std::sqrt(RatioVariance(wheels, P)) * wheels.k_left / wheels.k_right,
          std::sqrt(P(2, 2)) / wheels.wheel_base};
}

}  // namespace waymark
