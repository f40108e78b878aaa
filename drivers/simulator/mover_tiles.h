// Where in an image movers may be: the rest is traced without them.
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/scene.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Balls one above the other that hold each mover of a scene.
class MoverTiles {
 public:
  explicit MoverTiles(const Scene& scene);

  // X_WP of each mover (WAYMARK_CHECK). By tile of the camera: 1 where a ray
  // may meet a mover, also from inside one, else 0.
  [[nodiscard]] std::vector<std::uint8_t> Near(
      const CameraRays& camera,
      const Eigen::Isometry3d& X_WC,
      std::span<const Eigen::Isometry3d> X_WP) const;

 private:
  struct Ball {
    Eigen::Vector3d middle_P = Eigen::Vector3d::Zero();
    double radius = 0.0;
  };
  std::vector<std::vector<Ball>> balls_;  // By mover.
};

}  // namespace waymark
