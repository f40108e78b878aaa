#include "estimation/batch/tick_track.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>

namespace waymark {

TickTrack::TickTrack(std::span<const EncoderReading> readings) {
  if (readings.empty()) return;
  const EncoderReading& first = readings.front();
  start_ = first.time;
  for (const EncoderReading& reading : readings) {
    const double t = Seconds(reading.time - start_);
    const WheelTicks ticks{static_cast<double>(reading.right - first.right),
                           static_cast<double>(reading.left - first.left)};
    if (!time_.empty() && t < time_.back()) {
      ++num_refused_;
    } else if (!time_.empty() && t == time_.back()) {
      ticks_.back() = ticks;
    } else {
      time_.push_back(t);
      ticks_.push_back(ticks);
    }
  }
}

double TickTrack::Travel(const WheelParameters& parameters) const {
  double travel = 0.0;
  for (std::size_t i = 1; i < ticks_.size(); ++i) {
    travel +=
        0.5 *
        (std::abs(parameters.k_right *
                  (ticks_[i].right - ticks_[i - 1].right)) +
         std::abs(parameters.k_left * (ticks_[i].left - ticks_[i - 1].left)));
  }
  return travel;
}

std::size_t TickTrack::IntervalAt(double t) const {
  WAYMARK_CHECK(!empty());
  const auto above = std::upper_bound(time_.begin(), time_.end(), t);
  const auto index = std::distance(time_.begin(), above) - 1;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      index, 0, static_cast<std::ptrdiff_t>(time_.size()) - 2));
}

WheelTicks TickTrack::TicksAt(double t, std::size_t interval) const {
  const double span = time_[interval + 1] - time_[interval];
  const double share = std::clamp((t - time_[interval]) / span, 0.0, 1.0);
  const WheelTicks& a = ticks_[interval];
  const WheelTicks& b = ticks_[interval + 1];
  return {a.right + share * (b.right - a.right),
          a.left + share * (b.left - a.left)};
}

TrackMotion TickTrack::Integrate(double t0,
                                 double t1,
                                 const WheelParameters& parameters,
                                 const DriveNoise& noise,
                                 DriveIntegration integration) const {
  if (t1 < t0) {
    const TrackMotion back = Integrate(t1, t0, parameters, noise, integration);
    // d(X^-1): differentiate X * X^-1 = identity.
    const Pose2 inverse = Inverse(back.X_R0R1);
    const ComposeJacobians jacobians = JacobiansOfCompose(back.X_R0R1, inverse);
    TrackMotion motion;
    motion.X_R0R1 = inverse;
    motion.d_parameters =
        -(jacobians.d_BC.transpose() * jacobians.d_AB * back.d_parameters);
    return motion;
  }
  const bool has_noise =
      noise.wheel_variance > 0.0 || noise.base_variance > 0.0;
  TrackMotion motion;
  std::size_t interval = IntervalAt(t0);
  const std::size_t last = IntervalAt(t1);
  WheelTicks ticks = TicksAt(t0, interval);
  for (; interval <= last; ++interval) {
    const WheelTicks end =
        interval == last ? TicksAt(t1, last) : ticks_[interval + 1];
    const WheelTicks step_ticks{end.right - ticks.right, end.left - ticks.left};
    ticks = end;
    if (step_ticks.right == 0.0 && step_ticks.left == 0.0) continue;
    const DriveStep step =
        IntegrateTicks(step_ticks, parameters, noise, integration);
    const ComposeJacobians jacobians =
        JacobiansOfCompose(motion.X_R0R1, step.X_R0R1);
    motion.d_parameters = jacobians.d_AB * motion.d_parameters +
                          jacobians.d_BC * step.d_parameters;
    if (has_noise) {
      motion.covariance =
          jacobians.d_AB * motion.covariance * jacobians.d_AB.transpose() +
          jacobians.d_BC * step.covariance * jacobians.d_BC.transpose();
    }
    motion.X_R0R1 = motion.X_R0R1 * step.X_R0R1;
  }
  return motion;
}

TrackVelocity TickTrack::VelocityAt(double t,
                                    const WheelParameters& parameters) const {
  if (empty() || t < time_.front() || t >= time_.back()) return {};
  const std::size_t i = IntervalAt(t);
  const double span = time_[i + 1] - time_[i];
  const double right =
      parameters.k_right * (ticks_[i + 1].right - ticks_[i].right) / span;
  const double left =
      parameters.k_left * (ticks_[i + 1].left - ticks_[i].left) / span;
  return {0.5 * (right + left), (right - left) / parameters.wheel_base};
}

}  // namespace waymark
