#include "drivers/simulator/scene_edges.h"

#include "estimation/base/check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

namespace waymark {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

void SceneEdgesOptions::Check() const {
  const auto refuse = [](const char* what) {
    throw std::invalid_argument(std::string("scene edges: ") + what);
  };
  if (!(min_crease_rad > 0.0)) refuse("min_crease_rad must be positive");
  if (!(step_px > 0.0)) refuse("step_px must be positive");
  // Below it the float rays of both sides are one.
  if (!(offset_px >= 0.001 && offset_px <= 0.5)) {
    refuse("offset_px must be 0.001 to 0.5");
  }
  if (!(min_length_px >= 0.0)) refuse("min_length_px must not be negative");
}

SceneEdges::SceneEdges(const Scene& scene, const SceneEdgesOptions& options)
    : options_(options) {
  options.Check();
  CheckScene(scene);
  const auto add = [&](const SceneMesh& mesh) {
    Mesh& added = meshes_.emplace_back();
    for (const SceneTriangle& triangle : mesh.triangles) {
      const Vector3d a = mesh.positions[triangle.vertices[0]].cast<double>();
      const Vector3d b = mesh.positions[triangle.vertices[1]].cast<double>();
      const Vector3d c = mesh.positions[triangle.vertices[2]].cast<double>();
      const Vector3d normal = (b - a).cross(c - a).stableNormalized();
      added.faces.push_back({normal, normal.dot(a), triangle.material});
    }
    added.edges = FindMeshEdges(mesh, options.min_crease_rad);
  };
  add(scene.mesh);
  for (const SceneMover& mover : scene.movers) add(mover.mesh);
}

// One view.
class EdgeFinder {
 public:
  EdgeFinder(const SceneEdges& edges,
             const RayCaster& caster,
             const CameraView& view,
             const Isometry3d& X_WC,
             std::span<const Isometry3d> X_WP)
      : options_(edges.options_),
        meshes_(edges.meshes_),
        caster_(caster),
        placement_(caster.Place(X_WP)),
        view_(view),
        X_WC_(X_WC),
        X_CW_(X_WC.inverse()),
        X_WP_(X_WP) {}

  std::vector<VisibleEdge> Find() {
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      mover_ = static_cast<std::int32_t>(m) - 1;
      X_WM_ = m == 0 ? Isometry3d::Identity() : X_WP_[m - 1];
      p_MC_ = X_WM_.inverse() * X_WC_.translation();
      for (const MeshEdge& edge : meshes_[m].edges) {
        if (edge.kind == EdgeKind::kSmooth && !IsOutline(edge)) continue;
        Follow(edge);
      }
    }
    return std::move(found_);
  }

 private:
  // A place on an edge.
  struct Place {
    double share = 0.0;  // From a to b.
    std::optional<Vector2d> pixel;
    bool is_seen = false;
  };

  [[nodiscard]] const std::vector<SceneEdges::Face>& faces(
      std::int32_t mover) const {
    return meshes_[static_cast<std::size_t>(mover + 1)].faces;
  }

  // Whether both faces are on one side of the plane through the camera and the
  // edge: then the surface folds back there.
  [[nodiscard]] bool IsOutline(const MeshEdge& edge) const {
    const Vector3d across = (edge.a - p_MC_).cross(edge.b - p_MC_);
    return across.dot(edge.inward[0]) * across.dot(edge.inward[1]) > 0.0;
  }

  [[nodiscard]] Vector3d PointAt(const MeshEdge& edge, double share) const {
    return X_WM_ * Vector3d(edge.a + share * (edge.b - edge.a));
  }

  [[nodiscard]] std::optional<Vector2d> PixelAt(const MeshEdge& edge,
                                                double share) const {
    const Vector3d p_C = X_CW_ * PointAt(edge, share);
    if (!(p_C.squaredNorm() > 0.0)) return std::nullopt;
    const auto projection = PixelFromRay(view_.model, p_C);
    if (!projection || !IsInside(view_.size, projection->pixel)) {
      return std::nullopt;
    }
    return projection->pixel;
  }

  // What the ray of a pixel meets: the face, in the frame of its own mesh.
  struct Meeting {
    const SceneEdges::Face* face = nullptr;  // Of nothing: null.
    std::int32_t mover = RayPacket::kStatic;
  };

