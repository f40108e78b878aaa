// The differential-drive runs of OptiOdom, with motion-capture reference.
#pragma once

#include "logs/import/recording.h"

#include <string>
#include <vector>

namespace waymark {

// All files "*_run-NN.csv" below `folder`, in order of their paths. Throws
// InputError where there is none.
[[nodiscard]] std::vector<std::string> FindOptiodomRuns(
    const std::string& folder);

// Reads one run,
//
//   time_s, x_m, y_m, heading_rad, right_ticks, left_ticks
//
// with the ticks of the cycle that ends at that time (20 Hz), and the gear and
// encoder from "*_metadata.csv" beside it (ngear, encRes); without that file
// they are those of all published runs, and a note says so.
//
// Nominal wheels are 84 mm and 0.2 m apart for every run. Some metadata state
// 85 mm or 0.205 m (Di, Li), but that is what the robot's controller was told
// in that experiment: fits of these runs give 200.5 mm like those of the
// others. A note says where they differ.
//
// [1] R. B. Sousa, M. R. Petry, P. G. Costa, A. P. Moreira. OptiOdom: a
//     generic approach for odometry calibration of wheeled mobile robots.
//     Journal of Intelligent and Robotic Systems 105, 39, 2022.
//
// Throws InputError naming file and line: not six columns, a number that is
// none, ticks that are not whole, time that does not increase, metadata of
// another kind of robot or not positive.
[[nodiscard]] Recording ReadOptiodomRun(const std::string& path);

}  // namespace waymark
