#include "drivers/simulator/camera_timing.h"

#include "drivers/simulator/option_range.h"

#include <algorithm>
#include <string>

namespace waymark {

void CameraTimingOptions::Check() const {
  RequireWithin("rate_hz", rate_hz, 0.01, 1000.0);
  RequireWithin("exposure_s", exposure_s, 0.0, 1.0 / rate_hz);
  RequireWithin("latency_s", latency_s, 0.0, 60.0);
  RequireWithin("jitter_s", jitter_s, 0.0, 60.0);
  // At 1 no frame would ever come.
  RequireWithin("drop_share", drop_share, 0.0, 0.99);
}

CameraTimer::CameraTimer(const CameraTimingOptions& options,
                         Time start,
                         std::uint64_t seed,
                         std::string_view name)
    : options_(options),
      start_(start),
      random_(SeedFor(seed, "camera." + std::string(name))) {
  options_.Check();
}

CameraFrame CameraTimer::Next() {
  for (;;) {
    CameraFrame frame;
    frame.number = num_frames_++;
    const bool is_dropped = random_.Uniform() < options_.drop_share;
    const double extra_s = options_.jitter_s * random_.Uniform();
    if (is_dropped) continue;
    const Duration exposure = DurationFromSeconds(options_.exposure_s);
    frame.exposure_start =
        start_ + DurationFromSeconds(static_cast<double>(frame.number) /
                                     options_.rate_hz);
    frame.exposure_end = frame.exposure_start + exposure;
    frame.stamp = frame.exposure_start + exposure / 2;
    frame.arrival = std::max(
        last_arrival_,
        frame.exposure_end + DurationFromSeconds(options_.latency_s + extra_s));
    last_arrival_ = frame.arrival;
    return frame;
  }
}

}  // namespace waymark
