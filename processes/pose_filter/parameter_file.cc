#include "processes/pose_filter/parameter_file.h"

#include "estimation/base/input_error.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/configuration.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
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

std::string CannotBeWritten(int error) {
  return std::string("cannot be written: ") + std::strerror(error);
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

void CheckParameterFolder(const std::string& path) {
  const auto folder = std::filesystem::absolute(path).parent_path();
  if (::access(folder.c_str(), W_OK) != 0) {
    Fail(path, CannotBeWritten(errno));
  }
}

void SaveParameterFile(const std::string& path,
                       const OdometryParameters& parameters) {
  Contents contents;
  contents.utime = Microseconds(parameters.time);
  contents.k_right = parameters.parameters.k_right;
  contents.k_left = parameters.parameters.k_left;
  contents.wheel_base = parameters.parameters.wheel_base;
  for (int i = 0; i < 9; ++i) {
    contents.covariance.push_back(parameters.covariance(i / 3, i % 3));
  }
  contents.num_measurements = parameters.num_measurements;
  const std::string text =
      "# Wheel parameters, saved by pose_filter or waymark-refine.\n" +
      PrintConfiguration([&](Describer& d) { contents.Describe(d); });

  const std::string beside = path + ".new";
  const int file =
      ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) Fail(path, CannotBeWritten(errno));
  // Synced before the rename: after a power cut the name must not point to
  // an empty file.
  const bool written = ::write(file, text.data(), text.size()) ==
                           static_cast<ssize_t>(text.size()) &&
                       ::fsync(file) == 0;
  const int write_error = errno;
  ::close(file);
  if (!written) {
    ::unlink(beside.c_str());
    Fail(path, CannotBeWritten(write_error == 0 ? ENOSPC : write_error));
  }
  if (std::rename(beside.c_str(), path.c_str()) != 0) {
    const int rename_error = errno;
    ::unlink(beside.c_str());
    Fail(path, CannotBeWritten(rename_error));
  }
}

}  // namespace waymark
