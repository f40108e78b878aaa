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

void SetInView(const ShadedTriangle& t,
               const ShaderView& view,
               TriangleInView* seen) {
  const PlacedMover* mover =
      t.mover == RayPacket::kStatic
          ? nullptr
          : &view.movers[static_cast<std::size_t>(t.mover)];
  // Of the triangle's own frame M, W or the mover's.
  const Eigen::Isometry3d& X_MC = mover != nullptr ? mover->X_PC : view.X_WC;
  const Eigen::Matrix3d R_CM = X_MC.linear().transpose();
  const Vector3d& p_MC = X_MC.translation();
  const Eigen::Map<const Vector3d> n_M(t.normal);
  const Vector3d n_C = R_CM * n_M;
  const double height = t.offset - n_M.dot(p_MC);
  for (int row = 0; row < 4; ++row) {
    const Vector3d gradient_M(
        double(t.by_x[row]), double(t.by_y[row]), double(t.by_z[row]));
    const Vector3d gradient_C = R_CM * gradient_M;
    seen->by_x[row] = static_cast<float>(gradient_C.x());
    seen->by_y[row] = static_cast<float>(gradient_C.y());
    seen->by_z[row] = static_cast<float>(gradient_C.z());
    seen->constant[row] =
        static_cast<float>(double(t.constant[row]) + gradient_M.dot(p_MC));
  }
  seen->height = static_cast<float>(height);
  const bool is_back = height > 0.0;
  Vector3f facing = n_M.cast<float>();
  if (is_back) facing = -facing;
  if (mover != nullptr) facing = mover->R_WP * facing;
  for (int i = 0; i < 3; ++i) {
    seen->normal[i] = static_cast<float>(n_C[i]);
    seen->facing_W[i] = facing[i];
  }
  seen->light_side = is_back != t.is_light_map_turned ? 1 : 0;
  seen->is_mover = mover != nullptr;
  if (mover != nullptr) seen->mover_light = MoverLight(*mover, facing);
  seen->triangle = &t;
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
  const auto add = [&](const SceneMesh& mesh, std::int32_t mover) {
    first_triangle_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    for (const SceneTriangle& triangle : mesh.triangles) {
      triangles_.push_back(Prepare(mesh, triangle));
      triangles_.back().mover = mover;
    }
  };
  add(scene.mesh, RayPacket::kStatic);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    if (const LightChart* chart = light_map_.chart(i)) {
      SetLight(*chart, light_map_.PatchOf(i), &triangles_[i]);
    }
  }
  for (const SceneMover& mover : scene.movers) {
    add(mover.mesh, static_cast<std::int32_t>(mover_sizes_.size()));
    mover_sizes_.push_back(
        {static_cast<float>(mover.radius), static_cast<float>(mover.height)});
  }
}

Float4 SurfaceShader::LightAt(const Vector3d& p_W, const Vector3d& n_W) const {
  const auto radiosity = [this](std::uint32_t index,
                                const Vector3f& q_W,
                                const Vector3f& direction) {
    const std::uint32_t material = triangles_[index].material;
    const Float4& albedo = albedos_[material];
    if (is_emissive_[material] != 0) return albedo;
    return albedo * light_map_.At(index, q_W, direction);
  };
  return field_.Direct(p_W, n_W) +
         field_.Gather(p_W, n_W, false, radiosity).light;
}

