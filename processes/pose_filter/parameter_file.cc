#include "processes/pose_filter/parameter_file.h"

#include "estimation/base/input_error.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/configuration.h"
#include "processes/support/state_file.h"

#include <filesystem>
#include <limits>
#include <vector>

namespace waymark {
namespace {

// The file is YAML and read as strictly as a configuration.
struct Contents {
  std::int64_t utime = 0;
  double k_right = 0.0;
  double k_left = 0.0;
  double wheel_base = 0.0;
  std::vector<double> covariance;
  std::int64_t num_measurements = 0;

  void Describe(Describer& d) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    d.Integer("utime", &utime, 1, kMost, "Newest input used");
    d.Number("k_right", &k_right, kPositive, "m per tick");
    d.Number("k_left", &k_left, kPositive, "m per tick");
    d.Number("wheel_base", &wheel_base, kPositive, "m");
    d.Numbers("covariance", &covariance, 9, "Row-major");
    d.Integer("num_measurements", &num_measurements, 0, kMost, "Behind it");
  }
};

[[noreturn]] void Fail(const std::string& path, const std::string& why) {
  throw InputError(path + ": " + why);
}

}  // namespace

std::optional<OdometryParameters> LoadParameterFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (error) Fail(path, error.message());
    return std::nullopt;
  }
  Contents contents;
  LoadConfigurationFile(path, [&](Describer& d) { contents.Describe(d); });
  if (contents.covariance.empty()) {
    Fail(path, "covariance: 9 numbers are missing");
  }
  odometry_parameters_t message{};
  message.utime = contents.utime;
  message.source = "online";
  message.is_known = 1;
  message.k_right = contents.k_right;
  message.k_left = contents.k_left;
  message.wheel_base = contents.wheel_base;
  std::copy(contents.covariance.begin(),
            contents.covariance.end(),
            message.covariance);
  message.num_measurements = contents.num_measurements;
  std::string reason;
  auto parameters = OdometryParametersFromMessage(message, &reason);
  if (!parameters) Fail(path, reason);
  return parameters;
}

std::string TextOfParameters(const OdometryParameters& parameters) {
  Contents contents;
  contents.utime = Microseconds(parameters.time);
  contents.k_right = parameters.parameters.k_right;
  contents.k_left = parameters.parameters.k_left;
  contents.wheel_base = parameters.parameters.wheel_base;
  for (int i = 0; i < 9; ++i) {
    contents.covariance.push_back(parameters.covariance(i / 3, i % 3));
  }
  contents.num_measurements = parameters.num_measurements;
  return "# Wheel parameters, saved by pose_filter or waymark-refine.\n" +
         PrintConfiguration([&](Describer& d) { contents.Describe(d); });
}

void SaveParameterFile(const std::string& path,
                       const OdometryParameters& parameters) {
  SaveStateFile(path, TextOfParameters(parameters));
}

}  // namespace waymark
