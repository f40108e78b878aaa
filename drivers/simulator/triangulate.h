// Triangles that fill an outline.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace waymark {

// Cuts the area of a simple polygon, counter-clockwise, into triangles of the
// same sense by clipping ears. Every corner becomes one of a triangle, those in
// the middle of a straight side too, so that neighbours which share the side
// leave no gap. O(n^3), for tens of corners.
//
// Throws std::invalid_argument where it finds no ear: the outline crosses
// itself or goes clockwise.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> Triangulate(
    const std::vector<Eigen::Vector2d>& outline);

}  // namespace waymark
