// LCM logs of University of Michigan MAEBots, as their programs recorded them.
#pragma once

#include "logs/import/recording.h"

#include <string>

namespace waymark {

// Reads one log. Messages are told by fingerprint, whatever their channel:
//
//   encoders        utime, left and right ticks in all (2016)
//   motor feedback  utime, left and right ticks, currents, speeds (2014)
//   pose            utime, x, y, theta: laser SLAM, becomes the reference
//   laser           becomes scans where its beams are evenly spaced
//
// Everything else is left out and counted by channel in the notes.
//
// Nominal wheels have a diameter of 32 mm and stand 80 mm apart, with 1200
// ticks a turn for `encoders` and 480 for `motor feedback`. The logs agree:
// turns by laser give 0.00099 rad per tick of difference in the former (0.00105
// nominal), 0.00256 rad in the latter (0.00262 nominal).
//
// Clock: the encoders' utime where it is a date and keeps step with the event
// times to kMaxClockSpread, otherwise their event times. Another channel's
// utime is used where it keeps step with that clock, otherwise its event times
// are moved to that clock. A message that is not later than the one before it
// of its kind is left out and counted.
//
// Throws InputError: as LogReader does; a message of these types that is cut
// short or not finite ("path: event 17 (SLAM_POSE): ..."); no encoders.
[[nodiscard]] Recording ReadMaebotLog(const std::string& path);

inline constexpr double kMaxClockSpread = 1.0;  // s.

}  // namespace waymark
