#include "drivers/simulator/walk_area.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/floor_plan.h"
#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/world_layout.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace waymark {
namespace {

constexpr double kNoPlan = 1e3;  // Farther than any wall.
constexpr int kPillarSides = 24;

bool IsInAny(const std::vector<WalkArea::Outline>& outlines,
             const Eigen::Vector2d& p) {
  return std::any_of(outlines.begin(), outlines.end(), [&](const auto& o) {
    return IsInside(o, p);
  });
}

bool IsInOddNumber(const std::vector<WalkArea::Outline>& outlines,
                   const Eigen::Vector2d& p) {
  return std::count_if(outlines.begin(),
                       outlines.end(),
                       [&](const auto& o) { return IsInside(o, p); }) %
             2 ==
         1;
}

// What fills its outline from the floor up; of all else the mesh says where
// there is room.
bool IsClosed(FurnitureKind kind) {
  return kind == FurnitureKind::kCabinet || kind == FurnitureKind::kShelf ||
         kind == FurnitureKind::kSofa || kind == FurnitureKind::kBin ||
         kind == FurnitureKind::kBox;
}

SceneMesh MeshOf(const World& world) {
  // A world without anything has no scene.
  if (world.rooms.empty() && world.floor_plans.empty() &&
      world.models.empty()) {
    return {};
  }
  return BuildScene(world, SceneLooks::kPlain).mesh;
}

WalkArea::Outline RectangleAt(const Eigen::Vector2d& at,
                              double heading,
                              double depth,
                              double width) {
  const Eigen::Rotation2Dd R(heading);
  WalkArea::Outline outline;
  for (const auto& [x, y] :
       {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    outline.push_back(at + R * Eigen::Vector2d(x * depth, y * width));
  }
  return outline;
}

}  // namespace

WalkArea::Outline OutlineOf(const WorldPillar& pillar) {
  if (pillar.shape == PillarShape::kSquare) {
    return RectangleAt(pillar.at, pillar.heading, pillar.size, pillar.size);
  }
  WalkArea::Outline outline;
  for (int i = 0; i < kPillarSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPillarSides;
    outline.push_back(pillar.at +
                      pillar.size / 2.0 *
                          Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

WalkArea::Outline OutlineOf(const WorldFurniture& piece) {
  return RectangleAt(piece.at, piece.heading, piece.size.x(), piece.size.y());
}

WalkArea::WalkArea(const World& world, double height)
    : WalkArea(world, MeshOf(world), height) {}

WalkArea::WalkArea(const World& world, const SceneMesh& mesh, double height)
    : map_(OutlineOfMesh(mesh, {.high = height})) {
  AddWalls(world);
  for (const WorldPillar& pillar : world.pillars) AddSolid(OutlineOf(pillar));
  for (const WorldFurniture& piece : world.furniture) {
    if (piece.z >= height) continue;
    IsClosed(piece.kind) ? AddSolid(OutlineOf(piece))
                         : AddOutline(OutlineOf(piece));
  }
  AddFloorPlans(world);
  if (floors_.empty() && plan_grounds_.empty() && !world.models.empty()) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector3f& p : mesh.positions) {
      box.extend(p.head<2>().cast<double>());
    }
    const Eigen::Vector2d low = box.min();
    const Eigen::Vector2d high = box.max();
    floors_.push_back({low, {high.x(), low.y()}, high, {low.x(), high.y()}});
  }
}

void WalkArea::AddOutline(const Outline& outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    segments_.push_back({outline[i], outline[(i + 1) % outline.size()]});
  }
}

void WalkArea::AddSolid(Outline outline) {
  AddOutline(outline);
  solids_.push_back(std::move(outline));
}

void WalkArea::AddWalls(const World& world) {
  const Layout layout = ResolveLayout(world);
  for (std::size_t r = 0; r < world.rooms.size(); ++r) {
    floors_.push_back(world.rooms[r].outline);
    for (std::size_t w = 0; w < world.rooms[r].outline.size(); ++w) {
      const WallFrame frame = FrameOfWall(world.rooms[r], static_cast<int>(w));
      double begin = 0.0;
      for (const WallHole& hole : layout.holes[r][w]) {
        if (hole.begin > begin) {
          segments_.push_back({frame.At(begin), frame.At(hole.begin)});
        }
        begin = hole.end;
      }
      if (frame.length > begin) {
        segments_.push_back({frame.At(begin), frame.At(frame.length)});
      }
    }
  }
  for (const Passage& passage : layout.passages) {
    const WallFrame frame = FrameOfWall(
        world.rooms[static_cast<std::size_t>(passage.room)], passage.wall);
    const WallHole& hole = passage.hole;
    const double y = -passage.depth;
    segments_.push_back({frame.At(hole.begin), frame.At(hole.begin, y)});
    segments_.push_back({frame.At(hole.end), frame.At(hole.end, y)});
    floors_.push_back({frame.At(hole.begin, y),
                       frame.At(hole.end, y),
                       frame.At(hole.end),
                       frame.At(hole.begin)});
    if (passage.door == nullptr) continue;
    const DoorLeaf leaf = LeafOf(world, passage);
    const auto at = [&](double x, double ly) -> Eigen::Vector2d {
      return (leaf.X_WD * Eigen::Vector3d(x, ly, 0.0)).head<2>();
    };
    AddSolid({at(0.0, leaf.low),
              at(leaf.width, leaf.low),
              at(leaf.width, leaf.high),
              at(0.0, leaf.high)});
  }
}

void WalkArea::AddFloorPlans(const World& world) {
  for (const WorldFloorPlan& plan : world.floor_plans) {
    FloorPlanOptions options;
    options.metres_per_pixel = plan.metres_per_pixel;
    const FloorPlan loaded = LoadFloorPlan(plan.image, options);
    for (Outline outline : loaded.outlines) {
      for (Eigen::Vector2d& p : outline) p += plan.at;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        segments_.push_back({outline[i], outline[(i + 1) % outline.size()]});
      }
      plan_walls_.push_back(std::move(outline));
    }
    const Eigen::Vector2d high = plan.at + loaded.size;
    plan_grounds_.push_back(
        {plan.at, {high.x(), plan.at.y()}, high, {plan.at.x(), high.y()}});
  }
}

bool WalkArea::IsOnFloor(const Eigen::Vector2d& p_W) const {
  return IsInAny(floors_, p_W) ||
         (IsInAny(plan_grounds_, p_W) && !IsInOddNumber(plan_walls_, p_W));
}

double WalkArea::Clearance(const Eigen::Vector2d& p_W) const {
  if (floors_.empty() && plan_grounds_.empty()) return kNoPlan;
  const auto nearest = map_.Nearest(p_W, kNoPlan);
  const double distance = nearest ? nearest->distance : kNoPlan;
  return IsOnFloor(p_W) && !IsInAny(solids_, p_W) ? distance : -distance;
}

}  // namespace waymark
