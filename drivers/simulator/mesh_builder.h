// Panels, boxes and tapered columns, with textures at their true size.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace waymark {

// A material and how large it is.
struct Finish {
  std::uint32_t material = 0;
  Eigen::Vector2d size{1.0, 1.0};  // Of one repetition, m.
  bool is_one_piece = false;       // Stretched over each panel instead.
  bool is_mirrored = false;        // Left for right, where in one piece.
};

// Faces of a box that are made; others touch something.
enum BoxFaces : unsigned {
  kFront = 1u,  // +x
  kBack = 2u,   // -x
  kLeft = 4u,   // +y
  kRight = 8u,  // -y
  kTop = 16u,
  kBottom = 32u,
  kAllFaces = 63u,
};

// Appends to a mesh. Positions are rounded to 2^-16 m, so that what meets in
// one point does so to the last bit, whatever frame it was computed in.
class MeshBuilder {
 public:
  // Four corners: lower left, lower right, upper right, upper left as the side
  // that shows is seen.
  using Corners = std::array<Eigen::Vector3d, 4>;

  MeshBuilder(SceneMesh* mesh, std::uint32_t surface)
      : mesh_(mesh), surface_(surface) {}

  // `origin`: of the lower left corner in the plane of the texture, m to the
  // right and up; that of a finish in one piece does not count.
  void AddPanel(const Corners& corners,
                const Finish& finish,
                const Eigen::Vector2d& origin = Eigen::Vector2d::Zero());

  // Upright in its frame; +y of a texture is up, or -x on top and bottom.
  void AddBox(const Eigen::Isometry3d& X_WB,
              const Eigen::Vector3d& low,
              const Eigen::Vector3d& high,
              const Finish& finish,
              unsigned faces = kAllFaces);

  // About B's z from low to high, closed by discs; `sides` >= 3.
  void AddColumn(const Eigen::Isometry3d& X_WB,
                 double low,
                 double high,
                 double radius_low,
                 double radius_high,
                 int sides,
                 const Finish& finish,
                 unsigned faces = kAllFaces);

  // The area of an outline (counter-clockwise from above) at height z, seen
  // from above or from below. Textures lie along W's x and y.
  void AddArea(const std::vector<Eigen::Vector2d>& outline,
               double z,
               bool is_seen_from_above,
               const Finish& finish);

  void AddTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                   const std::array<Eigen::Vector2d, 3>& uvs,
                   std::uint32_t material);

 private:
  std::uint32_t AddVertex(const Eigen::Vector3d& position,
                          const Eigen::Vector2d& uv);

  SceneMesh* mesh_;
  std::uint32_t surface_;
};

}  // namespace waymark
