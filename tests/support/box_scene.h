// Small scenes of boxes for tests and benchmarks of the renderer.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <string>

namespace waymark {

// Adds an empty material of one colour, or the given texture; its index.
std::uint32_t AddMaterial(const cv::Mat3b& texture, Scene* scene);
std::uint32_t AddSurface(const std::string& name,
                         SurfaceKind kind,
                         Scene* scene);

// A parallelogram with corner `a` and edges to `b` and `c`; the texture
// repeats every metre, from `a` on.
void AddQuad(const Eigen::Vector3d& a,
             const Eigen::Vector3d& b,
             const Eigen::Vector3d& c,
             std::uint32_t material,
             std::uint32_t surface,
             SceneMesh* mesh);

// The six sides of an upright box; what is inside or outside does not matter.
void AddBox(const Eigen::Vector3d& low,
            const Eigen::Vector3d& high,
            std::uint32_t material,
            std::uint32_t surface,
            SceneMesh* mesh);

// X_WC of a camera at p_W that looks along x_W turned by `yaw` about z and then
// down by `tilt`.
[[nodiscard]] Eigen::Isometry3d LookFrom(const Eigen::Vector3d& p_W,
                                         double yaw,
                                         double tilt = 0.0);

// A checkerboard of `num` x `num` squares of `square_px`.
[[nodiscard]] cv::Mat3b Checkers(int num,
                                 int square_px,
                                 const cv::Vec3b& first,
                                 const cv::Vec3b& second);

// Smooth, seeded noise of all scales about `colour`: a wall with texture.
[[nodiscard]] cv::Mat3b Plaster(int size_px,
                                const cv::Vec3b& colour,
                                std::uint64_t seed);

// An empty room [0, size] with surfaces floor 0, ceiling 1, walls 2 (x = 0),
// 3 (x = size), 4 (y = 0), 5 (y = size), each with a material of its own
// (`is_plain`: all white). No lamp, ambient light 1.
[[nodiscard]] Scene EmptyRoom(const Eigen::Vector3d& size, bool is_plain);

// A furnished corridor of 12 x 2 x 2.5 m with lamps, doors, pillars, a picture
// and one person: the scene of pictures and speed.
[[nodiscard]] Scene FurnishedCorridor();

}  // namespace waymark
