// What a renderer draws and a robot bumps into: triangles with materials.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

enum class SurfaceKind : std::uint8_t {
  kFloor,
  kCeiling,
  kWall,
  kDoor,
  kPillar,
  kFurniture,
  kPicture,  // Posters, noticeboards: flat things on a wall.
  kLamp,
  kPerson,
  kModel,  // Of a mesh file.
};

// "floor", "ceiling", ...
[[nodiscard]] std::string NameOf(SurfaceKind kind);

// Colours are 8-bit BGR values as an image shows them (sRGB curve); light is
// computed in linear values.
struct SceneMaterial {
  std::string name;
  // Diffuse reflectance, 1 x 1 or more; repeats over the plane of u and v.
  cv::Mat3b texture;
  // True: the texture has its light in it (lamps, models with baked light).
  bool is_emissive = false;
};

// A thing with a name: what a surface-id image holds indices of.
struct SceneSurface {
  std::string name;
  SurfaceKind kind = SurfaceKind::kWall;
};

struct SceneTriangle {
  std::array<std::uint32_t, 3> vertices{};  // Indices of positions and uvs.
  std::uint32_t material = 0;               // Index of Scene::materials.
  std::uint32_t surface = 0;                // Index of Scene::surfaces.
};

// Triangles are seen from both sides; the normal that faces the ray counts.
struct SceneMesh {
  std::vector<Eigen::Vector3f> positions;  // m.
  // One per position, in repetitions of the texture: (0, 0) is the corner of
  // its top-left pixel, (1, 1) that of its bottom-right one, v down the image.
  std::vector<Eigen::Vector2f> uvs;
  std::vector<SceneTriangle> triangles;
};

// A rectangle on the ceiling that shines downward. Its triangles, if it is to
// be seen, belong to the mesh (kLamp).
struct SceneLamp {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  // Middle.
  Eigen::Vector2d size{0.6, 0.6};                 // Along W's x and y, m.
  // Radiance, linear BGR: a white floor 2.5 m under a lamp of 1 m^2 and
  // radiance 1 has a radiosity of 0.16 by it.
  Eigen::Vector3d radiance{1.0, 1.0, 1.0};
};

// Something that moves as a whole; its mesh is in its own frame: x forward,
// y left, z up, the origin on the floor.
struct SceneMover {
  std::string name;
  SceneMesh mesh;
  double radius = 0.25;  // Of the upright cylinder that holds it, m.
  double height = 1.75;
};

struct Scene {
  SceneMesh mesh;  // In W: z up, the floor at z = 0 unless it says otherwise.
  std::vector<SceneMaterial> materials;
  std::vector<SceneSurface> surfaces;
  std::vector<SceneLamp> lamps;
  // Light that comes evenly from everywhere, linear BGR; walls around a point
  // keep their share of it away (ambient occlusion).
  Eigen::Vector3d ambient{0.25, 0.25, 0.25};
  std::vector<SceneMover> movers;
};

// Throws std::invalid_argument naming the first thing out of order: an index
// out of range, a value not finite, uvs and positions of different number, an
// empty texture.
void CheckScene(const Scene& scene);

// Changes with everything that is in it, names apart.
[[nodiscard]] std::uint64_t FingerprintOf(const Scene& scene);

}  // namespace waymark
