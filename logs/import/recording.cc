#include "logs/import/recording.h"

#include <cmath>
#include <cstdio>

namespace waymark {

OdometryParameters NominalParameters(Time time,
                                     const WheelParameters& parameters,
                                     const Eigen::Vector3d& sigma) {
  OdometryParameters nominal;
  nominal.time = time;
  nominal.source = "nominal";
  nominal.parameters = parameters;
  nominal.covariance = sigma.cwiseAbs2().asDiagonal();
  return nominal;
}

InitialPose StatedStart(Time time,
                        const Pose2& X_WR,
                        const Eigen::Vector3d& sigma) {
  InitialPose start;
  start.time = time;
  start.source = "stated by the recording";
  start.X_WR = X_WR;
  start.covariance = sigma.cwiseAbs2().asDiagonal();
  return start;
}

void SetReferenceBack(double delay_s, Recording* recording) {
  if (recording->reference.samples.empty()) return;
  for (TruthSample& sample : recording->reference.samples) {
    sample.time -= DurationFromSeconds(delay_s);
  }
  char text[80];
  std::snprintf(text,
                sizeof(text),
                "the reference's stamps are set back by %g s, as asked for",
                delay_s);
  recording->notes.emplace_back(text);
}

double PathLength(const Reference& reference) {
  const auto& samples = reference.samples;
  double length = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    length += (samples[i].p_WS - samples[i - 1].p_WS).norm();
  }
  return length;
}

double WheelPathLength(const Recording& recording) {
  const WheelParameters& p = recording.nominal.parameters;
  const auto& encoders = recording.encoders;
  double length = 0.0;
  for (std::size_t i = 1; i < encoders.size(); ++i) {
    const auto right =
        static_cast<double>(encoders[i].right - encoders[i - 1].right);
    const auto left =
        static_cast<double>(encoders[i].left - encoders[i - 1].left);
    length += std::abs(0.5 * (p.k_right * right + p.k_left * left));
  }
  return length;
}

}  // namespace waymark
