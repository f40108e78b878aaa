// When a camera exposes, and when its images arrive.
#pragma once

#include "estimation/base/random.h"
#include "estimation/base/time.h"

#include <cstdint>
#include <string_view>

namespace waymark {

struct CameraTimingOptions {
  double rate_hz = 15.0;
  double exposure_s = 0.005;
  double latency_s = 0.05;  // From the exposure's end to the image's arrival.
  double jitter_s = 0.0;    // Up to so much more, evenly spread.
  double drop_share = 0.0;  // Of frames that never arrive.

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct CameraFrame {
  std::int64_t number = 0;  // Counts dropped ones too.
  Time exposure_start;
  Time exposure_end;
  Time stamp;    // Of the image: the middle of its exposure.
  Time arrival;  // Never before that of an earlier frame.
};

// Frames in order, without the dropped ones.
class CameraTimer {
 public:
  // The first exposure starts at `start`. Cameras of other names draw other
  // numbers. Throws as Check() does.
  CameraTimer(const CameraTimingOptions& options,
              Time start,
              std::uint64_t seed,
              std::string_view name);

  [[nodiscard]] CameraFrame Next();

 private:
  CameraTimingOptions options_;
  Time start_;
  Random random_;
  std::int64_t num_frames_ = 0;
  Time last_arrival_;
};

}  // namespace waymark
