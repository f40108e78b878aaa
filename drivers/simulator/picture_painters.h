// The kinds of pictures, and what they are made with.
#pragma once

#include "drivers/simulator/pattern_canvas.h"

#include <vector>

namespace waymark {

[[nodiscard]] float Between(Random* random, float low, float high);
[[nodiscard]] const cv::Vec3f& AnyOf(const std::vector<cv::Vec3f>& palette,
                                     Random* random);
[[nodiscard]] Eigen::Vector2f AnyPlace(const Canvas& canvas, Random* random);
[[nodiscard]] std::vector<Eigen::Vector2f> RandomPolygon(
    const Eigen::Vector2f& middle, float radius, Random* random);
// Stripes, dots or checks over the whole canvas.
void PaintHatch(const cv::Vec3f& color, Random* random, Canvas canvas);

// Each fills the canvas. Abstract ones:
void PaintShapes(Random* random, Canvas canvas);
void PaintMosaic(Random* random, Canvas canvas);
void PaintTriangles(Random* random, Canvas canvas);
void PaintGlass(Random* random, Canvas canvas);
// Of things:
void PaintPoster(Random* random, Canvas canvas);
void PaintLandscape(Random* random, Canvas canvas);
void PaintSkyline(Random* random, Canvas canvas);
void PaintStillLife(Random* random, Canvas canvas);
void PaintMap(Random* random, Canvas canvas);

}  // namespace waymark
