#include "processes/tools/refine/refine_report.h"

#include "estimation/geometry/angle.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace waymark {
namespace {

constexpr std::array<const char*, 3> kWheels = {
    "k_right", "k_left", "wheel_base"};

std::string SensorLines(const BatchSensor& sensor) {
  std::string text =
      fmt::format("sensor '{}'{}: {} of {} inliers",
                  sensor.source,
                  sensor.log < 0 ? std::string()
                                 : fmt::format(" in log {}", sensor.log + 1),
                  sensor.num_inliers,
                  sensor.num_measurements);
  text += fmt::format(", median residual {:.3g} mm, {:.3g} mrad\n",
                      1e3 * sensor.median_position_m,
                      1e3 * sensor.median_heading_rad);
  constexpr std::array<const char*, 4> kNames = {
      "x, m", "y, m", "yaw, deg", "time offset, s"};
  const Eigen::Vector4d value(
      sensor.X_RS.x, sensor.X_RS.y, sensor.X_RS.heading, sensor.time_offset_s);
  for (int i = 0; i < 4; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!sensor.is_estimated[k]) continue;
    const double unit = i == 2 ? DegreesFromRadians(1.0) : 1.0;
    text += fmt::format("  {:<14} {:>14.6g} {:>11.3g} {:>13.5f}\n",
                        kNames[k],
                        unit * value(i),
                        unit * std::sqrt(sensor.covariance(i, i)),
                        sensor.observability(i));
  }
  return text;
}

nlohmann::json SensorJson(const BatchSensor& sensor) {
  nlohmann::json json;
  json["source"] = sensor.source;
  json["log"] = sensor.log;
  json["sensor_R"] = {sensor.X_RS.x, sensor.X_RS.y, sensor.X_RS.heading};
  json["time_offset_s"] = sensor.time_offset_s;
  json["is_estimated"] = sensor.is_estimated;
  for (int i = 0; i < 4; ++i) {
    json["sigma"].push_back(std::sqrt(sensor.covariance(i, i)));
    json["observability"].push_back(sensor.observability(i));
  }
  json["num_measurements"] = sensor.num_measurements;
  json["num_inliers"] = sensor.num_inliers;
  json["median_position_m"] = sensor.median_position_m;
  json["median_heading_rad"] = sensor.median_heading_rad;
  return json;
}

}  // namespace

std::string RefineTable(const RefineOutcome& outcome) {
  const BatchResult& result = outcome.result;
  std::string text;
  for (const std::string& log : outcome.logs) text += log + "\n";
  text += fmt::format(
      "{}{}{}: {:.2f} m driven, {} measurements used, {} "
      "refused, {} bad messages\n",
      NameOf(result.status),
      result.reason.empty() ? "" : ", ",
      result.reason,
      result.travel_m,
      result.num_measurements,
      result.num_refused,
      outcome.num_bad);
  if (!HasAnswer(result.status)) return text;
  text += fmt::format("  {:<14} {:>14} {:>11} {:>13} {:>14} {:>9}\n",
                      "parameter",
                      "value",
                      "sigma",
                      "observability",
                      "nominal",
                      "change");
  const Eigen::Vector3d value = result.parameters.vector();
  const Eigen::Vector3d nominal = outcome.nominal.vector();
  for (int i = 0; i < 3; ++i) {
    text += fmt::format(
        "  {:<14} {:>14.6g} {:>11.3g} {:>13.5f} {:>14.6g} {:>+8.3f}%\n",
        kWheels[static_cast<std::size_t>(i)],
        value(i),
        std::sqrt(result.covariance(i, i)),
        result.observability(i),
        nominal(i),
        100.0 * (value(i) / nominal(i) - 1.0));
  }
  for (const BatchSensor& sensor : result.sensors) text += SensorLines(sensor);
  text += fmt::format(
      "cost {:.6g} nominal, {:.6g} fitted; inliers {:.1f} %; variance factor "
      "{:.2f}; {} iterations in {} rounds\n",
      outcome.nominal_cost,
      result.final_cost,
      100.0 * result.inlier_share,
      result.variance_factor,
      result.num_iterations,
      result.num_rounds);
  return text;
}

std::string RefineJson(const std::vector<RefineOutcome>& all) {
  nlohmann::json list = nlohmann::json::array();
  for (const RefineOutcome& outcome : all) {
    const BatchResult& result = outcome.result;
    nlohmann::json json;
    json["logs"] = outcome.logs;
    json["status"] = NameOf(result.status);
    json["reason"] = result.reason;
    const Eigen::Vector3d value = result.parameters.vector();
    const Eigen::Vector3d nominal = outcome.nominal.vector();
    for (int i = 0; i < 3; ++i) {
      json["parameters"].push_back(value(i));
      json["nominal"].push_back(nominal(i));
      json["observability"].push_back(result.observability(i));
      for (int j = 0; j < 3; ++j) {
        json["covariance"].push_back(result.covariance(i, j));
      }
    }
    json["sensors"] = nlohmann::json::array();
    for (const BatchSensor& sensor : result.sensors) {
      json["sensors"].push_back(SensorJson(sensor));
    }
    json["nominal_cost"] = outcome.nominal_cost;
    json["final_cost"] = result.final_cost;
    json["num_iterations"] = result.num_iterations;
    json["num_measurements"] = result.num_measurements;
    json["num_refused"] = result.num_refused;
    json["num_bad_messages"] = outcome.num_bad;
    json["inlier_share"] = result.inlier_share;
    json["variance_factor"] = result.variance_factor;
    json["travel_m"] = result.travel_m;
    list.push_back(json);
  }
  return list.dump(2) + "\n";
}

}  // namespace waymark
