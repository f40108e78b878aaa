// The light of a rectangular lamp at a point that sees all of it.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Core>

namespace waymark {

// Irradiance at p_W of a surface with unit normal n_W, for radiance 1 and with
// nothing between: the integral over the lamp of cos cos / distance^2, exact,
// also where the surface's horizon cuts the lamp [1]. 0 behind the lamp
// (above: it shines downward).
//
// [1] J. H. Lambert. Photometria, 1760; as D. R. Baum, H. E. Rushmeier,
//     J. M. Winget. Improving radiosity solutions through the use of
//     analytically determined form-factors. SIGGRAPH 1989.
[[nodiscard]] double LampIrradiance(const SceneLamp& lamp,
                                    const Eigen::Vector3d& p_W,
                                    const Eigen::Vector3d& n_W);

}  // namespace waymark