  void SetRay(const Vector3d& ray_C, int lane, RayPacket* packet) const {
    const Vector3d ray_W = X_WC_.linear() * ray_C;
    for (int i = 0; i < 3; ++i) {
      packet->direction[i][lane] = static_cast<float>(ray_W[i]);
    }
  }

  [[nodiscard]] Meeting MeetingOf(const RayPacket& packet, int lane) const {
    if (packet.triangle[lane] == RayPacket::kNothing) return {};
    const std::int32_t mover = packet.mover[lane];
    return {&faces(mover)[packet.triangle[lane]], mover};
  }

  [[nodiscard]] static bool IsOnePlane(const SceneEdges::Face& a,
                                       const SceneEdges::Face& b) {
    // 1 mrad and 0.1 mm: what float corners leave of a flat wall.
    constexpr double kParallel = 1.0 - 5e-7;
    constexpr double kOffset = 1e-4;
    const double cosine = a.normal.dot(b.normal);
    return std::abs(cosine) > kParallel &&
           std::abs(a.offset - (cosine > 0.0 ? b.offset : -b.offset)) <
               kOffset * (1.0 + std::abs(a.offset));
  }

  [[nodiscard]] bool IsOwnFace(const MeshEdge& edge,
                               const Meeting& meeting) const {
    if (meeting.face == nullptr || meeting.mover != mover_) return false;
    return std::any_of(
        edge.triangles.begin(), edge.triangles.end(), [&](std::uint32_t t) {
          return IsOnePlane(faces(mover_)[t], *meeting.face);
        });
  }

  [[nodiscard]] bool IsSeen(const MeshEdge& edge, double share) const {
    const Vector3d p_W = PointAt(edge, share);
    const Vector3d p_C = X_CW_ * p_W;
    if (!(p_C.squaredNorm() > 0.0)) return false;
    const auto projection = PixelFromRay(view_.model, p_C);
    if (!projection || !IsInside(view_.size, projection->pixel)) return false;
    const Vector3d along_C =
        X_CW_.linear() * (X_WM_.linear() * (edge.b - edge.a)).normalized();
    const Vector2d along = projection->d_point * along_C;
    // Seen end-on it is a point.
    if (!(along.norm() * p_C.norm() > 1e-9)) return false;
    const Vector2d across =
        options_.offset_px * Vector2d(-along.y(), along.x()).normalized();
    const auto left = RayFromPixel(view_.model, projection->pixel + across);
    const auto right = RayFromPixel(view_.model, projection->pixel - across);
    if (!left || !right) return false;
    RayPacket packet;
    packet.active = 3;
    SetOrigin(X_WC_.translation().cast<float>(), &packet);
    for (int lane = 0; lane < RayPacket::kLanes; ++lane) {
      SetRay(lane == 1 ? right->ray : left->ray, lane, &packet);
    }
    caster_.Trace(&packet, &placement_);
    const Meeting a = MeetingOf(packet, 0);
    const Meeting b = MeetingOf(packet, 1);
    if (!IsOwnFace(edge, a) && !IsOwnFace(edge, b)) return false;
    if (a.face == nullptr || b.face == nullptr || a.mover != b.mover) {
      return true;
    }
    return a.face->material != b.face->material ||
           !IsOnePlane(*a.face, *b.face);
  }

  [[nodiscard]] Place PlaceAt(const MeshEdge& edge, double share) const {
    Place place{share, PixelAt(edge, share), false};
    place.is_seen = place.pixel && IsSeen(edge, share);
    return place;
  }

  // Places along (from, to], close enough to each other.
  void Sample(const MeshEdge& edge,
              const Place& from,
              const Place& to,
              int depth,
              std::vector<Place>* places) const {
    // 2^-14 of an edge: below a step for whatever fits into an image.
    constexpr int kDeepest = 14;
    const bool is_close = from.pixel && to.pixel &&
                          (*from.pixel - *to.pixel).norm() <= options_.step_px;
    // An edge that is outside at both ends may come into the image between
    // them: eight pieces at least, and down to a tenth of a degree.
    constexpr int kLeast = 3;
    constexpr double kNarrow = 2e-3;
    const bool is_outside = !from.pixel && !to.pixel && depth >= kLeast &&
                            AngleBetween(edge, from, to) < kNarrow;
    if (is_close || is_outside || depth >= kDeepest) {
      places->push_back(to);
      return;
    }
    const Place middle = PlaceAt(edge, 0.5 * (from.share + to.share));
    Sample(edge, from, middle, depth + 1, places);
    Sample(edge, middle, to, depth + 1, places);
  }

