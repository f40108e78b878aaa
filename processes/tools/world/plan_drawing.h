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
  std::vector<Eigen::Vector2d> points;  // W, m.
  bool is_truth = false;                // Else an estimate.
};

struct PlanOptions {
  int pixels = 1200;            // Of the longer side of what there is.
  double seconds = 0.0;         // When: of people who walk.
  std::vector<PlanPath> paths;  // Drawn over everything, in this order.
};

// North up: floors, walls, doors, furniture, people, starts (arrows), places
// (pins with names), routes, a bar of metres. `scene`: of the same world, for
// the outlines of mesh files.
[[nodiscard]] cv::Mat3b DrawPlan(const World& world,
                                 const Scene& scene,
                                 const PlanOptions& options);

}  // namespace waymark
