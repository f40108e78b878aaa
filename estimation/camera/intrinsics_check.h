// Refuses intrinsics that no camera can have.
#pragma once

#include "estimation/camera/lens_distortion.h"
#include "estimation/camera/projection_types.h"

namespace waymark {

// Throws std::invalid_argument naming the value: not finite, or a focal length
// of zero.
void RequireUsable(const Intrinsics& intrinsics);
void RequireUsable(const LensDistortion& distortion);
// Throws std::invalid_argument where `value` is not finite.
void RequireFinite(double value, const char* name);

}  // namespace waymark
