// Light that a moving camera gathers while its shutter is open.
#pragma once

#include "drivers/simulator/renderer.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <span>
#include <vector>

namespace waymark {

// Where everything is at one time of the exposure.
struct ExposureMoment {
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> X_WP;  // Of each mover.
};

// Mean of the light of all moments, at equal distances in time; one or more
// (WAYMARK_CHECK), as many pictures to render. A moment for each pixel that
// the image moves during the exposure leaves no steps.
[[nodiscard]] cv::Mat3f GatherLight(const Renderer& renderer,
                                    const CameraRays& camera,
                                    std::span<const ExposureMoment> moments,
                                    RenderQuality quality);

}  // namespace waymark
