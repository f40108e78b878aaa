// A corridor, and where in it a robot is, as values.
//
// Corridor frame L: on the floor, midway between the walls; x along the axis,
// y to the left wall, z up.
#pragma once

#include "estimation/geometry/pose2.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

struct CorridorGeometry {
  std::string name = "corridor";
  // Between the walls, and from floor to ceiling, m. Absent: not known; the
  // lines then say the heading alone.
  std::optional<double> width;
  std::optional<double> height;
  // Of a skirting board's upper edge, m. Absent: none, or not known.
  std::optional<double> skirting_height;
  // How far such a board stands out from the wall, m: the floor ends there.
  double skirting_depth = 0.0;
  double x_min = -1e3;  // Where it begins and ends, in L.
  double x_max = 1e3;
  Pose2 X_WL;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Where the robot is believed to be, at the time of the image.
struct CorridorPrior {
  Pose2 X_LR;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // x, y, heading.
};

// What an image line along the corridor is taken for [1, section III.C].
enum class CorridorEdge : std::uint8_t {
  kNone,  // Not along the corridor.
  kFloorLeft,
  kFloorRight,
  kCeilingLeft,
  kCeilingRight,
  kSkirtingLeft,
  kSkirtingRight,
  kAlong,  // Along the corridor, but none of these.
};

enum class CorridorStatus : std::uint8_t {
  kAccepted,
  kNoLines,           // Blank, dark, covered.
  kNoVanishingPoint,  // Lines, but not along a corridor.
  kAmbiguous,         // Heading known modulo pi, no prior to choose by.
  kOutside,           // The prior is in no known corridor.
  kEnds,              // Looks, or stands, where the corridor is none any more.
  kNoPosition,        // Candidates for y do not agree; heading is given.
  kUnknownSize,       // Heading alone: the corridor's size is not known.
  kFaulty,            // Fails the two-hypothesis test against the prior.
};
// One word, for messages: "accepted", "no_lines", ...
[[nodiscard]] const char* NameOf(CorridorStatus status);
[[nodiscard]] std::optional<CorridorStatus> CorridorStatusFromName(
    std::string_view name);

struct CorridorLine {
  LineSegment line;  // In the image that was given.
  CorridorEdge edge = CorridorEdge::kNone;
  bool is_used = false;  // For y, after elimination.
};

// Estimate of the robot's heading and lateral position in L, from one image.
// Where kFaulty is all that speaks against it, heading and y are given and
// the reader decides.
struct CorridorEstimate {
  CorridorStatus status = CorridorStatus::kNoLines;
  std::string reason;             // One line; empty where accepted.
  std::optional<double> heading;  // Of R in L, rad, in (-pi, pi].
  std::optional<double> y;        // Of R in L, m.
  // Of (y, heading); rows of what is absent are 0.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double p_regular = 0.0;  // By the two-hypothesis test; 1 where a direction
                           // was found and no prior chose among both ways.
  // Where the corridor's axis vanishes, px of the image that was given.
  std::optional<Eigen::Vector2d> vanishing_point;
  std::vector<CorridorLine> lines;  // All, in the order of the input.
};

}  // namespace waymark
