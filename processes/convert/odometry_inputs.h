// What estimators of odometry listen to, as checked values.
#pragma once

#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"
#include "processes/support/bus.h"

#include <functional>
#include <string_view>

namespace waymark {

// Called in the bus's handler thread. An empty one: not subscribed.
struct OdometryInputs {
  std::function<void(const EncoderReading&, int counter_bits)> on_reading;
  // POSITION_FIX, and CORRIDOR_POSE where it says anything.
  std::function<void(const AbsoluteFix&, std::string_view channel)> on_fix;
  std::function<void(const RelativeMotion&)> on_motion;
  std::function<void(const InitialPose&)> on_initial_pose;
  // Of any source. What says that it has no answer is left out.
  std::function<void(const OdometryParameters&)> on_parameters;
};

// Subscribes to ENCODERS, POSITION_FIX, CORRIDOR_POSE, RELATIVE_MOTION,
// INITIAL_POSE and ODOMETRY_PARAMETERS and keeps all messages. What cannot be
// used is reported to the bus and goes no further.
void SubscribeOdometryInputs(Bus* bus, const OdometryInputs& inputs);

}  // namespace waymark
