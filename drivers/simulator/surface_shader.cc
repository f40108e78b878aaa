#include "drivers/simulator/surface_shader.h"

#include "drivers/simulator/lamp_light.h"

#include <cmath>

namespace waymark {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Row `row` of the maps: `value` at the corners, the same along the normal.
void SetMap(const SceneMesh& mesh,
            const SceneTriangle& triangle,
            const Vector3d& normal,
            const std::array<double, 3>& value,
            int row,
            ShadedTriangle* shaded) {
  const Vector3d a = mesh.positions[triangle.vertices[0]].cast<double>();
  const Vector3d ab = mesh.positions[triangle.vertices[1]].cast<double>() - a;
  const Vector3d ac = mesh.positions[triangle.vertices[2]].cast<double>() - a;
  const double doubled_area = normal.dot(ab.cross(ac));
  Vector3d gradient = Vector3d::Zero();
  if (doubled_area > 0.0) {
    gradient = ((value[1] - value[0]) * ac.cross(normal) +
                (value[2] - value[0]) * normal.cross(ab)) /
               doubled_area;
  }
  shaded->by_x[row] = static_cast<float>(gradient.x());
  shaded->by_y[row] = static_cast<float>(gradient.y());
  shaded->by_z[row] = static_cast<float>(gradient.z());
  shaded->constant[row] = static_cast<float>(value[0] - gradient.dot(a));
}

ShadedTriangle Prepare(const SceneMesh& mesh, const SceneTriangle& triangle) {
  const Vector3d a = mesh.positions[triangle.vertices[0]].cast<double>();
  const Vector3d b = mesh.positions[triangle.vertices[1]].cast<double>();
  const Vector3d c = mesh.positions[triangle.vertices[2]].cast<double>();
  // A triangle without area is never met; any normal will do.
  Vector3d normal = (b - a).cross(c - a).stableNormalized();
  if (!(normal.squaredNorm() > 0.0)) normal = Vector3d::UnitZ();
  ShadedTriangle shaded;
  std::array<double, 3> u{};
  std::array<double, 3> v{};
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = mesh.uvs[triangle.vertices[i]].x();
    v[i] = mesh.uvs[triangle.vertices[i]].y();
  }
  SetMap(mesh, triangle, normal, u, 0, &shaded);
  SetMap(mesh, triangle, normal, v, 1, &shaded);
  Eigen::Map<Vector3d>(shaded.normal) = normal;
  shaded.offset = normal.dot(a);
  shaded.material = triangle.material;
  shaded.surface = triangle.surface;
  return shaded;
}

Vector3f LaneOf(const float (&values)[3][RayPacket::kLanes], int lane) {
  return {values[0][lane], values[1][lane], values[2][lane]};
}

}  // namespace

SurfaceShader::SurfaceShader(const Scene& scene)
    : surfaces_(scene.surfaces), lamps_(scene.lamps), ambient_(scene.ambient) {
  const auto add = [&](const SceneMesh& mesh) {
    std::vector<ShadedTriangle>& list = triangles_.emplace_back();
    list.reserve(mesh.triangles.size());
    for (const SceneTriangle& triangle : mesh.triangles) {
      list.push_back(Prepare(mesh, triangle));
    }
  };
  add(scene.mesh);
  for (const SceneMover& mover : scene.movers) add(mover.mesh);
  for (const SceneMaterial& material : scene.materials) {
    textures_.emplace_back(material.texture);
    is_emissive_.push_back(material.is_emissive ? 1 : 0);
  }
}

std::vector<PlacedMover> SurfaceShader::Place(
    std::span<const Eigen::Isometry3d> X_WP, const Vector3d& p_WC) const {
  std::vector<PlacedMover> movers;
  for (const Eigen::Isometry3d& pose : X_WP) {
    const Eigen::Isometry3d X_PW = pose.inverse();
    movers.push_back(
        {X_PW.rotation().cast<float>(), (X_PW * p_WC).cast<float>(), pose});
  }
  return movers;
}

