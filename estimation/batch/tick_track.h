// Cumulative ticks as a function of time, and motion between any two times.
#pragma once

#include "estimation/batch/batch_types.h"
#include "estimation/filter/differential_drive.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace waymark {

// Motion X_R0R1 between two times, with the same members as DriveStep.
using TrackMotion = DriveStep;

// Velocity of the robot in its own frame.
struct TrackVelocity {
  double forward = 0.0;    // m/s.
  double turn_rate = 0.0;  // rad/s.
};

// Ticks are linear in time between readings, and go on before the first and
// after the last at the mean speeds of the 0.2 s beside them: a time offset may
// move a measurement over the edge, and a robot taken to stand there would tell
// that offset by a change of speed that nobody measured. Times are seconds
// since the first reading.
class TickTrack {
 public:
  // Readings in time order; of equal times the last counts; those that go
  // back in time are left out and counted.
  explicit TickTrack(std::span<const EncoderReading> readings);

  [[nodiscard]] bool empty() const { return time_.size() < 2; }
  [[nodiscard]] Time start() const { return start_; }
  [[nodiscard]] double duration() const {
    return time_.empty() ? 0.0 : time_.back();
  }
  [[nodiscard]] int num_refused() const { return num_refused_; }
  [[nodiscard]] double SecondsAt(Time t) const { return Seconds(t - start_); }
  [[nodiscard]] Time TimeAt(double seconds) const {
    return start_ + DurationFromSeconds(seconds);
  }
  // Mean absolute travel of the two wheels over the whole track, m.
  [[nodiscard]] double Travel(const WheelParameters& parameters) const;

  // Motion from time t0 to t1, exact for constant wheel speeds between
  // readings, with its derivative by the wheel parameters and its covariance
  // under `noise`. Where t1 < t0 the covariance is zero (used for small shifts
  // only).
  [[nodiscard]] TrackMotion Integrate(double t0,
                                      double t1,
                                      const WheelParameters& parameters,
                                      const DriveNoise& noise,
                                      DriveIntegration integration) const;

  // Velocity just after time t.
  [[nodiscard]] TrackVelocity VelocityAt(
      double t, const WheelParameters& parameters) const;

 private:
  // Index of the interval [time_[i], time_[i + 1]) that holds t; -1 is before
  // the first reading, that of the last reading is open.
  [[nodiscard]] int IntervalAt(double t) const;
  [[nodiscard]] WheelTicks RateIn(int interval) const;
  [[nodiscard]] WheelTicks TicksAt(double t, int interval) const;

  Time start_;
  int num_refused_ = 0;
  std::vector<double> time_;
  std::vector<WheelTicks> ticks_;  // Since the first reading.
  WheelTicks rate_before_;         // Ticks per second outside the readings.
  WheelTicks rate_after_;
};

}  // namespace waymark
