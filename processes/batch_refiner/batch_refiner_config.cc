#include "processes/batch_refiner/batch_refiner_config.h"

#include <algorithm>
#include <stdexcept>

namespace waymark {

BatchSolverConfig::BatchSolverConfig() {
  // Recordings do not know their true noise; figures of an online estimate
  // beside this one have the same default.
  options.noise = {.wheel_variance = 1e-4, .base_variance = 1e-6};
  options.scale_covariance = true;
}

void BatchSolverConfig::Describe(Describer& d) {
  d.Numbers("sigma_share",
            &sigma_share,
            3,
            "Prior sigma of k_right, k_left and wheel base, share of each");
  d.Group(
      "sensor",
      [&] {
        d.Flag("position", &calibrate_position, "Estimate where it sits");
        d.Flag("yaw", &calibrate_yaw, "Estimate which way it faces");
        d.Flag("time_offset",
               &calibrate_time_offset,
               "Estimate its clock minus that of the encoders");
      },
      "Mounting of the sensors that measure");
  d.Group(
      "noise",
      [&] {
        d.Number("wheel_variance",
                 &options.noise.wheel_variance,
                 kNotNegative,
                 "Variance of a wheel's travel per metre, m^2/m");
        d.Number("base_variance",
                 &options.noise.base_variance,
                 kNotNegative,
                 "Variance of the wheel base of a step times its travel, m^3");
        d.Number("tick_sigma",
                 &options.tick_sigma,
                 kNotNegative,
                 "Error of one reading, ticks");
      },
      "Error model of the wheels");
  const std::vector<std::pair<std::string, BatchLoss>> losses{
      {"none", BatchLoss::kNone},
      {"huber", BatchLoss::kHuber},
      {"cauchy", BatchLoss::kCauchy}};
  d.Choice<BatchLoss>(
      "loss", &options.loss, losses, "Robust loss on measurements");
  d.Choice<BatchLoss>("odometry_loss",
                      &options.odometry_loss,
                      losses,
                      "Robust loss on steps between them, for slipping wheels");
  d.Number("loss_scale",
           &options.loss_scale,
           kPositive,
           "Where the loss bends, in sigmas per root component");
  d.Number("keyframe_s",
           &options.keyframe_s,
           kNotNegative,
           "Measurements this close share one pose, s");
  d.Flag("scale_covariance",
         &options.scale_covariance,
         "Widen sigmas where residuals are larger than stated");
  d.Number("min_observability",
           &options.min_observability,
           {1e-3, 1.0 - 1e-6},
           "A parameter counts as observable from this figure on");
}

void BatchSolverConfig::Check() const {
  if (*std::min_element(sigma_share.begin(), sigma_share.end()) <= 0.0) {
    throw std::invalid_argument("sigma_share: all three must be positive");
  }
}

BatchOptions BatchSolverConfig::Options(const WheelParameters& nominal,
                                        bool shared_mounting) const {
  BatchOptions result = options;
  result.initial = nominal;
  result.relative_sigma = {sigma_share[0], sigma_share[1], sigma_share[2]};
  BatchSensorOptions sensor;
  sensor.position = calibrate_position;
  sensor.yaw = calibrate_yaw;
  sensor.time_offset = calibrate_time_offset;
  sensor.shared = shared_mounting;
  result.sensors = {sensor};
  return result;
}

void BatchRefinerConfig::Describe(Describer& d) {
  d.Number("window_s",
           &window.window_s,
           {1.0, 86400.0},
           "Length of the window that is solved");
  d.Number("period_s",
           &period_s,
           {0.1, 86400.0},
           "Event time between two solutions");
  std::int64_t max_readings = window.max_readings;
  std::int64_t max_measurements = window.max_measurements;
  d.Integer("max_readings",
            &max_readings,
            100,
            10'000'000,
            "Readings kept at most; the oldest go");
  d.Integer("max_measurements",
            &max_measurements,
            10,
            1'000'000,
            "Fixes, and relative motions, kept at most; the oldest go");
  window.max_readings = static_cast<int>(max_readings);
  window.max_measurements = static_cast<int>(max_measurements);
  d.Numbers("nominal",
            &nominal,
            3,
            "k_right m/tick, k_left m/tick, wheel base m; empty: from "
            "ODOMETRY_PARAMETERS with source nominal");
  d.Number("max_wheel_speed",
           &max_wheel_speed,
           kPositive,
           "A faster count is an encoder jump, m/s");
  d.Group(
      "solver", [&] { solver.Describe(d); }, "The batch problem");
}

void BatchRefinerConfig::Check() const {
  window.Check();
  if (!nominal.empty() &&
      *std::min_element(nominal.begin(), nominal.end()) <= 0.0) {
    throw std::invalid_argument("nominal: all three must be positive");
  }
  solver.Check();
}

}  // namespace waymark
