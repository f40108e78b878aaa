// The plan of a world as a picture.
#pragma once

#include "drivers/simulator/scene.h"
#include "drivers/simulator/world.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <vector>

namespace waymark {

// What was driven, or believed to be.
struct PlanPath {
  enum class Kind { kDriven, kDeadReckoning, kBelieved };
  Kind kind = Kind::kBelieved;
  std::vector<Eigen::Vector2d> points;  // W, m.
};

struct PlanOptions {
  int pixels = 1200;            // Of the longer side of what there is.
  double seconds = 0.0;         // When: of people who walk.
  std::vector<PlanPath> paths;  // Drawn over everything, in this order.
};

// North up: floors, walls, doors, furniture, people, starts (arrows), places
// (pins with names), routes, metres along the edges, and a legend of what there
// is. `scene`: of the same world, for the outlines of mesh files.
[[nodiscard]] cv::Mat3b DrawPlan(const World& world,
                                 const Scene& scene,
                                 const PlanOptions& options);

}  // namespace waymark
