#include "drivers/simulator/scene_edges.h"

#include "tests/support/box_scene.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace waymark {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

CameraView Pinhole() {
  return {PerspectiveCamera({300.0, 300.0, 319.5, 239.5}), {640, 480}};
}

CameraView Perspective() {
  return {PerspectiveCamera({300.0, 300.0, 319.5, 239.5},
                            {-0.1, 0.02, 0.001, -0.001, 0.0}),
          {640, 480}};
}

std::vector<CameraView> AllModels() {
  return {Perspective(),
          {FisheyeCamera({200.0, 200.0, 319.5, 239.5}), {640, 480}},
          {SphereCamera(0.9, {250.0, 250.0, 319.5, 319.5}), {640, 640}},
          {PanoramaCamera::WholeTurn({1024, 256}, 128.0), {1024, 256}}};
}

std::vector<VisibleEdge> EdgesOf(const Scene& scene,
                                 const CameraView& view,
                                 const Isometry3d& X_WC,
                                 std::span<const Isometry3d> X_WP = {}) {
  return SceneEdges(scene).Find(RayCaster(scene), view, X_WC, X_WP);
}

Vector2d Project(const CameraView& view,
                 const Isometry3d& X_WC,
                 const Vector3d& p_W) {
  return PixelFromRay(view.model, X_WC.inverse() * p_W)->pixel;
}

double BorderDistance(const CameraView& view, const Vector2d& pixel) {
  return std::min({pixel.x() + 0.5,
                   pixel.y() + 0.5,
                   view.size.width - 0.5 - pixel.x(),
                   view.size.height - 0.5 - pixel.y()});
}

// The twelve edges of a room, through every model: ends are the projected
// corners or lie on the image's border, and every edge that is in the image is
// found along all of its length.
TEST(SceneEdges, RoomThroughEveryModel) {
  const Vector3d size(6.0, 4.0, 2.5);
  const Scene scene = EmptyRoom(size, true);
  const Isometry3d X_WC = LookFrom({1.3, 1.1, 1.4}, 0.5, 0.1);
  for (const CameraView& view : AllModels()) {
    const auto edges = EdgesOf(scene, view, X_WC);
    EXPECT_GE(edges.size(), 5u);
    double length = 0.0;
    for (const VisibleEdge& edge : edges) {
      EXPECT_EQ(edge.kind, EdgeKind::kCrease);
      for (const Vector2d& end : {edge.pixels.front(), edge.pixels.back()}) {
        double nearest = std::abs(BorderDistance(view, end));
        for (int i = 0; i < 8; ++i) {
          const Vector3d corner(i & 1 ? size.x() : 0.0,
                                i & 2 ? size.y() : 0.0,
                                i & 4 ? size.z() : 0.0);
          const auto pixel = PixelFromRay(view.model, X_WC.inverse() * corner);
          if (pixel) nearest = std::min(nearest, (pixel->pixel - end).norm());
        }
        EXPECT_LT(nearest, 0.05) << end.transpose();
      }
      for (std::size_t i = 1; i < edge.pixels.size(); ++i) {
        length += (edge.pixels[i] - edge.pixels[i - 1]).norm();
        EXPECT_LT((edge.pixels[i] - edge.pixels[i - 1]).norm(), 2.001);
      }
    }
    // By points along all twelve edges.
    double expected = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 4; ++i) {
        Vector3d a = Vector3d::Zero();
        a[(axis + 1) % 3] = i & 1 ? size[(axis + 1) % 3] : 0.0;
        a[(axis + 2) % 3] = i & 2 ? size[(axis + 2) % 3] : 0.0;
        bool has_before = false;
        Vector2d before = Vector2d::Zero();
        for (int k = 0; k <= 5000; ++k) {
          Vector3d p = a;
          p[axis] = size[axis] * k / 5000.0;
          const auto pixel = PixelFromRay(view.model, X_WC.inverse() * p);
          if (!pixel || !IsInside(view.size, pixel->pixel)) {
            has_before = false;
            continue;
          }
          const double step = (pixel->pixel - before).norm();
          // Not where the whole turn begins again.
          if (has_before && step < 50.0) expected += step;
          before = pixel->pixel;
          has_before = true;
        }
      }
    }
    EXPECT_NEAR(length, expected, 0.002 * expected + 0.5);
  }
}

double Cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// A plate hides the middle of an edge: where, a line through the plate's own
// edge says.
TEST(SceneEdges, HiddenStretchEndsWhereTheOccluderDoes) {
  Scene scene = EmptyRoom({6.0, 4.0, 2.5}, true);
  AddSurface("plate", SurfaceKind::kFurniture, &scene);
  const std::uint32_t plate = 6;
  AddQuad(
      {3.0, 1.5, 0.1}, {3.0, 2.5, 0.1}, {3.0, 1.5, 2.4}, 0, plate, &scene.mesh);
  const CameraView view = Pinhole();
  const Isometry3d X_WC = LookFrom({0.5, 2.2, 1.4}, 0.07, 0.0);
  std::vector<Vector2d> ends;
  for (const VisibleEdge& edge : EdgesOf(scene, view, X_WC)) {
    // The floor's edge with the far wall, x = 6 and z = 0.
    if (std::abs(edge.a_W.x() - 6.0) > 1e-6 || edge.a_W.z() > 1e-6 ||
        edge.b_W.z() > 1e-6 || std::abs(edge.b_W.x() - 6.0) > 1e-6) {
      continue;
    }
    ends.push_back(edge.pixels.front());
    ends.push_back(edge.pixels.back());
  }
  ASSERT_EQ(ends.size(), 4u);
  for (const double y : {1.5, 2.5}) {
    const Vector2d a = Project(view, X_WC, {6.0, 0.5, 0.0});
    const Vector2d b = Project(view, X_WC, {6.0, 3.5, 0.0});
    const Vector2d c = Project(view, X_WC, {3.0, y, 0.2});
    const Vector2d d = Project(view, X_WC, {3.0, y, 2.2});
    const double share = Cross(c - a, d - c) / Cross(b - a, d - c);
    const Vector2d expected = a + share * (b - a);
    double nearest = 1e9;
    for (const Vector2d& end : ends) {
      nearest = std::min(nearest, (end - expected).norm());
    }
    EXPECT_LT(nearest, 0.05);
  }
}

