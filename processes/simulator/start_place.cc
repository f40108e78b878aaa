#include "processes/simulator/start_place.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace waymark {
namespace {

// Of the pose, m and rad: beyond all worlds, and grids still have an index.
constexpr double kFarthest = 1e6;

}  // namespace

std::string FaultOfStart(const Pose2& X_WR,
                         double radius,
                         const WalkArea& area,
                         const World& world,
                         const People& people) {
  // Of what is not finite, too.
  if (!(X_WR.vector().cwiseAbs().maxCoeff() <= kFarthest)) {
    return "its numbers must be within +-1e6";
  }
  const std::string robot = fmt::format(
      "a robot of radius {:g} m at x {:.3f}, y {:.3f}", radius, X_WR.x, X_WR.y);
  if (const auto nearest = area.map().Nearest(X_WR.position(), radius)) {
    return fmt::format("{} would touch something at x {:.3f}, y {:.3f}",
                       robot,
                       nearest->p_W.x(),
                       nearest->p_W.y());
  }
  if (area.Clearance(X_WR.position()) < 0.0) {
    return robot + " would be outside of all rooms, or inside something";
  }
  const std::vector<Pose2> X_WP = people.PosesAt(0.0, X_WR);
  for (std::size_t i = 0; i < X_WP.size(); ++i) {
    const WorldPerson& person = world.people[i];
    if (person.motion == PersonMotion::kBeside) continue;
    const Eigen::Vector2d at = X_WP[i].position();
    if ((at - X_WR.position()).norm() >= radius + kPersonRadius) continue;
    return fmt::format(
        "{} would touch who {} at x {:.3f}, y {:.3f} ({})",
        robot,
        person.motion == PersonMotion::kStand ? "stands" : "walks",
        at.x(),
        at.y(),
        person.where);
  }
  return "";
}

}  // namespace waymark
