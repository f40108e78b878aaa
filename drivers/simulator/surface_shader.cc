#include "drivers/simulator/surface_shader.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace waymark {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Along the longer axis of a pixel on its surface.
constexpr int kMaxProbes = 8;

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

void SetLight(const LightChart& chart,
              const LightMap::Patch& patch,
              ShadedTriangle* shaded) {
  const Vector3d x = chart.right / chart.cell_size.x();
  const Vector3d y = chart.up / chart.cell_size.y();
  shaded->by_x[2] = static_cast<float>(x.x());
  shaded->by_y[2] = static_cast<float>(x.y());
  shaded->by_z[2] = static_cast<float>(x.z());
  shaded->constant[2] =
      static_cast<float>(-chart.origin.x() / chart.cell_size.x());
  shaded->by_x[3] = static_cast<float>(y.x());
  shaded->by_y[3] = static_cast<float>(y.y());
  shaded->by_z[3] = static_cast<float>(y.z());
  shaded->constant[3] =
      static_cast<float>(-chart.origin.y() / chart.cell_size.y());
  shaded->light = patch;
  const Eigen::Map<const Vector3d> normal(shaded->normal);
  shaded->is_light_map_turned = chart.normal.dot(normal) < 0.0;
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

std::vector<TextureSampler> TexturesOf(const Scene& scene) {
  std::vector<TextureSampler> textures;
  for (const SceneMaterial& material : scene.materials) {
    textures.emplace_back(material.texture);
  }
  return textures;
}

std::vector<char> EmissiveOf(const Scene& scene) {
  std::vector<char> flags;
  for (const SceneMaterial& material : scene.materials) {
    flags.push_back(material.is_emissive ? 1 : 0);
  }
  return flags;
}

std::vector<Float4> MeansOf(const std::vector<TextureSampler>& textures) {
  std::vector<Float4> means;
  for (const TextureSampler& texture : textures) {
    means.push_back(texture.mean());
  }
  return means;
}

// Of a surface that faces n_W: squares of its components sum up to 1.
Float4 MoverLight(const PlacedMover& mover, const Vector3f& n_W) {
  Float4 light{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto face = static_cast<std::size_t>(2 * axis + (n_W[axis] < 0.0f));
    light += Broadcast(n_W[axis] * n_W[axis]) * mover.light[face];
  }
  return light;
}

// Share of the light that a mover leaves at a point that faces n_W: spheres
// along its axis keep their form factors away, cos r^2 / d^2, less and less
// toward the end of its reach.
float ShadowOf(const PlacedMover& mover,
               const Vector3f& p_W,
               const Vector3f& n_W) {
  const Vector3f to_feet = mover.p_WP - p_W;
  const float reach = mover.radius + SurfaceShader::kShadowReach;
  const float nearness =
      1.0f - to_feet.head<2>().squaredNorm() / (reach * reach);
  if (nearness <= 0.0f) return 1.0f;
  const float square_radius = mover.radius * mover.radius;
  float left = 1.0f;
  for (int i = 0; i < SurfaceShader::kShadowSpheres; ++i) {
    Vector3f to_sphere = to_feet;
    to_sphere.z() += SurfaceShader::SphereHeight(mover, i);
    const float square = to_sphere.squaredNorm();
    const float along = n_W.dot(to_sphere);
    if (along <= 0.0f) continue;
    const float cosine = along / std::sqrt(square);
    left *= 1.0f - cosine * std::min(1.0f, square_radius / square);
  }
  return 1.0f - (1.0f - left) * nearness * nearness;
}

Vector3f LaneOf(const float (&values)[3][RayPacket::kLanes], int lane) {
  return {values[0][lane], values[1][lane], values[2][lane]};
}

}  // namespace