TEST(SceneEdges, MaterialsButNotSeamsWithinAPlane) {
  Scene scene;
  for (int i = 0; i < 2; ++i) {
    AddMaterial(cv::Mat3b(1, 1, {200, 200, 200}), &scene);
  }
  AddSurface("wall", SurfaceKind::kWall, &scene);
  // A wall of four quads side by side: materials 0, 0, 1, 1.
  for (int i = 0; i < 4; ++i) {
    AddQuad({4.0, -2.0 + i, 0.0},
            {4.0, -1.0 + i, 0.0},
            {4.0, -2.0 + i, 2.0},
            static_cast<std::uint32_t>(i / 2),
            0,
            &scene.mesh);
  }
  const CameraView view = Pinhole();
  const Isometry3d X_WC = LookFrom({0.0, 0.0, 1.0}, 0.0);
  int num_materials = 0;
  for (const VisibleEdge& edge : EdgesOf(scene, view, X_WC)) {
    if (edge.kind != EdgeKind::kMaterial) {
      EXPECT_EQ(edge.kind, EdgeKind::kBoundary);
      continue;
    }
    ++num_materials;
    for (const Vector2d& pixel : edge.pixels) {
      EXPECT_NEAR(pixel.x(), 319.5, 1e-9);
    }
    EXPECT_NEAR(std::abs(edge.pixels.front().y() - edge.pixels.back().y()),
                2.0 * 300.0 / 4.0,
                0.05);
  }
  EXPECT_EQ(num_materials, 1);
}

// The wall shares no corner with the floor, which goes on behind it.
TEST(SceneEdges, AWallThatStandsOnAFloor) {
  Scene scene;
  AddMaterial(cv::Mat3b(1, 1, {200, 200, 200}), &scene);
  AddSurface("floor", SurfaceKind::kFloor, &scene);
  AddSurface("wall", SurfaceKind::kWall, &scene);
  AddQuad({-9, -9, 0}, {9, -9, 0}, {-9, 9, 0}, 0, 0, &scene.mesh);
  AddQuad({3, -1, 0}, {3, 1, 0}, {3, -1, 2}, 0, 1, &scene.mesh);
  const CameraView view = Pinhole();
  const Isometry3d X_WC = LookFrom({0, 0, 1}, 0.0);
  int num_at_foot = 0;
  for (const VisibleEdge& edge : EdgesOf(scene, view, X_WC)) {
    if (edge.a_W.z() > 1e-6 || edge.b_W.z() > 1e-6 || edge.a_W.x() < 2.9 ||
        edge.a_W.x() > 3.1) {
      continue;
    }
    ++num_at_foot;
    for (const Vector2d& pixel : edge.pixels) {
      EXPECT_NEAR(pixel.y(), 239.5 + 100.0, 1e-6);
    }
  }
  EXPECT_EQ(num_at_foot, 1);
}

TEST(SceneEdges, OutlineOfAMover) {
  const Scene scene = FurnishedCorridor();
  const CameraView view = Pinhole();
  const Isometry3d X_WC = LookFrom({1.0, 1.0, 1.0}, 0.0);
  Isometry3d X_WP = Isometry3d::Identity();
  X_WP.translation() = Vector3d(4.0, 1.0, 0.0);
  std::vector<double> columns;
  for (const VisibleEdge& edge :
       EdgesOf(scene, view, X_WC, std::span(&X_WP, 1))) {
    if (edge.mover != 0 || edge.kind != EdgeKind::kSmooth) continue;
    const bool is_upright = (edge.a_W - edge.b_W).head<2>().norm() < 1e-6;
    if (is_upright) columns.push_back(edge.pixels.front().x());
  }
  ASSERT_EQ(columns.size(), 2u);
  std::sort(columns.begin(), columns.end());
  // The tangent of a cylinder of 0.22 m three metres away, less what its 24
  // flat sides take away.
  const double expected = 300.0 * 0.22 / 3.0;
  EXPECT_NEAR(319.5 - columns[0], expected, 0.01 * expected);
  EXPECT_NEAR(columns[1] - 319.5, expected, 0.01 * expected);
}

TEST(SceneEdges, NothingToSee) {
  EXPECT_TRUE(EdgesOf({}, Perspective(), Isometry3d::Identity()).empty());
  // From within a wall everything is beyond it.
  const Scene scene = EmptyRoom({4, 4, 2}, true);
  const Isometry3d away = LookFrom({50, 50, 1}, 0.0);
  EXPECT_TRUE(EdgesOf(scene, Perspective(), away).empty());
  SceneEdgesOptions bad;
  bad.offset_px = 0.0;
  EXPECT_THROW(SceneEdges(scene, bad), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
