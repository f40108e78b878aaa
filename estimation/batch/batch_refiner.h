// Wheel parameters, sensor mountings and time offsets from whole logs.
#pragma once

#include "estimation/batch/batch_types.h"

#include <span>

namespace waymark {

// Maximum a posteriori estimate over all logs jointly: robot poses at the
// measurements (eliminated from the result), wheel parameters shared by all
// logs, one block (x, y, yaw, time offset) per sensor mounting.
//
//   between poses     motion by the ticks with these wheel parameters, with
//                     the distance-driven covariance
//   absolute fix      X_WF^-1 * X_WR * X_RS, present components
//   relative motion   X_RS^-1 * X_WR0^-1 * X_WR1 * X_RS [1]
//   priors            wheels, sensors, start pose where given; a very wide one
//                     on each log's first pose, so that a path without fixes
//                     has a place (parameters do not depend on which)
//
// Poses at a sensor's times move along the ticks as its time offset does.
// Solved by Levenberg-Marquardt (Ceres, one thread) in rounds that renew the
// whitening and the keyframes; the first round uses Huber's loss, which has no
// false minima, the others the asked one. Same input, same bits.
//
// Bad measurements are left out and counted. No answer is a status. Throws
// std::invalid_argument for options out of range. Cost: about 10 us per
// keyframe and iteration.
//
// [1] A. Censi, A. Franchi, L. Marchionni, G. Oriolo. Simultaneous calibration
//     of odometry and sensor parameters for mobile robots. IEEE T-RO 29(2),
//     2013.
[[nodiscard]] BatchResult RefineBatch(std::span<const BatchLog> logs,
                                      const BatchOptions& options);

}  // namespace waymark
