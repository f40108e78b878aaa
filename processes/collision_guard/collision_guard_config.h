// Configuration of collision_guard.
#pragma once

#include "planner/control/velocity_guard.h"
#include "processes/support/describer.h"

#include <string>

namespace waymark {

struct CollisionGuardConfig {
  VelocityGuardOptions guard;
  double request_timeout_s = 0.25;
  std::string preferred_source = "teleop";
  std::string stop_file;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;

 private:
  void DescribeBase(Describer& d);
  void DescribeRanges(Describer& d);
};

}  // namespace waymark
