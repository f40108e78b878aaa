// Patterns that repeat: walls, floors, ceilings, furniture.
#pragma once

#include "drivers/simulator/material_pattern.h"

namespace waymark {

// Period of a kind that repeats, m.
[[nodiscard]] Eigen::Vector2d PeriodOf(PatternKind kind);
// Its main colour, BGR, where none is asked for.
[[nodiscard]] cv::Vec3b SurfaceColorOf(PatternKind kind);

// Paints one period over the whole image.
void PaintSurface(PatternKind kind,
                  const cv::Vec3b& color,
                  std::uint64_t seed,
                  cv::Mat3b* image);

}  // namespace waymark
