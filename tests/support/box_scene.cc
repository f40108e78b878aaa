#include "tests/support/box_scene.h"

#include "estimation/base/random.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace waymark {
namespace {

using Eigen::Vector3d;

void AddUprightCylinder(double radius,
                        double height,
                        int num_sides,
                        std::uint32_t material,
                        std::uint32_t surface,
                        SceneMesh* mesh) {
  const auto corner = [&](int i, double z) {
    const double angle = 2.0 * std::numbers::pi * i / num_sides;
    return Vector3d(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  for (int i = 0; i < num_sides; ++i) {
    AddQuad(corner(i, 0.0),
            corner(i + 1, 0.0),
            corner(i, height),
            material,
            surface,
            mesh);
    const auto first = static_cast<std::uint32_t>(mesh->positions.size());
    for (const Vector3d& p : {corner(i, height),
                              corner(i + 1, height),
                              Vector3d(0.0, 0.0, height)}) {
      mesh->positions.push_back(p.cast<float>());
      mesh->uvs.emplace_back(0.0f, 0.0f);
    }
    mesh->triangles.push_back(
        {{first, first + 1, first + 2}, material, surface});
  }
}

void AddCorridorWalls(Scene* scene) {
  const auto wall = AddMaterial(Plaster(256, {180, 190, 200}, 1), scene);
  const auto floor =
      AddMaterial(Checkers(8, 32, {90, 100, 120}, {130, 140, 150}), scene);
  const auto ceiling = AddMaterial(cv::Mat3b(1, 1, {225, 225, 225}), scene);
  const auto wall_id = AddSurface("wall", SurfaceKind::kWall, scene);
  const auto floor_id = AddSurface("floor", SurfaceKind::kFloor, scene);
  const auto ceiling_id = AddSurface("ceiling", SurfaceKind::kCeiling, scene);
  SceneMesh* mesh = &scene->mesh;
  AddQuad({0, 0, 0}, {12, 0, 0}, {0, 2, 0}, floor, floor_id, mesh);
  AddQuad({0, 0, 2.5}, {12, 0, 2.5}, {0, 2, 2.5}, ceiling, ceiling_id, mesh);
  AddQuad({0, 0, 2.5}, {12, 0, 2.5}, {0, 0, 0}, wall, wall_id, mesh);
  AddQuad({0, 2, 2.5}, {12, 2, 2.5}, {0, 2, 0}, wall, wall_id, mesh);
  AddQuad({0, 0, 2.5}, {0, 2, 2.5}, {0, 0, 0}, wall, wall_id, mesh);
  AddQuad({12, 0, 2.5}, {12, 2, 2.5}, {12, 0, 0}, wall, wall_id, mesh);
}

void AddCorridorThings(Scene* scene) {
  const auto wood = AddMaterial(Plaster(128, {60, 90, 140}, 2), scene);
  const auto stone = AddMaterial(Plaster(128, {140, 140, 150}, 3), scene);
  const auto picture = AddMaterial(Plaster(256, {128, 128, 128}, 4), scene);
  cv::Mat3b& art = scene->materials[picture].texture;
  for (cv::Vec3b& colour : art) {
    for (int i = 0; i < 3; ++i) {
      colour[i] = cv::saturate_cast<std::uint8_t>(6 * (colour[i] - 128) + 128);
    }
  }
  const auto door_id = AddSurface("door", SurfaceKind::kDoor, scene);
  const auto pillar_id = AddSurface("pillar", SurfaceKind::kPillar, scene);
  const auto box_id = AddSurface("crate", SurfaceKind::kFurniture, scene);
  const auto picture_id = AddSurface("picture", SurfaceKind::kPicture, scene);
  SceneMesh* mesh = &scene->mesh;
  for (const double x : {2.0, 5.0, 8.0}) {
    AddBox({x, -0.05, 0}, {x + 0.9, 0.03, 2.05}, wood, door_id, mesh);
  }
  AddBox({6.5, 1.7, 0}, {6.8, 2.0, 2.5}, stone, pillar_id, mesh);
  AddBox({3.2, 1.4, 0}, {3.8, 1.9, 0.5}, wood, box_id, mesh);
  AddQuad({4.4, 1.99, 1.8},
          {5.4, 1.99, 1.8},
          {4.4, 1.99, 1.0},
          picture,
          picture_id,
          mesh);
}

void AddCorridorLamps(Scene* scene) {
  const auto glow = AddMaterial(cv::Mat3b(1, 1, {255, 255, 255}), scene);
  scene->materials[glow].is_emissive = true;
  const auto id = AddSurface("lamp", SurfaceKind::kLamp, scene);
  for (const double x : {2.0, 6.0, 10.0}) {
    SceneLamp lamp;
    lamp.p_W = {x, 1.0, 2.48};
    lamp.size = {0.6, 0.6};
    lamp.radiance = {4.0, 4.4, 4.6};
    scene->lamps.push_back(lamp);
    AddQuad({x - 0.3, 0.7, 2.48},
            {x + 0.3, 0.7, 2.48},
            {x - 0.3, 1.3, 2.48},
            glow,
            id,
            &scene->mesh);
  }
}

}  // namespace

std::uint32_t AddMaterial(const cv::Mat3b& texture, Scene* scene) {
  const auto index = static_cast<std::uint32_t>(scene->materials.size());
  scene->materials.push_back({"material" + std::to_string(index), texture});
  return index;
}

std::uint32_t AddSurface(const std::string& name,
                         SurfaceKind kind,
                         Scene* scene) {
  scene->surfaces.push_back({name, kind});
  return static_cast<std::uint32_t>(scene->surfaces.size() - 1);
}

void AddQuad(const Vector3d& a,
             const Vector3d& b,
             const Vector3d& c,
             std::uint32_t material,
             std::uint32_t surface,
             SceneMesh* mesh) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  const auto right = static_cast<float>((b - a).norm());
  const auto down = static_cast<float>((c - a).norm());
  for (const Vector3d& p : {a, b, Vector3d(b + c - a), c}) {
    mesh->positions.push_back(p.cast<float>());
  }
  mesh->uvs.insert(mesh->uvs.end(),
                   {{0.0f, 0.0f}, {right, 0.0f}, {right, down}, {0.0f, down}});
  mesh->triangles.push_back({{first, first + 1, first + 2}, material, surface});
  mesh->triangles.push_back({{first, first + 2, first + 3}, material, surface});
}

void AddBox(const Vector3d& low,
            const Vector3d& high,
            std::uint32_t material,
            std::uint32_t surface,
            SceneMesh* mesh) {
  for (int axis = 0; axis < 3; ++axis) {
    const int right = (axis + 1) % 3;
    const int down = (axis + 2) % 3;
    for (const bool is_high : {false, true}) {
      Vector3d a = low;
      a[axis] = is_high ? high[axis] : low[axis];
      Vector3d b = a;
      b[right] = high[right];
      Vector3d c = a;
      c[down] = high[down];
      AddQuad(a, b, c, material, surface, mesh);
    }
  }
}

Eigen::Isometry3d LookFrom(const Vector3d& p_W, double yaw, double tilt) {
  Eigen::Matrix3d R_RC;
  R_RC.col(0) = -Vector3d::UnitY();
  R_RC.col(1) = -Vector3d::UnitZ();
  R_RC.col(2) = Vector3d::UnitX();
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() = (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(tilt, Vector3d::UnitY()))
                      .toRotationMatrix() *
                  R_RC;
  X_WC.translation() = p_W;
  return X_WC;
}

cv::Mat3b Checkers(int num,
                   int square_px,
                   const cv::Vec3b& first,
                   const cv::Vec3b& second) {
  cv::Mat3b image(num * square_px, num * square_px);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image(y, x) = (x / square_px + y / square_px) % 2 == 0 ? first : second;
    }
  }
  return image;
}