SurfaceShader::SurfaceShader(const Scene& scene,
                             const SurfaceShaderOptions& options,
                             int num_threads)
    : is_wide_(options.is_wide && HasWideShader()),
      surfaces_(scene.surfaces),
      textures_(TexturesOf(scene)),
      is_emissive_(EmissiveOf(scene)),
      albedos_(MeansOf(textures_)),
      field_(scene, options.light),
      light_map_(scene, field_, albedos_, options.light_map, num_threads) {
  const auto add = [&](const SceneMesh& mesh) {
    std::vector<ShadedTriangle>& list = triangles_.emplace_back();
    list.reserve(mesh.triangles.size());
    for (const SceneTriangle& triangle : mesh.triangles) {
      list.push_back(Prepare(mesh, triangle));
    }
  };
  add(scene.mesh);
  for (std::uint32_t i = 0; i < triangles_[0].size(); ++i) {
    if (const LightChart* chart = light_map_.chart(i)) {
      SetLight(*chart, light_map_.PatchOf(i), &triangles_[0][i]);
    }
  }
  for (const SceneMover& mover : scene.movers) {
    add(mover.mesh);
    mover_sizes_.push_back(
        {static_cast<float>(mover.radius), static_cast<float>(mover.height)});
  }
}

Float4 SurfaceShader::LightAt(const Vector3d& p_W, const Vector3d& n_W) const {
  const auto radiosity = [this](std::uint32_t index,
                                const Vector3f& q_W,
                                const Vector3f& direction) {
    const std::uint32_t material = triangle(RayPacket::kStatic, index).material;
    const Float4& albedo = albedos_[material];
    if (is_emissive_[material] != 0) return albedo;
    return albedo * light_map_.At(index, q_W, direction);
  };
  return field_.Direct(p_W, n_W) + field_.Gather(p_W, n_W, false, radiosity).light;
}

