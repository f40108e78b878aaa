// The "Labyrinth" recording of TU Chemnitz: a small robot with wheel
// velocities and ranges to radio beacons.
#pragma once

#include "logs/import/recording.h"

#include <string>

namespace waymark {

// Reads the one "*_Input.txt" in `folder` and the "*_GT.txt" beside it.
//
//   odom2diff t_s v_1 v_2 v_side base .. .. ..   wheel velocities, m/s
//   range2 ...                                   left out, counted
//   point2 t_s x_m y_m .. .. .. ..               where the robot was
//
// v_1 is the LEFT wheel and `base` HALF the wheel separation, other than the
// data set's readme says: its authors' own motion model turns by
// (v_2 - v_1) / (2 base), and so read dead reckoning stays within 64 mm (root
// mean square, start heading fitted) of a path of 9.2 m, as the readme has it
// within 1.03 m. A velocity holds from the stamp before to its own. Travel
// becomes virtual ticks of kTucResolution each.
//
// Throws InputError naming file and line: not these columns, a number that is
// none, time that does not increase, a base that changes.
[[nodiscard]] Recording ReadTucLabyrinth(const std::string& folder);

inline constexpr double kTucResolution = 1e-6;  // m per virtual tick.

}  // namespace waymark
