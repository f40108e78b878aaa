// A camera's head that turns to where it is told.
#pragma once

#include "estimation/base/time.h"

namespace waymark {

struct PanTiltHeadOptions {
  double max_rate = 1.5;  // Of each axis, rad/s.
  double max_pan = 2.6;   // To both sides, rad.
  double max_tilt = 1.2;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct PanTilt {
  double pan = 0.0;  // As PanTiltMount has them, rad.
  double tilt = 0.0;
};

class PanTiltHead {
 public:
  // Rests at zero. Throws as Check() does.
  explicit PanTiltHead(const PanTiltHeadOptions& options);

  // Turns to `target`, or as near as the head goes, from `now` on, which does
  // not lie before an earlier command. Throws std::logic_error unless finite.
  void Command(Time now, const PanTilt& target);
  // At or after the last command.
  [[nodiscard]] PanTilt AnglesAt(Time t) const;
  // Whether it has arrived.
  [[nodiscard]] bool RestsAt(Time t) const;

 private:
  PanTiltHeadOptions options_;
  Time command_time_;
  PanTilt from_;
  PanTilt target_;
};

}  // namespace waymark
