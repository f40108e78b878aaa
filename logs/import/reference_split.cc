#include "logs/import/reference_split.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace waymark {
namespace {

std::string SourceText(const ReferenceSplitOptions& options) {
  if (options.use == ReferenceUse::kCalibration) {
    return "reference, every sample, no added noise";
  }
  std::ostringstream text;
  const int k = options.every;
  const bool is_teen = k % 100 >= 11 && k % 100 <= 13;
  const char* const ending = k % 10 == 1 && !is_teen   ? "st"
                             : k % 10 == 2 && !is_teen ? "nd"
                             : k % 10 == 3 && !is_teen ? "rd"
                                                       : "th";
  text << "reference, every " << k << ending << ", noise " << options.noise_m
       << " m";
  if (options.use_heading) text << " and " << options.noise_rad << " rad";
  text << ", seed " << options.seed;
  return text.str();
}

void RequireNoise(double value, const char* field) {
  constexpr double kMax = 10.0;
  if (value >= 0.0 && value <= kMax) return;
  throw std::invalid_argument(std::string(field) + " is " +
                              std::to_string(value) + ", 0 to 10 allowed");
}

}  // namespace

void ReferenceSplitOptions::Check() const {
  constexpr int kMaxEvery = 1'000'000;
  if (every < 1 || every > kMaxEvery) {
    throw std::invalid_argument("every is " + std::to_string(every) +
                                ", 1 to 1000000 allowed");
  }
  RequireNoise(noise_m, "noise_m");
  RequireNoise(noise_rad, "noise_rad");
}

ReferenceSplit SplitReference(const Reference& reference,
                              const ReferenceSplitOptions& options) {
  options.Check();
  const auto& samples = reference.samples;
  if (options.use_heading &&
      !std::all_of(samples.begin(), samples.end(), [](const TruthSample& s) {
        return s.heading.has_value();
      })) {
    throw std::invalid_argument("the reference has no headings");
  }
  const bool is_running = options.use == ReferenceUse::kRunning;
  const Eigen::Vector3d noise =
      is_running
          ? Eigen::Vector3d(options.noise_m, options.noise_m, options.noise_rad)
          : Eigen::Vector3d::Zero();
  const std::size_t every =
      is_running ? static_cast<std::size_t>(options.every) : 1;

  AbsoluteFix fix;
  fix.source = SourceText(options);
  fix.has = {true, true, options.use_heading};
  const Eigen::Vector3d variance =
      reference.sigma.cwiseAbs2() + noise.cwiseAbs2();
  for (int i = 0; i < 3; ++i) {
    // Rows of what is absent are 0.
    if (fix.has[static_cast<std::size_t>(i)])
      fix.covariance(i, i) = variance(i);
  }
  fix.X_RS = {reference.p_RS.x(), reference.p_RS.y(), 0.0};

  ReferenceSplit split;
  Random random(options.seed);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const TruthSample& sample = samples[i];
    if (i % every != 0) {
      split.truth.push_back(sample);
      continue;
    }
    fix.time = sample.time;
    fix.value = {sample.p_WS.x(), sample.p_WS.y(), 0.0};
    // Always three draws, so that positions do not depend on use_heading.
    for (int j = 0; j < 3; ++j) {
      const double error = random.Normal(noise(j));
      if (j < 2) fix.value(j) += error;
      if (j == 2 && options.use_heading) {
        fix.value(2) = WrapAngle(*sample.heading + error);
      }
    }
    split.fixes.push_back(fix);
    ++fix.seq;
  }
  return split;
}

}  // namespace waymark
