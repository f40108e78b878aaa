// Photographs of buildings with known directions: York Urban, and how well
// found directions agree with its labels.
#pragma once

#include "estimation/lines/line_direction.h"
#include "estimation/lines/line_types.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <vector>

namespace waymark {

struct YorkPhotograph {
  std::string name;  // Of the image: <name>.jpg.
  // Columns: the labelled axes in C, unit, nearly orthogonal.
  Eigen::Matrix3d axes_C = Eigen::Matrix3d::Identity();
  // Found by LSD, as the data set has them. Their errors are not stated there:
  // ends of 0.3 px each are supposed.
  std::vector<LineSegment> segments;
};

// Sorted by name; none where the recordings are not there. Throws
// std::runtime_error where a file of theirs cannot be read.
[[nodiscard]] std::vector<YorkPhotograph> ReadYorkPhotographs();
[[nodiscard]] PinholeView YorkView();

// Segment between two ends of 0.3 px of error each.
[[nodiscard]] LineSegment SegmentBetween(const Eigen::Vector2d& a,
                                         const Eigen::Vector2d& b);

// The angles between axes, whatever their order and signs, rad: of the one to
// one assignment with the least sum.
[[nodiscard]] std::array<double, 3> AxisAngles(const Eigen::Matrix3d& truth,
                                               const Eigen::Matrix3d& found);
// Rotation or reflection with the least squares to three unit vectors.
[[nodiscard]] Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& axes);

// Of angles in degrees: mean of max(0, 1 - angle / limit) for each limit.
struct DirectionScore {
  double auc_3 = 0.0;
  double auc_5 = 0.0;
  double auc_10 = 0.0;
  double median_deg = 0.0;
};
[[nodiscard]] DirectionScore ScoreAngles(std::vector<double> angles_deg);

}  // namespace waymark