  [[nodiscard]] double AngleBetween(const MeshEdge& edge,
                                    const Place& a,
                                    const Place& b) const {
    const Vector3d to_a = PointAt(edge, a.share) - X_WC_.translation();
    const Vector3d to_b = PointAt(edge, b.share) - X_WC_.translation();
    return std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
  }

  // The last seen place between a seen and an unseen one.
  [[nodiscard]] Place LastSeen(const MeshEdge& edge,
                               Place seen,
                               Place unseen) const {
    // 24 halvings: of any edge less than offset_px.
    constexpr int kHalvings = 24;
    for (int i = 0; i < kHalvings; ++i) {
      if (unseen.pixel &&
          (*unseen.pixel - *seen.pixel).norm() < options_.offset_px) {
        break;
      }
      const Place middle = PlaceAt(edge, 0.5 * (seen.share + unseen.share));
      (middle.is_seen ? seen : unseen) = middle;
    }
    return seen;
  }

  void Follow(const MeshEdge& edge) {
    std::vector<Place> places = {PlaceAt(edge, 0.0)};
    Sample(edge, places[0], PlaceAt(edge, 1.0), 0, &places);
    std::vector<Place> stretch;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Place& place = places[i];
      const bool is_joined =
          i > 0 && place.pixel && places[i - 1].pixel &&
          (*place.pixel - *places[i - 1].pixel).norm() <= options_.step_px;
      // A whole turn's border cuts an edge in two.
      if (i > 0 && place.is_seen && places[i - 1].is_seen && !is_joined) {
        Store(edge, &stretch);
      }
      if (i > 0 && place.is_seen && !places[i - 1].is_seen) {
        stretch.push_back(LastSeen(edge, place, places[i - 1]));
      }
      if (place.is_seen) {
        stretch.push_back(place);
      } else if (i > 0 && places[i - 1].is_seen) {
        stretch.push_back(LastSeen(edge, places[i - 1], place));
        Store(edge, &stretch);
      }
    }
    Store(edge, &stretch);
  }

  void Store(const MeshEdge& edge, std::vector<Place>* stretch) {
    double length = 0.0;
    for (std::size_t i = 1; i < stretch->size(); ++i) {
      length += (*(*stretch)[i].pixel - *(*stretch)[i - 1].pixel).norm();
    }
    if (stretch->size() > 1 && length >= options_.min_length_px) {
      VisibleEdge& found = found_.emplace_back();
      found.kind = edge.kind;
      found.mover = mover_;
      found.a_W = PointAt(edge, stretch->front().share);
      found.b_W = PointAt(edge, stretch->back().share);
      for (const Place& place : *stretch) found.pixels.push_back(*place.pixel);
    }
    stretch->clear();
  }

  const SceneEdgesOptions& options_;
  const std::vector<SceneEdges::Mesh>& meshes_;
  const RayCaster& caster_;
  RayCaster::Placement placement_;
  const CameraView& view_;
  Isometry3d X_WC_;
  Isometry3d X_CW_;
  std::span<const Isometry3d> X_WP_;
  // Of the mesh that is looked at.
  std::int32_t mover_ = RayPacket::kStatic;
  Isometry3d X_WM_ = Isometry3d::Identity();
  Vector3d p_MC_ = Vector3d::Zero();
  std::vector<VisibleEdge> found_;
};

std::vector<VisibleEdge> SceneEdges::Find(
    const RayCaster& caster,
    const CameraView& view,
    const Isometry3d& X_WC,
    std::span<const Isometry3d> X_WP) const {
  WAYMARK_CHECK(X_WP.size() + 1 == meshes_.size(), X_WP.size());
  return EdgeFinder(*this, caster, view, X_WC, X_WP).Find();
}

}  // namespace waymark