std::vector<PlacedMover> SurfaceShader::Place(
    std::span<const Eigen::Isometry3d> X_WP, const Vector3d& p_WC) const {
  std::vector<PlacedMover> movers;
  for (std::size_t i = 0; i < X_WP.size(); ++i) {
    const Eigen::Isometry3d X_PW = X_WP[i].inverse();
    PlacedMover& mover = movers.emplace_back();
    mover.R_PW = X_PW.rotation().cast<float>();
    mover.p_PC = (X_PW * p_WC).cast<float>();
    mover.p_WP = X_WP[i].translation().cast<float>();
    mover.radius = mover_sizes_[i].radius;
    mover.height = mover_sizes_[i].height;
    const double half_height = 0.5 * double(mover.height);
    const Vector3d middle =
        X_WP[i].translation() + half_height * Vector3d::UnitZ();
    for (int face = 0; face < 6; ++face) {
      Vector3d n_W = Vector3d::Zero();
      n_W[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
      const double reach = face < 4 ? double(mover.radius) : half_height;
      mover.light[static_cast<std::size_t>(face)] =
          LightAt(middle + reach * n_W, n_W);
    }
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
  const RayPacket& rays = fan.rays;
  std::fill_n(colours, RayPacket::kLanes, Float4{});
  std::uint32_t left = 0;
  for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
    const bool is_seen = rays.triangle[lane] != RayPacket::kNothing;
    left |= is_seen ? rays.active & 1u << lane : 0u;
  }
  // Most packets meet one triangle or two.
  for (int round = 0; is_wide_ && round < 3 && left != 0; ++round) {
    const int first = std::countr_zero(left);
    if (rays.mover[first] != RayPacket::kStatic) break;
    std::uint32_t lanes = 0;
    for (int lane = first; lane < RayPacket::kLanes; ++lane) {
      const bool is_same = rays.triangle[lane] == rays.triangle[first] &&
                           rays.mover[lane] == RayPacket::kStatic;
      lanes |= is_same ? left & 1u << lane : 0u;
    }
    // A lane alone is as fast by itself, and so is a triangle without a map.
    const ShadedTriangle& t =
        triangle(RayPacket::kStatic, rays.triangle[first]);
    const bool has_light = t.light.width > 0 || is_emissive_[t.material] != 0;
    if ((lanes & (lanes - 1u)) == 0 || !has_light) break;
    ShadeTogether(fan, lanes, movers, footprint_scale, colours);
    left &= ~lanes;
  }
  for (; left != 0; left &= left - 1u) {
    const int lane = std::countr_zero(left);
    colours[lane] = ShadeLane(fan, lane, movers, footprint_scale);
  }
}

void SurfaceShader::ShadeTogether(const RayFan& fan,
                                  std::uint32_t lanes,
                                  std::span<const PlacedMover> movers,
                                  float footprint_scale,
                                  Float4* colours) const {
  const RayPacket& rays = fan.rays;
  const ShadedTriangle& t =
      triangle(RayPacket::kStatic, rays.triangle[std::countr_zero(lanes)]);
  const bool is_lit = is_emissive_[t.material] == 0;
  ShadeWide(fan,
            {&t,
             &textures_[t.material],
             is_lit ? &light_map_ : nullptr,
             movers,
             kMaxProbes,
             footprint_scale},
            lanes,
            colours);
}

Float4 SurfaceShader::ShadeLane(const RayFan& fan,
                                int lane,
                                std::span<const PlacedMover> movers,
                                float footprint_scale) const {
  const RayPacket& rays = fan.rays;
  const ShadedTriangle& t = triangle(rays.mover[lane], rays.triangle[lane]);
  Vector3f origin = LaneOf(rays.origin, lane);
  Vector3f direction = LaneOf(rays.direction, lane);
  Vector3f d_x = LaneOf(fan.d_x, lane);
  Vector3f d_y = LaneOf(fan.d_y, lane);
  const PlacedMover* mover = nullptr;
  if (rays.mover[lane] != RayPacket::kStatic) {
    mover = &movers[static_cast<std::size_t>(rays.mover[lane])];
    origin = mover->p_PC;
    direction = mover->R_PW * direction;
    d_x = mover->R_PW * d_x;
    d_y = mover->R_PW * d_y;
  }
  const float distance = rays.distance[lane];
  const Vector3f p = origin + distance * direction;
  const Vector3f normal(static_cast<float>(t.normal[0]),
                        static_cast<float>(t.normal[1]),
                        static_cast<float>(t.normal[2]));
  const float slope = normal.dot(direction);
  // The neighbour's ray meets the same plane.
  const float scale = distance * footprint_scale;
  const float per_slope = 1.0f / slope;
  const Vector3f dp_x =
      scale * (d_x - direction * (normal.dot(d_x) * per_slope));
  const Vector3f dp_y =
      scale * (d_y - direction * (normal.dot(d_y) * per_slope));
  const Float4 maps = t.by_x * Broadcast(p.x()) + t.by_y * Broadcast(p.y()) +
                      t.by_z * Broadcast(p.z()) + t.constant;
  const Float4 maps_x = t.by_x * Broadcast(dp_x.x()) +
                        t.by_y * Broadcast(dp_x.y()) +
                        t.by_z * Broadcast(dp_x.z());
  const Float4 maps_y = t.by_x * Broadcast(dp_y.x()) +
                        t.by_y * Broadcast(dp_y.y()) +
                        t.by_z * Broadcast(dp_y.z());
  const Float4 albedo =
      textures_[t.material].Sample(maps[0],
                                   maps[1],
                                   {maps_x[0], maps_x[1], maps_y[0], maps_y[1]},
                                   kMaxProbes);
  if (is_emissive_[t.material] != 0) return albedo;
  const bool is_back = slope > 0.0f;
  const Vector3f facing = is_back ? Vector3f(-normal) : normal;
  if (mover != nullptr) {
    return albedo * MoverLight(*mover, mover->R_PW.transpose() * facing);
  }
  const int side = is_back != t.is_light_map_turned ? 1 : 0;
  Float4 light = light_map_.At(t.light, side, maps[2], maps[3]);
  for (const PlacedMover& other : movers) {
    light *= Broadcast(ShadowOf(other, p, facing));
  }
  return albedo * light;
}

std::size_t SurfaceShader::num_bytes() const {
  std::size_t sum = field_.num_bytes() + light_map_.num_bytes();
  for (const auto& list : triangles_) sum += list.size() * sizeof(list[0]);
  for (const TextureSampler& texture : textures_) sum += texture.num_bytes();
  return sum;
}

}  // namespace waymark
