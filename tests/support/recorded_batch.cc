#include "tests/support/recorded_batch.h"

#include "estimation/base/check.h"
#include "estimation/batch/tick_track.h"

#include <cmath>

namespace waymark {

BatchLog BatchLogFromRecording(const Recording& recording,
                               const std::optional<Eigen::Vector3d>& sigma) {
  BatchLog log;
  log.encoders = recording.encoders;
  log.motions = recording.motions;
  const Reference& reference = recording.reference;
  for (const TruthSample& sample : reference.samples) {
    AbsoluteFix fix;
    fix.time = sample.time;
    fix.seq = static_cast<std::int64_t>(log.fixes.size());
    fix.source = reference.source;
    fix.has = {true, true, sample.heading.has_value()};
    fix.value << sample.p_WS, sample.heading.value_or(0.0);
    fix.covariance = sigma.value_or(reference.sigma).cwiseAbs2().asDiagonal();
    fix.X_RS = {sample.p_RS.x(), sample.p_RS.y(), 0.0};
    log.fixes.push_back(fix);
  }
  return log;
}

double DeadReckoningRmse(const Recording& recording,
                         const WheelParameters& parameters,
                         const Pose2& X_WR,
                         const Eigen::Vector2d& p_RS,
                         double time_offset_s) {
  const TickTrack track(recording.encoders);
  double squares = 0.0;
  int count = 0;
  double time = 0.0;
  Pose2 now = X_WR;
  for (const TruthSample& sample : recording.reference.samples) {
    const double next = track.SecondsAt(sample.time) - time_offset_s;
    if (next < 0.0 || next > track.duration()) continue;
    if (count > 0) {
      now =
          now *
          track
              .Integrate(
                  time, next, parameters, DriveNoise{}, DriveIntegration::kArc)
              .X_R0R1;
    }
    squares += (now * p_RS - sample.p_WS).squaredNorm();
    ++count;
    time = next;
  }
  WAYMARK_CHECK(count > 0);
  return std::sqrt(squares / count);
}

}  // namespace waymark
