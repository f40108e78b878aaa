#include "drivers/simulator/mesh_builder.h"

#include "drivers/simulator/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace waymark {
namespace {

// 15 micrometres; a float holds it exactly up to 256 m.
constexpr double kGrid = 65536.0;

}  // namespace

std::uint32_t MeshBuilder::AddVertex(const Eigen::Vector3d& position,
                                     const Eigen::Vector2d& uv) {
  const Eigen::Vector3d snapped =
      (position * kGrid).array().round().matrix() / kGrid;
  mesh_->positions.push_back(snapped.cast<float>());
  mesh_->uvs.push_back(uv.cast<float>());
  return static_cast<std::uint32_t>(mesh_->positions.size() - 1);
}

void MeshBuilder::AddTriangle(const std::array<Eigen::Vector3d, 3>& corners,
                              const std::array<Eigen::Vector2d, 3>& uvs,
                              std::uint32_t material) {
  SceneTriangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.vertices[i] = AddVertex(corners[i], uvs[i]);
  }
  triangle.material = material;
  triangle.surface = surface_;
  mesh_->triangles.push_back(triangle);
}

void MeshBuilder::AddPanel(const Corners& corners,
                           const Finish& finish,
                           const Eigen::Vector2d& origin) {
  const double width = (corners[1] - corners[0]).norm();
  const double height = (corners[3] - corners[0]).norm();
  Eigen::Vector2d low = origin.cwiseQuotient(finish.size);
  Eigen::Vector2d high =
      (origin + Eigen::Vector2d(width, height)).cwiseQuotient(finish.size);
  if (finish.is_one_piece) {
    low.setZero();
    high.setOnes();
    if (finish.is_mirrored) std::swap(low.x(), high.x());
  }
  // v goes down; whole repetitions more or less show the same.
  const std::array<Eigen::Vector2d, 4> uvs{
      Eigen::Vector2d(low.x(), 1.0 - low.y()),
      Eigen::Vector2d(high.x(), 1.0 - low.y()),
      Eigen::Vector2d(high.x(), 1.0 - high.y()),
      Eigen::Vector2d(low.x(), 1.0 - high.y())};
  std::array<std::uint32_t, 4> v{};
  for (std::size_t i = 0; i < 4; ++i) v[i] = AddVertex(corners[i], uvs[i]);
  mesh_->triangles.push_back({{v[0], v[1], v[2]}, finish.material, surface_});
  mesh_->triangles.push_back({{v[0], v[2], v[3]}, finish.material, surface_});
}

void MeshBuilder::AddBox(const Eigen::Isometry3d& X_WB,
                         const Eigen::Vector3d& low,
                         const Eigen::Vector3d& high,
                         const Finish& finish,
                         unsigned faces) {
  const auto at = [&](int x, int y, int z) {
    return Eigen::Vector3d(X_WB * Eigen::Vector3d(x > 0 ? high.x() : low.x(),
                                                  y > 0 ? high.y() : low.y(),
                                                  z > 0 ? high.z() : low.z()));
  };
  if ((faces & kFront) != 0) {
    AddPanel({at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)}, finish);
  }
  if ((faces & kBack) != 0) {
    AddPanel({at(0, 1, 0), at(0, 0, 0), at(0, 0, 1), at(0, 1, 1)}, finish);
  }
  if ((faces & kLeft) != 0) {
    AddPanel({at(1, 1, 0), at(0, 1, 0), at(0, 1, 1), at(1, 1, 1)}, finish);
  }
  if ((faces & kRight) != 0) {
    AddPanel({at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)}, finish);
  }
  if ((faces & kTop) != 0) {
    AddPanel({at(1, 0, 1), at(1, 1, 1), at(0, 1, 1), at(0, 0, 1)}, finish);
  }
  if ((faces & kBottom) != 0) {
    AddPanel({at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)}, finish);
  }
}

void MeshBuilder::AddColumn(const Eigen::Isometry3d& X_WB,
                            double low,
                            double high,
                            double radius_low,
                            double radius_high,
                            int sides,
                            const Finish& finish,
                            unsigned faces) {
  const auto at = [&](int i, double radius, double z) {
    const double angle = 2.0 * std::numbers::pi * (i % sides) / sides;
    return Eigen::Vector3d(X_WB * Eigen::Vector3d(radius * std::cos(angle),
                                                  radius * std::sin(angle),
                                                  z));
  };
  const auto disc_uv = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d((X_WB.inverse() * p).head<2>())
        .cwiseQuotient(finish.size)
        .eval();
  };
  Finish side = finish;
  side.is_one_piece = false;
  const double width = 2.0 * std::max(radius_low, radius_high) *
                       std::sin(std::numbers::pi / sides);
  const Eigen::Vector3d middle_low = X_WB * Eigen::Vector3d(0.0, 0.0, low);
  const Eigen::Vector3d middle_high = X_WB * Eigen::Vector3d(0.0, 0.0, high);
  for (int i = 0; i < sides; ++i) {
    const Eigen::Vector3d a = at(i, radius_low, low);
    const Eigen::Vector3d b = at(i + 1, radius_low, low);
    const Eigen::Vector3d c = at(i + 1, radius_high, high);
    const Eigen::Vector3d d = at(i, radius_high, high);
    AddPanel({a, b, c, d}, side, {width * i, 0.0});
    if ((faces & kTop) != 0 && radius_high > 0.0) {
      AddTriangle({middle_high, d, c},
                  {disc_uv(middle_high), disc_uv(d), disc_uv(c)},
                  finish.material);
    }
    if ((faces & kBottom) != 0 && radius_low > 0.0) {
      AddTriangle({middle_low, b, a},
                  {disc_uv(middle_low), disc_uv(b), disc_uv(a)},
                  finish.material);
    }
  }
}

void MeshBuilder::AddArea(const std::vector<Eigen::Vector2d>& outline,
                          double z,
                          bool is_seen_from_above,
                          const Finish& finish) {
  std::vector<std::uint32_t> vertices;
  for (const Eigen::Vector2d& p : outline) {
    const Eigen::Vector2d uv = p.cwiseQuotient(finish.size);
    vertices.push_back(AddVertex(
        {p.x(), p.y(), z}, {uv.x(), is_seen_from_above ? -uv.y() : uv.y()}));
  }
  for (const auto& corner : Triangulate(outline)) {
    std::array<std::uint32_t, 3> v{
        vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]};
    if (!is_seen_from_above) std::swap(v[1], v[2]);
    mesh_->triangles.push_back({v, finish.material, surface_});
  }
}

}  // namespace waymark
