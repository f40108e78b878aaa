// Where on the floor of a world a person or robot can be.
#pragma once

#include "drivers/simulator/world.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace waymark {

// The plan of a world: walls with their holes, leaves of doors, pillars,
// furniture, floor plans. Mesh files are not in it.
class WalkArea {
 public:
  // Throws InputError where ResolveLayout() does, or a floor plan cannot be
  // read.
  explicit WalkArea(const World& world);

  // Distance of a point from the nearest thing that stands, m; negative where
  // no floor is: outside the rooms, in a pillar or in furniture. 1e3 where the
  // world has no plan at all. O(number of segments).
  [[nodiscard]] double Clearance(const Eigen::Vector2d& p_W) const;

  using Segment = std::array<Eigen::Vector2d, 2>;
  [[nodiscard]] const std::vector<Segment>& segments() const {
    return segments_;
  }
  using Outline = std::vector<Eigen::Vector2d>;
  [[nodiscard]] const std::vector<Outline>& floors() const { return floors_; }
  [[nodiscard]] const std::vector<Outline>& solids() const { return solids_; }

 private:
  void AddWalls(const World& world);
  void AddFloorPlans(const World& world);
  void AddSolid(Outline outline);

  std::vector<Segment> segments_;
  std::vector<Outline> floors_;  // Rooms, and the floor in doorways.
  std::vector<Outline> solids_;
  std::vector<Outline> plan_walls_;  // As FloorPlan::outlines, in W.
  std::vector<Outline> plan_grounds_;
};

// Outline of what stands on the floor, counter-clockwise.
[[nodiscard]] WalkArea::Outline OutlineOf(const WorldPillar& pillar);
[[nodiscard]] WalkArea::Outline OutlineOf(const WorldFurniture& piece);

}  // namespace waymark
