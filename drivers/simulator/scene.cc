#include "drivers/simulator/scene.h"

#include "estimation/base/fingerprint.h"

#include <stdexcept>

namespace waymark {
namespace {

[[noreturn]] void Refuse(const std::string& where, const std::string& what) {
  throw std::invalid_argument("scene: " + where + ": " + what);
}

void CheckTriangle(const Scene& scene,
                   const SceneMesh& mesh,
                   const SceneTriangle& triangle,
                   const std::string& where) {
  for (const std::uint32_t vertex : triangle.vertices) {
    if (vertex >= mesh.positions.size()) Refuse(where, "no such vertex");
  }
  if (triangle.material >= scene.materials.size()) {
    Refuse(where, "no such material");
  }
  if (triangle.surface >= scene.surfaces.size()) {
    Refuse(where, "no such surface");
  }
}

void CheckMesh(const Scene& scene,
               const SceneMesh& mesh,
               const std::string& name) {
  if (mesh.positions.size() != mesh.uvs.size()) {
    Refuse(name, "as many uvs as positions are needed");
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!mesh.positions[i].allFinite() || !mesh.uvs[i].allFinite()) {
      Refuse(name + ", vertex " + std::to_string(i), "not finite");
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    CheckTriangle(scene,
                  mesh,
                  mesh.triangles[i],
                  name + ", triangle " + std::to_string(i));
  }
}

void CheckLamp(const SceneLamp& lamp, const std::string& where) {
  if (!lamp.p_W.allFinite() || !lamp.radiance.allFinite() ||
      (lamp.radiance.array() < 0.0).any()) {
    Refuse(where, "place and radiance must be finite, radiance not negative");
  }
  if (!lamp.size.allFinite() || (lamp.size.array() <= 0.0).any()) {
    Refuse(where, "its size must be positive");
  }
}

}  // namespace

std::string NameOf(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kFloor:
      return "floor";
    case SurfaceKind::kCeiling:
      return "ceiling";
    case SurfaceKind::kWall:
      return "wall";
    case SurfaceKind::kDoor:
      return "door";
    case SurfaceKind::kPillar:
      return "pillar";
    case SurfaceKind::kFurniture:
      return "furniture";
    case SurfaceKind::kPicture:
      return "picture";
    case SurfaceKind::kLamp:
      return "lamp";
    case SurfaceKind::kPerson:
      return "person";
    case SurfaceKind::kModel:
      return "model";
  }
  return "unknown";
}

void CheckScene(const Scene& scene) {
  for (const SceneMaterial& material : scene.materials) {
    if (material.texture.empty()) {
      Refuse("material " + material.name, "no texture");
    }
  }
  if (!scene.ambient.allFinite() || (scene.ambient.array() < 0.0).any()) {
    Refuse("ambient", "must be finite and not negative");
  }
  for (std::size_t i = 0; i < scene.lamps.size(); ++i) {
    CheckLamp(scene.lamps[i], "lamp " + std::to_string(i));
  }
  CheckMesh(scene, scene.mesh, "mesh");
  for (const SceneMover& mover : scene.movers) {
    CheckMesh(scene, mover.mesh, "mover " + mover.name);
    if (!(mover.radius > 0.0) || !(mover.height > 0.0)) {
      Refuse("mover " + mover.name, "radius and height must be positive");
    }
  }
}

std::uint64_t FingerprintOf(const Scene& scene) {
  Fingerprint print;
  const auto add_vector = [&](const auto& v) {
    for (const auto& component : v) print.Add(component);
  };
  const auto add_mesh = [&](const SceneMesh& mesh) {
    print.Add(mesh.triangles.size());
    for (const auto& p : mesh.positions) add_vector(p);
    for (const auto& uv : mesh.uvs) add_vector(uv);
    for (const SceneTriangle& triangle : mesh.triangles) {
      add_vector(triangle.vertices);
      print.Add(triangle.material);
      print.Add(triangle.surface);
    }
  };
  add_mesh(scene.mesh);
  for (const SceneMaterial& material : scene.materials) {
    const cv::Mat3b& texture = material.texture;
    print.Add(texture.rows);
    for (int y = 0; y < texture.rows; ++y) {
      print.Add(std::span<const std::uint8_t>(
          texture.ptr<std::uint8_t>(y),
          3 * static_cast<std::size_t>(texture.cols)));
    }
    print.Add(material.is_emissive);
  }
  for (const SceneSurface& surface : scene.surfaces) {
    print.Add(static_cast<int>(surface.kind));
  }
  for (const SceneLamp& lamp : scene.lamps) {
    add_vector(lamp.p_W);
    add_vector(lamp.size);
    add_vector(lamp.radiance);
  }
  add_vector(scene.ambient);
  for (const SceneMover& mover : scene.movers) {
    add_mesh(mover.mesh);
    print.Add(mover.radius);
    print.Add(mover.height);
  }
  return print.value();
}

}  // namespace waymark
