// What of a mesh stands in the way of a robot: its outline on the floor.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Core>

#include <vector>

namespace waymark {

// Heights over W's z = 0, m, that a body passes through: what lies wholly below
// (the floor, a mat) or above (a lintel) is no obstacle.
struct HeightBand {
  double low = 0.02;
  double high = 1.1;  // As RobotOptions::height.
};

inline constexpr double kHatch = 0.2;  // m; no robot is as narrow.

struct Segment2 {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
};

// Edges of the projections of all triangles, each clipped to the band, onto
// the plane z = 0: one segment of an upright triangle, a polygon's edges of any
// other, and lines across it at most kHatch apart: within a table's top nothing
// wider than kHatch is free. Pieces of one line that overlap or touch are
// joined. In an order that depends on the mesh only.
//
// Throws std::logic_error unless low < high and all are finite, and for an
// index that the mesh does not have.
[[nodiscard]] std::vector<Segment2> OutlineOfMesh(const SceneMesh& mesh,
                                                  const HeightBand& band);

}  // namespace waymark
