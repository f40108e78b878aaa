#include "estimation/batch/batch_types.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace waymark {
namespace {

void Require(bool holds,
             const std::string& field,
             double value,
             const char* range) {
  if (holds) return;
  std::ostringstream out;
  out << "batch: " << field << " = " << value << " is not " << range;
  throw std::invalid_argument(out.str());
}

void RequirePositive(const std::string& field, double value) {
  Require(value > 0.0 && std::isfinite(value), field, value, "above 0");
}

void RequireNotNegative(const std::string& field, double value) {
  Require(value >= 0.0 && std::isfinite(value), field, value, "0 or above");
}

}  // namespace

void BatchOptions::Check() const {
  RequirePositive("initial.k_right", initial.k_right);
  RequirePositive("initial.k_left", initial.k_left);
  RequirePositive("initial.wheel_base", initial.wheel_base);
  for (int i = 0; i < 3; ++i) {
    RequirePositive("relative_sigma", relative_sigma(i));
  }
  RequireNotNegative("noise.wheel_variance", noise.wheel_variance);
  RequireNotNegative("noise.base_variance", noise.base_variance);
  RequireNotNegative("tick_sigma", tick_sigma);
  RequirePositive("slip_sigma_m", slip_sigma_m);
  RequirePositive("loss_scale", loss_scale);
  RequireNotNegative("keyframe_s", keyframe_s);
  RequirePositive("max_iterations", max_iterations);
  RequirePositive("max_rounds", max_rounds);
  RequireNotNegative("min_travel_m", min_travel_m);
  Require(min_observability > 0.0 && min_observability < 1.0,
          "min_observability",
          min_observability,
          "between 0 and 1");
  for (const BatchSensorOptions& sensor : sensors) {
    const std::string name = "sensor '" + sensor.source + "' ";
    RequirePositive(name + "sigma_position_m", sensor.sigma_position_m);
    RequirePositive(name + "sigma_yaw_rad", sensor.sigma_yaw_rad);
    RequirePositive(name + "sigma_time_offset_s", sensor.sigma_time_offset_s);
    Require(std::isfinite(sensor.time_offset_s),
            name + "time_offset_s",
            sensor.time_offset_s,
            "finite");
  }
}

const char* NameOf(BatchStatus status) {
  switch (status) {
    case BatchStatus::kSolved:
      return "solved";
    case BatchStatus::kPartly:
      return "partly observable";
    case BatchStatus::kNotObservable:
      return "not observable";
    case BatchStatus::kNoData:
      return "no data";
    case BatchStatus::kTooLittleMotion:
      return "too little motion";
    case BatchStatus::kNotConverged:
      return "not converged";
    case BatchStatus::kImplausible:
      return "implausible";
  }
  return "unknown";
}

bool HasAnswer(BatchStatus status) {
  return status == BatchStatus::kSolved || status == BatchStatus::kPartly;
}

}  // namespace waymark
