#include "processes/pose_filter/pose_filter_config.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

// Open at both ends: certainty leaves no room for measurements.
constexpr Range kProbability{1e-6, 1.0 - 1e-6};

Eigen::Vector3d VectorFrom(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

void PoseFilterConfig::Describe(Describer& d) {
  d.Number("window_s",
           &window_s,
           {0.0, 60.0},
           "Measurements that arrive at most this late still count; "
           "POSE_SETTLED follows after it");
  d.Number("max_ahead_s",
           &max_ahead_s,
           {0.1, 86400.0},
           "A reading this far ahead of all others waits for a second one");
  d.Group(
      "wheels", [&] { DescribeWheels(d); }, "Wheels and their parameters");
  d.Group(
      "start", [&] { DescribeStart(d); }, "First pose, where configured");
  d.Group(
      "noise", [&] { DescribeNoise(d); }, "Error model of the wheels");
  d.Group(
      "gate", [&] { DescribeGate(d); }, "Faulty measurements");
  d.Group(
      "motion", [&] { DescribeMotion(d); }, "Relative motions");
  d.Group(
      "alignment",
      [&] { DescribeAlignment(d); },
      "First pose from measurements alone");
}

void PoseFilterConfig::DescribeStart(Describer& d) {
  d.Numbers("position",
            &start_position,
            2,
            "x and y of the first pose, m; empty: INITIAL_POSE, or "
            "unknown until measurements show it");
  d.Degrees("heading_deg",
            &start_heading,
            {-360.0, 360.0},
            "Heading of the first pose");
  d.Number("position_sigma",
           &start_position_sigma,
           kPositive,
           "Standard deviation of x and of y, m");
  d.Degrees("heading_sigma_deg",
            &start_heading_sigma,
            {1e-3, 45.0},
            "Standard deviation of the heading");
}

void PoseFilterConfig::DescribeAlignment(Describer& d) {
  std::int64_t min_fixes = alignment.min_fixes;
  std::int64_t max_fixes = alignment.max_fixes;
  d.Integer("min_fixes", &min_fixes, 1, 100, "Fixes needed at least");
  d.Integer("max_fixes", &max_fixes, 4, 1000, "Fixes held at most");
  alignment.min_fixes = static_cast<int>(min_fixes);
  alignment.max_fixes = static_cast<int>(max_fixes);
  d.Degrees("max_heading_sigma_deg",
            &alignment.max_heading_sigma,
            {0.01, 30.0},
            "The pose is known once the heading is this sure");
  d.Number("max_position_sigma",
           &alignment.max_position_sigma,
           kPositive,
           "and the position this sure, m");
  d.Number("min_separation",
           &alignment.min_separation,
           kNotNegative,
           "and any other heading this much less likely, -2 log "
           "likelihood");
}

void PoseFilterConfig::DescribeWheels(Describer& d) {
  d.Numbers("nominal",
            &nominal,
            3,
            "k_right m/tick, k_left m/tick, wheel base m; empty: from "
            "ODOMETRY_PARAMETERS with source nominal");
  d.Numbers("nominal_sigma",
            &nominal_sigma,
            3,
            "Standard deviation of each, share of its value, where none "
            "comes with it");
  d.Choice<ParameterUse>(
      "use",
      &use,
      {{"own", ParameterUse::kOwn}, {"batch", ParameterUse::kBatch}},
      "Estimate the parameters online, or adopt "
      "ODOMETRY_PARAMETERS with source batch");
  d.Text("parameters_file",
         &parameters_file,
         "Learned parameters are loaded from and saved to this file; empty: "
         "neither");
  d.Number("parameters_period_s",
           &parameters_period_s,
           {0.01, 3600.0},
           "Period of ODOMETRY_PARAMETERS with source online");
  d.Number("max_wheel_speed",
           &max_wheel_speed,
           kPositive,
           "A faster count is an encoder jump, m/s");
  d.Number("jitter_s",
           &jitter_s,
           kNotNegative,
           "How wrong the time between two readings may be");
}

void PoseFilterConfig::DescribeNoise(Describer& d) {
  d.Number("wheel_variance",
           &wheel_variance,
           kNotNegative,
           "Variance of a wheel's travel per metre, m^2/m");
  d.Number("base_variance",
           &base_variance,
           kNotNegative,
           "Variance of the wheel base of a step times its travel, m^3");
  d.Numbers("walk_per_sqrt_metre",
            &walk_per_sqrt_metre,
            3,
            "Random walk of k_right, k_left, base, share per root metre");
  d.Numbers("walk_per_sqrt_second",
            &walk_per_sqrt_second,
            3,
            "Random walk of k_right, k_left, base, share per root second");
  d.Choice<ParameterForm>(
      "form",
      &form,
      {{"turn", ParameterForm::kTurn}, {"travel", ParameterForm::kTravel}},
      "State as turn rates and mean travel, or k_right, "
      "k_left, base as published");
  d.Choice<DriveIntegration>("integration",
                             &integration,
                             {{"arc", DriveIntegration::kArc},
                              {"midpoint", DriveIntegration::kMidpoint}},
                             "Path between two readings");
}

void PoseFilterConfig::DescribeGate(Describer& d) {
  d.Number("min_regular",
           &gate.min_regular,
           kProbability,
           "A measurement is fused where it is regular with at least this "
           "probability");
  d.Number("prior_regular",
           &gate.prior_regular,
           kProbability,
           "Share of regular measurements");
  d.Number("faulty_position_sigma",
           &gate.faulty_position_sigma,
           kPositive,
           "Error of a faulty position, m");
  d.Degrees("faulty_heading_sigma_deg",
            &gate.faulty_heading_sigma,
            {1.0, 180.0},
            "Error of a faulty heading");
  d.Integer("relocalise_after",
            &relocalise_after,
            3,
            1000,
            "So many rejected fixes that agree with one another and with the "
            "wheels make the filter start anew from them");
}

void PoseFilterConfig::DescribeMotion(Describer& d) {
  d.Number("mounting_position_sigma",
           &mounting_position_sigma,
           kNotNegative,
           "Error of the stated place of the sensor on the robot, m");
  d.Degrees("mounting_yaw_sigma_deg",
            &mounting_yaw_sigma,
            {0.0, 45.0},
            "Error of its stated yaw");
  d.Integer("max_at_once",
            &max_motions,
            1,
            100,
            "Motions whose start is kept at once");
  d.Integer("max_sensors",
            &max_sensors,
            1,
            100,
            "Sensors of which the mounting is estimated");
  d.Integer("doubt_after",
            &doubt_after,
            2,
            1000,
            "So many rejected motions in a row double the standard deviations "
            "of the wheel parameters");
}

void PoseFilterConfig::Check() const {
  const auto refuse = [](const char* why) { throw std::invalid_argument(why); };
  if (!nominal.empty() &&
      *std::min_element(nominal.begin(), nominal.end()) <= 0.0) {
    refuse("wheels.nominal: all three must be positive");
  }
  if (*std::min_element(nominal_sigma.begin(), nominal_sigma.end()) <= 0.0) {
    refuse("wheels.nominal_sigma: all three must be positive");
  }
  for (const auto* walk : {&walk_per_sqrt_metre, &walk_per_sqrt_second}) {
    if (*std::min_element(walk->begin(), walk->end()) < 0.0) {
      refuse("noise.walk_per_sqrt_metre and _second: none may be negative");
    }
  }
  gate.Check();
  if (alignment.max_fixes < 2 * alignment.min_fixes) {
    refuse("alignment.max_fixes: must be at least twice min_fixes");
  }
}

DelayedFusionOptions PoseFilterConfig::Options() const {
  DelayedFusionOptions options;
  options.window_s = window_s;
  options.max_ahead_s = max_ahead_s;
  OdometryFilterOptions& filter = options.filter;
  filter.ekf.noise = {wheel_variance, base_variance};
  filter.ekf.integration = integration;
  filter.ekf.form = form;
  filter.ekf.walk = {VectorFrom(walk_per_sqrt_metre),
                     VectorFrom(walk_per_sqrt_second)};
  filter.gate = gate;
  filter.ekf.mounting_position_sigma = mounting_position_sigma;
  filter.ekf.mounting_yaw_sigma = mounting_yaw_sigma;
  filter.max_clones = static_cast<int>(max_motions);
  filter.max_mountings = static_cast<int>(max_sensors);
  filter.doubt_after = static_cast<int>(doubt_after);
  filter.counter.jitter_s = jitter_s;
  filter.alignment = alignment;
  if (!nominal.empty()) {
    filter.parameters = WheelParameters::FromVector(VectorFrom(nominal));
  }
  filter.parameter_sigma = VectorFrom(nominal_sigma);
  filter.adopt_batch = use == ParameterUse::kBatch;
  filter.max_wheel_speed = max_wheel_speed;
  filter.relocalise_after = static_cast<int>(relocalise_after);
  if (!start_position.empty()) {
    InitialPose start;
    start.source = "configuration";
    start.X_WR = {
        start_position[0], start_position[1], WrapAngle(start_heading)};
    start.covariance.diagonal() << std::pow(start_position_sigma, 2),
        std::pow(start_position_sigma, 2), std::pow(start_heading_sigma, 2);
    filter.start = start;
  }
  return options;
}

}  // namespace waymark