void SurfaceShader::RefineDistances(const Vector3d& p_WC,
                                    RayPacket* rays) const {
  for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
    if (rays->triangle[lane] == RayPacket::kNothing ||
        rays->mover[lane] != RayPacket::kStatic) {
      continue;
    }
    const ShadedTriangle& t = triangles_[0][rays->triangle[lane]];
    const double height = t.offset - t.normal[0] * p_WC.x() -
                          t.normal[1] * p_WC.y() - t.normal[2] * p_WC.z();
    const double slope = t.normal[0] * double(rays->direction[0][lane]) +
                         t.normal[1] * double(rays->direction[1][lane]) +
                         t.normal[2] * double(rays->direction[2][lane]);
    const auto distance = static_cast<float>(height / slope);
    // A ray along the plane has no better distance than the one met. What is
    // refined are roundings, far below this share.
    constexpr float kLargestChange = 1e-3f;
    if (std::abs(distance - rays->distance[lane]) <
        kLargestChange * rays->distance[lane]) {
      rays->distance[lane] = distance;
    }
  }
}

void SurfaceShader::Shade(const RayFan& fan,
                          std::span<const PlacedMover> movers,
                          float footprint_scale,
                          Float4* colours) const {
  constexpr int kMaxProbes = 8;
  const RayPacket& rays = fan.rays;
  for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
    colours[lane] = Float4{};
    if ((rays.active >> lane & 1u) == 0 ||
        rays.triangle[lane] == RayPacket::kNothing) {
      continue;
    }
    const ShadedTriangle& t = triangle(rays.mover[lane], rays.triangle[lane]);
    Vector3f origin = LaneOf(rays.origin, lane);
    Vector3f direction = LaneOf(rays.direction, lane);
    Vector3f d_x = LaneOf(fan.d_x, lane);
    Vector3f d_y = LaneOf(fan.d_y, lane);
    const float distance = rays.distance[lane];
    const Vector3f p_W = origin + distance * direction;
    Vector3f normal(static_cast<float>(t.normal[0]),
                    static_cast<float>(t.normal[1]),
                    static_cast<float>(t.normal[2]));
    Vector3f n_W = normal;
    if (rays.mover[lane] != RayPacket::kStatic) {
      const PlacedMover& mover =
          movers[static_cast<std::size_t>(rays.mover[lane])];
      origin = mover.p_PC;
      direction = mover.R_PW * direction;
      d_x = mover.R_PW * d_x;
      d_y = mover.R_PW * d_y;
      n_W = mover.R_PW.transpose() * normal;
    }
    const Vector3f p = origin + distance * direction;
    const float slope = normal.dot(direction);
    // The neighbour's ray meets the same plane.
    const float scale = distance * footprint_scale;
    const Vector3f dp_x = scale * (d_x - direction * (normal.dot(d_x) / slope));
    const Vector3f dp_y = scale * (d_y - direction * (normal.dot(d_y) / slope));
    const Float4 uv = t.by_x * Broadcast(p.x()) + t.by_y * Broadcast(p.y()) +
                      t.by_z * Broadcast(p.z()) + t.constant;
    const Float4 uv_x = t.by_x * Broadcast(dp_x.x()) +
                        t.by_y * Broadcast(dp_x.y()) +
                        t.by_z * Broadcast(dp_x.z());
    const Float4 uv_y = t.by_x * Broadcast(dp_y.x()) +
                        t.by_y * Broadcast(dp_y.y()) +
                        t.by_z * Broadcast(dp_y.z());
    const Float4 albedo = textures_[t.material].Sample(
        uv[0], uv[1], {uv_x[0], uv_x[1], uv_y[0], uv_y[1]}, kMaxProbes);
    if (is_emissive_[t.material] != 0) {
      colours[lane] = albedo;
      continue;
    }
    if (slope > 0.0f) n_W = -n_W;
    Vector3d light = ambient_;
    for (const SceneLamp& lamp : lamps_) {
      light += LampIrradiance(lamp, p_W.cast<double>(), n_W.cast<double>()) *
               lamp.radiance;
    }
    colours[lane] = albedo * Float4{static_cast<float>(light.x()),
                                    static_cast<float>(light.y()),
                                    static_cast<float>(light.z()),
                                    0.0f};
  }
}

std::size_t SurfaceShader::num_bytes() const {
  std::size_t sum = 0;
  for (const auto& list : triangles_) sum += list.size() * sizeof(list[0]);
  for (const TextureSampler& texture : textures_) sum += texture.num_bytes();
  return sum;
}

}  // namespace waymark
