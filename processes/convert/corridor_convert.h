// What a corridor's lines say, to messages and to measurements.
#pragma once

#include "estimation/base/time.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/filter/measurement_types.h"

#include <waymark/corridor_pose_t.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

// An estimate on its way: of which image, in which corridor, by which camera.
struct CorridorAnswer {
  Time time;  // Of the image.
  std::int64_t seq = 0;
  std::string source;  // Camera, as in IMAGE_<source>.
  Pose2 X_RS;          // Its mounting in the plane.
  // Absent: in none that is known. Its ends are not sent.
  std::optional<CorridorGeometry> corridor;
  Duration lines_took{};  // To find the lines, and the pose from them; 0
  Duration pose_took{};   // offline.
  // Its pixels are those of the camera's image.
  CorridorEstimate estimate;
};

// At most 500 lines are sent, the first ones along the corridor: more do not
// fit into one datagram of LCM.
[[nodiscard]] corridor_pose_t ToMessage(const CorridorAnswer& answer);

// What ToMessage() was given, as far as it was sent: errors of lines are not.
//
// Returns nullopt and sets *reason where CorridorFixFromMessage() does, or the
// status is none, the corridor's size is none that CorridorGeometry allows, a
// line's ends are not finite, or it is of no known edge.
// `reason` must not be null.
[[nodiscard]] std::optional<CorridorAnswer> CorridorAnswerFromMessage(
    const corridor_pose_t& message, std::string* reason);

// The message as a measurement of the camera's pose X_LS: heading, and y where
// it has one, with the camera's mounting beside it, so that who calibrates
// mountings can. Its source is "corridor <camera>". A message without a heading
// gives a fix of which nothing is present.
//
// Returns nullopt and sets *reason (what, value, allowed range) where the
// content cannot be used: time stamp not positive, number not finite or beyond
// 10 000 km, y without heading, covariance not symmetric or not positive
// definite. `reason` must not be null.
[[nodiscard]] std::optional<AbsoluteFix> CorridorFixFromMessage(
    const corridor_pose_t& message, std::string* reason);

}  // namespace waymark
