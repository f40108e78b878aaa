#include "estimation/batch/tick_track.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// Speeds before the first and after the last reading are means over this time:
// a few readings of any robot here, so that two readings with jitter in their
// stamps do not make up a speed.
constexpr double kEdgeS = 0.2;

WheelTicks Rate(const WheelTicks& from, const WheelTicks& to, double seconds) {
  return {(to.right - from.right) / seconds, (to.left - from.left) / seconds};
}

}  // namespace

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
  if (empty()) return;
  std::size_t second = 1;
  while (second + 1 < time_.size() && time_[second] < kEdgeS) ++second;
  rate_before_ = Rate(ticks_[0], ticks_[second], time_[second]);
  std::size_t former = time_.size() - 2;
  while (former > 0 && duration() - time_[former] < kEdgeS) --former;
  rate_after_ = Rate(ticks_[former], ticks_.back(), duration() - time_[former]);
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

int TickTrack::IntervalAt(double t) const {
  WAYMARK_CHECK(!empty());
  const auto above = std::upper_bound(time_.begin(), time_.end(), t);
  return static_cast<int>(std::distance(time_.begin(), above)) - 1;
}

WheelTicks TickTrack::RateIn(int interval) const {
  if (interval < 0) return rate_before_;
  const auto i = static_cast<std::size_t>(interval);
  if (i + 1 >= time_.size()) return rate_after_;
  return Rate(ticks_[i], ticks_[i + 1], time_[i + 1] - time_[i]);
}

WheelTicks TickTrack::TicksAt(double t, int interval) const {
  const auto i = static_cast<std::size_t>(std::max(interval, 0));
  const WheelTicks rate = RateIn(interval);
  return {ticks_[i].right + (t - time_[i]) * rate.right,
          ticks_[i].left + (t - time_[i]) * rate.left};
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
  int interval = IntervalAt(t0);
  const int last = IntervalAt(t1);
  WheelTicks ticks = TicksAt(t0, interval);
  for (; interval <= last; ++interval) {
    const int next = interval + 1;
    const WheelTicks end = interval == last
                               ? TicksAt(t1, last)
                               : ticks_[static_cast<std::size_t>(next)];
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
  if (empty()) return {};
  const WheelTicks rate = RateIn(IntervalAt(t));
  const double right = parameters.k_right * rate.right;
  const double left = parameters.k_left * rate.left;
  return {0.5 * (right + left), (right - left) / parameters.wheel_base};
}

}  // namespace waymark
