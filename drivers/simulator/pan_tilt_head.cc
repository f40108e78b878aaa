#include "drivers/simulator/pan_tilt_head.h"

#include "drivers/simulator/option_range.h"
#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>

namespace waymark {

void PanTiltHeadOptions::Check() const {
  RequireAbove0("max_rate", max_rate);
  RequireWithin("max_pan", max_pan, 0.0, kPi);
  RequireWithin("max_tilt", max_tilt, 0.0, kPi);
}

PanTiltHead::PanTiltHead(const PanTiltHeadOptions& options)
    : options_(options) {
  options_.Check();
}

void PanTiltHead::Command(Time now, const PanTilt& target) {
  WAYMARK_CHECK(std::isfinite(target.pan) && std::isfinite(target.tilt),
                target.pan,
                target.tilt);
  WAYMARK_CHECK(now >= command_time_, Microseconds(now));
  from_ = AnglesAt(now);
  command_time_ = now;
  target_ = {std::clamp(target.pan, -options_.max_pan, options_.max_pan),
             std::clamp(target.tilt, -options_.max_tilt, options_.max_tilt)};
}

PanTilt PanTiltHead::AnglesAt(Time t) const {
  const double turned = options_.max_rate * Seconds(t - command_time_);
  const auto towards = [&](double from, double to) {
    if (std::abs(to - from) <= turned) return to;
    return from + std::copysign(turned, to - from);
  };
  return {towards(from_.pan, target_.pan), towards(from_.tilt, target_.tilt)};
}

bool PanTiltHead::RestsAt(Time t) const {
  const PanTilt angles = AnglesAt(t);
  return angles.pan == target_.pan && angles.tilt == target_.tilt;
}

}  // namespace waymark
