// Where on the floor of a world a person or robot can be.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "drivers/simulator/scene.h"
#include "drivers/simulator/world.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace waymark {

inline constexpr double kPersonHeight = 1.8;  // Of what people stay out of, m.

// What is free for a round body of a height: on a floor, and out of all that
// the mesh has at heights between the floor and its top. Robots, people,
// checks and experiments all have it from here.
class WalkArea {
 public:
  // The mesh is that of BuildScene(world), whatever its looks. Throws
  // InputError where ResolveLayout() does, or a floor plan cannot be read.
  WalkArea(const World& world, const SceneMesh& mesh, double height);
  // Builds the mesh, and throws as BuildScene() does.
  explicit WalkArea(const World& world, double height = kPersonHeight);

  // Distance of a point from the nearest thing that stands, m; not positive
  // where no floor is: outside the rooms, in a pillar or in closed furniture;
  // in a world of models alone outside the rectangle about them. 1e3 where the
  // world has nothing at all.
  [[nodiscard]] double Clearance(const Eigen::Vector2d& p_W) const;
  // Of a room, a doorway, a floor plan, or models where they are all.
  [[nodiscard]] bool IsOnFloor(const Eigen::Vector2d& p_W) const;
  // What the body touches. Where a point's clearance is positive that is its
  // distance from this.
  [[nodiscard]] const ObstacleMap& map() const { return map_; }

  // The plan, without models.
  using Segment = std::array<Eigen::Vector2d, 2>;
  [[nodiscard]] const std::vector<Segment>& segments() const {
    return segments_;
  }
  using Outline = std::vector<Eigen::Vector2d>;
  [[nodiscard]] const std::vector<Outline>& floors() const { return floors_; }

 private:
  void AddWalls(const World& world);
  void AddFloorPlans(const World& world);
  void AddOutline(const Outline& outline);
  void AddSolid(Outline outline);

  ObstacleMap map_;
  std::vector<Segment> segments_;
  std::vector<Outline> floors_;      // Rooms, and the floor in doorways.
  std::vector<Outline> solids_;      // What one can be inside of.
  std::vector<Outline> plan_walls_;  // As FloorPlan::outlines, in W.
  std::vector<Outline> plan_grounds_;
};

// Outline of what stands on the floor, counter-clockwise.
[[nodiscard]] WalkArea::Outline OutlineOf(const WorldPillar& pillar);
[[nodiscard]] WalkArea::Outline OutlineOf(const WorldFurniture& piece);

}  // namespace waymark
