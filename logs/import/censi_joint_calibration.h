// Wheel velocities and scan-matched motion of a Khepera III, with the authors'
// own calibration.
#pragma once

#include "logs/import/recording.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace waymark {

struct CensiOptions {
  // Mounting of the laser. Without it, its yaw follows from the file's name:
  // 0 for "lstraight*", -90 degrees for "l90*".
  std::optional<Pose2> X_RS;
};

// All files "*.tuple" in `folder`, in order of their names. Throws InputError
// where there is none. "l90_0" to "l90_2" are parts of "l90": not to be used
// together with it.
[[nodiscard]] std::vector<std::string> FindCensiTuples(
    const std::string& folder);

// Reads one .tuple file: JSON objects, one or more to a line,
//
//   {"T": s, "phi_l": rad/s, "phi_r": rad/s, "sm": [x m, y m, yaw rad]}
//
// phi are mean wheel velocities over the interval T, sm is the motion of the
// laser in its own previous frame over the same interval. Intervals are put
// one after the other; where the authors dropped some, the recording does not
// say so. Wheel travel becomes virtual ticks of kCensiResolution each.
//
// [1] A. Censi, A. Franchi, L. Marchionni, G. Oriolo. Simultaneous calibration
//     of odometry and sensor parameters for mobile robots. IEEE Transactions on
//     Robotics 29(2), 2013.
//
// Throws InputError naming file and line: not JSON, an entry missing, of the
// wrong kind or not finite, T not in (0, 60] s, a mounting that the name does
// not tell and the options do not state.
[[nodiscard]] Recording ReadCensiTuples(const std::string& path,
                                        const CensiOptions& options = {});

inline constexpr double kCensiResolution = 1e-6;  // rad per virtual tick.

// The authors' result for a part, "l90_0_results.json".
struct CensiResult {
  WheelParameters wheels;  // m per rad of wheel turn, m per rad, m.
  Pose2 X_RS;
  // Of (k_right, k_left, wheel_base, x, y, yaw).
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Identity();
};
// Throws InputError naming file and entry.
[[nodiscard]] CensiResult ReadCensiResult(const std::string& path);

}  // namespace waymark
