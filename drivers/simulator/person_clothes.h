// What the people of a scene wear and look like.
#pragma once

#include "drivers/simulator/scene.h"

#include <cstdint>

namespace waymark {

// Textures for the parts of person_mesh: on torso and head u runs once around,
// 0 and 1 at the back, 0.5 in front, and v from top to bottom; on limbs v runs
// from the body outward.
struct PersonLook {
  cv::Mat3b torso;
  cv::Mat3b sleeve;
  cv::Mat3b trousers;
  cv::Mat3b shoe;
  cv::Mat3b skin;
  cv::Mat3b face;
  cv::Mat3b hair;
  bool has_short_sleeves = false;
  bool has_long_hair = false;
  float build = 1.0f;  // Width of the trunk, 1 for the average.
};

[[nodiscard]] PersonLook MakePersonLook(std::uint64_t seed);

}  // namespace waymark
