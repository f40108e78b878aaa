// The LEGO NXT robot of Claus Brenner's course "SLAM Lectures", run 4.
#pragma once

#include "logs/import/recording.h"

#include <string>

namespace waymark {

// Reads robot4_motors.txt, robot4_reference.txt and, where it is there,
// robot4_scan.txt from `folder` (any prefix before _motors.txt; one run).
//
//   M time_ms left_ticks .. .. .. right_ticks ..    columns 3 and 7
//   P time_ms x_mm y_mm                             overhead camera, scanner
//   S time_ms count ranges_mm...                    laser, 660 beams
//
// All three files have one line for each scan and share one clock. A motor
// line repeats the one before it wherever no new reading had arrived, so lines
// that are equal in stamp and counts are merged (61 of 278) and every line
// keeps its own stamp. Taken at its own stamp, not by line number, a
// reference sample moves relative to fitted dead reckoning by 11 mm between
// lines (root mean square) rather than 24 mm, so the stamps mean what they
// say; what remains is a camera delay of about 0.18 s, left in for the
// refiner to find.
//
// Throws InputError naming file and line: no such file, not these columns, a
// number that is none, time going backwards, one stamp with two counts.
[[nodiscard]] Recording ReadBrennerLegoRobot4(const std::string& folder);

}  // namespace waymark
