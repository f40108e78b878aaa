// Any camera: rays from pixels, pixels from rays.
#pragma once

#include "estimation/camera/fisheye_camera.h"
#include "estimation/camera/panorama_camera.h"
#include "estimation/camera/perspective_camera.h"
#include "estimation/camera/sphere_camera.h"

#include <optional>
#include <variant>

namespace waymark {

using CameraModel = std::
    variant<PerspectiveCamera, FisheyeCamera, SphereCamera, PanoramaCamera>;

// As the model's own; nullopt outside its valid domain.
[[nodiscard]] std::optional<Projection> PixelFromRay(
    const CameraModel& camera, const Eigen::Vector3d& point_C);
[[nodiscard]] std::optional<BackProjection> RayFromPixel(
    const CameraModel& camera, const Eigen::Vector2d& pixel);

// The model's formula also where its lens has no inverse: between a start and
// the answer a minimiser's steps may lead through lenses that do not reach all
// points, and a wall there would stop it. No answer for a user.
[[nodiscard]] std::optional<Projection> ExtendedPixelFromRay(
    const CameraModel& camera, const Eigen::Vector3d& point_C);

// True for pixels of the image, edges of its outermost pixels included.
[[nodiscard]] bool IsInside(const ImageSize& size,
                            const Eigen::Vector2d& pixel);

}  // namespace waymark
