// What a round robot can bump into, seen from above: walls and people.
#pragma once

#include "drivers/simulator/mesh_outline.h"
#include "estimation/geometry/pose2.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace waymark {

// A person, or anything else that is round and moves.
struct Disc2 {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double radius = 0.25;
};

// Motion at constant speeds: `distance` along the way, m (negative: backward),
// while the heading turns by `turn`, rad.
struct ArcMotion {
  double distance = 0.0;
  double turn = 0.0;
};

// X_R0R1 after a share of the motion.
[[nodiscard]] Pose2 PoseAlong(const ArcMotion& motion, double share);

struct NearestObstacle {
  double distance = 0.0;  // To the nearest point, m, at least 0.
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  // That point.
};

struct RayHit {
  double distance = 0.0;   // m.
  double incidence = 0.0;  // Angle between ray and normal, in [0, pi / 2].
  double to_end = 0.0;     // To the nearer end of the segment, where edges and
                           // corners are, m; infinite on discs.
};

struct ArcContact {
  double share = 0.0;  // Of the motion that is free, in [0, 1].
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  // Where they touch.
};

// Segments in a grid. Every query takes the people too, since they move.
class ObstacleMap {
 public:
  // Throws std::logic_error for an end that is not finite.
  explicit ObstacleMap(std::vector<Segment2> segments);

  [[nodiscard]] const std::vector<Segment2>& segments() const {
    return segments_;
  }
  // Corners of the box that holds all segments; both zero without any.
  [[nodiscard]] const Eigen::Vector2d& low() const { return low_; }
  [[nodiscard]] const Eigen::Vector2d& high() const { return high_; }

  // nullopt where nothing is as near as max_distance.
  [[nodiscard]] std::optional<NearestObstacle> Nearest(
      const Eigen::Vector2d& p_W,
      double max_distance,
      std::span<const Disc2> discs = {}) const;

  // First thing within max_distance along `bearing` (rad, in W).
  [[nodiscard]] std::optional<RayHit> CastRay(
      const Eigen::Vector2d& p_W,
      double bearing,
      double max_distance,
      std::span<const Disc2> discs = {}) const;

  // Where a disc of `radius` that starts at X_WR first touches something;
  // nullopt where its way is free. Exact for the chords of the arc, which lie
  // within kMaxSagitta of it, however long the motion is: nothing is passed
  // through. A disc that already touches or overlaps something may move away
  // from it or along it, not toward it.
  [[nodiscard]] std::optional<ArcContact> FirstContact(
      const Pose2& X_WR,
      const ArcMotion& motion,
      double radius,
      std::span<const Disc2> discs = {}) const;

  static constexpr double kMaxSagitta = 1e-5;  // m.

 private:
  struct Box {
    int x0, y0, x1, y1;  // Cells, ends included, clamped to the grid.
  };
  [[nodiscard]] int CellX(double x) const;
  [[nodiscard]] int CellY(double y) const;
  [[nodiscard]] Box BoxOf(const Eigen::Vector2d& low,
                          const Eigen::Vector2d& high) const;
  [[nodiscard]] std::size_t IndexOf(int x, int y) const;
  // Indices of the segments that touch a cell.
  [[nodiscard]] std::span<const std::uint32_t> InCell(int x, int y) const;

  std::vector<Segment2> segments_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d high_ = Eigen::Vector2d::Zero();
  double cell_ = 0.0;  // m.
  int num_x_ = 0;
  int num_y_ = 0;
  std::vector<std::uint32_t> cell_starts_;  // num_x * num_y + 1.
  std::vector<std::uint32_t> cell_segments_;
};

}  // namespace waymark
