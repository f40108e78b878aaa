// Pictures to hang on walls: rich in corners at several scales.
#pragma once

#include "drivers/simulator/pattern_canvas.h"

#include <optional>
#include <string>

namespace waymark {

// Fills the canvas with a picture of a kind and content drawn from `random`:
// shapes, a mosaic, a poster, a landscape, stained glass, triangles, a skyline,
// a still life, or a town map.
void PaintPicture(Random* random, Canvas canvas);

// A picture in its frame (and, mostly, a mount), with an optional title below.
void PaintFramedPicture(const std::optional<cv::Vec3b>& frame,
                        const std::string& title,
                        double pixels_per_metre,
                        std::uint64_t seed,
                        cv::Mat3b* image);

}  // namespace waymark