cv::Mat3b Plaster(int size_px, const cv::Vec3b& colour, std::uint64_t seed) {
  Random random(seed);
  cv::Mat1f sum(size_px, size_px, 0.0f);
  for (int cells = 4; cells <= size_px; cells *= 2) {
    cv::Mat1f noise(cells, cells);
    for (float& value : noise) value = static_cast<float>(random.Normal(6.0));
    cv::resize(noise, noise, sum.size(), 0.0, 0.0, cv::INTER_LINEAR);
    sum += noise;
  }
  cv::Mat3b image(sum.size());
  for (int y = 0; y < size_px; ++y) {
    for (int x = 0; x < size_px; ++x) {
      for (int c = 0; c < 3; ++c) {
        image(y, x)[c] = cv::saturate_cast<std::uint8_t>(
            static_cast<float>(colour[c]) + sum(y, x));
      }
    }
  }
  return image;
}

Scene EmptyRoom(const Vector3d& size, bool is_plain) {
  Scene scene;
  scene.ambient = {1.0, 1.0, 1.0};
  const std::array<const char*, 6> names = {
      "floor", "ceiling", "wall0", "wall1", "wall2", "wall3"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    AddSurface(names[i],
               i == 0   ? SurfaceKind::kFloor
               : i == 1 ? SurfaceKind::kCeiling
                        : SurfaceKind::kWall,
               &scene);
    const auto shade = static_cast<std::uint8_t>(40 * i + 30);
    const cv::Vec3b white(255, 255, 255);
    AddMaterial(is_plain ? cv::Mat3b(1, 1, white)
                         : Checkers(4, 16, white, {shade, 128, 60}),
                &scene);
  }
  const double x = size.x();
  const double y = size.y();
  const double z = size.z();
  SceneMesh* mesh = &scene.mesh;
  AddQuad({0, 0, 0}, {x, 0, 0}, {0, y, 0}, 0, 0, mesh);
  AddQuad({0, 0, z}, {x, 0, z}, {0, y, z}, 1, 1, mesh);
  AddQuad({0, 0, z}, {0, y, z}, {0, 0, 0}, 2, 2, mesh);
  AddQuad({x, 0, z}, {x, y, z}, {x, 0, 0}, 3, 3, mesh);
  AddQuad({0, 0, z}, {x, 0, z}, {0, 0, 0}, 4, 4, mesh);
  AddQuad({0, y, z}, {x, y, z}, {0, y, 0}, 5, 5, mesh);
  return scene;
}

Scene FurnishedCorridor() {
  Scene scene;
  scene.ambient = {0.35, 0.33, 0.32};
  AddCorridorWalls(&scene);
  AddCorridorThings(&scene);
  AddCorridorLamps(&scene);
  const auto cloth = AddMaterial(Plaster(64, {110, 70, 60}, 5), &scene);
  const auto id = AddSurface("person", SurfaceKind::kPerson, &scene);
  SceneMover person;
  person.name = "person";
  AddUprightCylinder(0.22, 1.7, 24, cloth, id, &person.mesh);
  person.radius = 0.22;
  person.height = 1.7;
  scene.movers.push_back(person);
  return scene;
}

}  // namespace waymark
