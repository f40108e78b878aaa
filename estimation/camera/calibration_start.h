// A first camera for calibrate_camera.h, from nothing but the views.
#pragma once

#include "estimation/camera/calibration_problem.h"

#include <optional>

namespace waymark {

// The best of what the least squares of all used corners come to from several
// starts. For each of a range of focal lengths, with the principal point in the
// middle of the image and no distortion, the poses are linear; the likeliest of
// these are refined, focal length and poses first, then all. Last, boards that
// a wrong lens tipped over on the way are tipped back. Nullopt where no start
// leads anywhere.
[[nodiscard]] std::optional<CalibrationState> SolveFromStarts(
    const CalibrationProblem& problem);

}  // namespace waymark
