// Models by others (glTF 2.0, Wavefront OBJ) as parts of a scene.
#pragma once

#include "drivers/simulator/scene.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <string>

namespace waymark {

struct MeshFileOptions {
  double scale = 1.0;  // Metres per unit of the file.
  // Pose of the model's frame M in W, after M's z has been turned up.
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  bool is_y_up = true;  // As glTF demands and most OBJ files have it.
  // The textures have their light in them: materials become emissive.
  bool has_baked_light = false;
  // Textures with a longer side are halved until they fit.
  int max_texture_side = 2048;
  SurfaceKind kind = SurfaceKind::kModel;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

struct MeshFileReport {
  int num_triangles = 0;
  int num_materials = 0;
  int num_textures = 0;
  Eigen::AlignedBox3d box_W;
};

// Bounds that a file may not exceed.
inline constexpr std::size_t kMaxMeshFileBytes = std::size_t{256} << 20U;
inline constexpr int kMaxMeshTriangles = 5'000'000;
inline constexpr double kMaxMeshExtent = 200.0;  // Of W's coordinates, m.

// Appends the file's triangles as one surface `name`, and its materials, to
// the scene's own mesh. `path` ends in .gltf, .glb or .obj; textures lie in
// files relative to it or are embedded. A material's colour multiplies its
// texture; alpha is ignored; without either it is light grey.
//
// Throws InputError with one line that names the file, and the material and
// texture where one is at fault; the scene is unchanged then.
MeshFileReport AppendMeshFile(const std::string& path,
                              const std::string& name,
                              const MeshFileOptions& options,
                              Scene* scene);

}  // namespace waymark
