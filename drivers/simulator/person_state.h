// What people who walk remember of the robots that they met.
#pragma once

#include <Eigen/Core>

namespace waymark {

struct PersonState {
  double waited_s = 0.0;  // Of all the time so far; more than that: went back.
  double patience_s = 0.0;  // Spent on the robot before them.
  Eigen::Vector2d aside_W = Eigen::Vector2d::Zero();  // From their path, m.
};

}  // namespace waymark