ShaderView SurfaceShader::Place(std::span<const Eigen::Isometry3d> X_WP,
                                const Eigen::Isometry3d& X_WC) const {
  ShaderView view{X_WC, {}};
  for (std::size_t i = 0; i < X_WP.size(); ++i) {
    PlacedMover& mover = view.movers.emplace_back();
    mover.X_PC = X_WP[i].inverse() * X_WC;
    mover.R_WP = X_WP[i].rotation().cast<float>();
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
  return view;
}

const TriangleInView& TrianglesInView::Get(const ShadedTriangle& triangle) {
  const auto address = reinterpret_cast<std::uintptr_t>(&triangle);
  TriangleInView& entry = entries_[address / sizeof triangle % kSize];
  if (entry.triangle != &triangle) SetInView(triangle, view_, &entry);
  return entry;
}

void SurfaceShader::RefineDistances(const Vector3d& p_WC,
                                    RayPacket* rays) const {
  for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
    if (rays->triangle[lane] == RayPacket::kNothing ||
        rays->mover[lane] != RayPacket::kStatic) {
      continue;
    }
    const ShadedTriangle& t = triangles_[rays->triangle[lane]];
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

void SurfaceShader::Shade(const RayPacket& rays,
                          const CameraRays::Block& rays_C,
                          float footprint_scale,
                          TrianglesInView* triangles,
                          Colours* colours) const {
  constexpr auto kNothing = static_cast<std::int32_t>(RayPacket::kNothing);
  std::uint32_t left = rays.active & ~LanesEqual(rays.triangle, kNothing);
  if (left != RayPacket::kAllLanes) *colours = {};
  while (left != 0) {
    const int first = std::countr_zero(left);
    const std::uint32_t index = rays.triangle[first];
    const std::int32_t mover = rays.mover[first];
    std::uint32_t lanes =
        left & LanesEqual(rays.triangle, static_cast<std::int32_t>(index)) &
        LanesEqual(rays.mover, mover);
    left &= ~lanes;
    const TriangleInView& t =
        triangles->Get(triangles_[TriangleId(mover, index)]);
    // A lane alone is as fast by itself.
    if (is_wide_ && (lanes & (lanes - 1u)) != 0) {
      ShadeTogether(
          rays, rays_C, t, lanes, triangles->view(), footprint_scale, colours);
      continue;
    }
    for (; lanes != 0; lanes &= lanes - 1u) {
      const int lane = std::countr_zero(lanes);
      const Float4 colour =
          ShadeLane(rays, rays_C, lane, t, triangles->view(), footprint_scale);
      for (int c = 0; c < 3; ++c) colours->bgr[c][lane] = colour[c];
    }
  }
}

void SurfaceShader::ShadeTogether(const RayPacket& rays,
                                  const CameraRays::Block& rays_C,
                                  const TriangleInView& triangle,
                                  std::uint32_t lanes,
                                  const ShaderView& view,
                                  float footprint_scale,
                                  Colours* colours) const {
  const std::uint32_t material = triangle.triangle->material;
  const bool is_lit = is_emissive_[material] == 0;
  WideSurface surface{&triangle,
                      &textures_[material],
                      nullptr,
                      Broadcast(1.0f),
                      {},
                      kMaxProbes,
                      footprint_scale};
  if (is_lit && triangle.is_mover) {
    surface.even_light = triangle.mover_light;
  } else if (is_lit) {
    if (triangle.triangle->light.width > 0) {
      surface.light = &light_map_;
    } else {
      surface.even_light = light_map_.At(triangle.triangle->light, 0, 0, 0);
    }
    surface.movers = view.movers;
  }
  ShadeWide(rays, rays_C, surface, lanes, colours);
}

Float4 SurfaceShader::ShadeLane(const RayPacket& rays,
                                const CameraRays::Block& rays_C,
                                int lane,
                                const TriangleInView& t,
                                const ShaderView& view,
                                float footprint_scale) const {
  const auto dot = [lane](const auto& a, const CameraRays::Lanes(&b)[3]) {
    return a[0] * b[0][lane] + a[1] * b[1][lane] + a[2] * b[2][lane];
  };
  const auto map = [&](const CameraRays::Lanes(&b)[3]) {
    return t.by_x * Broadcast(b[0][lane]) + t.by_y * Broadcast(b[1][lane]) +
           t.by_z * Broadcast(b[2][lane]);
  };
  const float per_slope = 1.0f / dot(t.normal, rays_C.direction);
  const float distance = t.height * per_slope;
  const Float4 maps = map(rays_C.direction);
  const Float4 at = t.constant + Broadcast(distance) * maps;
  // The neighbour's ray meets the same plane.
  const Float4 scale = Broadcast(distance * footprint_scale);
  const Float4 along = Broadcast(per_slope) * maps;
  const Float4 d_x =
      scale * (map(rays_C.d_x) - along * Broadcast(dot(t.normal, rays_C.d_x)));
  const Float4 d_y =
      scale * (map(rays_C.d_y) - along * Broadcast(dot(t.normal, rays_C.d_y)));
  const std::uint32_t material = t.triangle->material;
  const Float4 albedo = textures_[material].Sample(
      at[0], at[1], {d_x[0], d_x[1], d_y[0], d_y[1]}, kMaxProbes);
  if (is_emissive_[material] != 0) return albedo;
  if (t.is_mover) return albedo * t.mover_light;
  Float4 light = light_map_.At(t.triangle->light, t.light_side, at[2], at[3]);
  Vector3f p_W;
  for (int i = 0; i < 3; ++i) {
    p_W[i] = rays.origin[i][lane] + distance * rays.direction[i][lane];
  }
  const Vector3f facing_W(t.facing_W[0], t.facing_W[1], t.facing_W[2]);
  for (const PlacedMover& mover : view.movers) {
    light *= Broadcast(ShadowOf(mover, p_W, facing_W));
  }
  return albedo * light;
}

std::size_t SurfaceShader::num_bytes() const {
  std::size_t sum = field_.num_bytes() + light_map_.num_bytes();
  sum += triangles_.size() * sizeof(triangles_[0]);
  for (const TextureSampler& texture : textures_) sum += texture.num_bytes();
  return sum;
}

}  // namespace waymark
