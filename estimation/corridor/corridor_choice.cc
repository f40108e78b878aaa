#include "estimation/corridor/corridor_choice.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr double kUnknownWidth = 3.0;  // m.
constexpr double kNumSigmas = 3.0;

CorridorPrior PriorIn(const CorridorGeometry& corridor,
                      const PoseEstimate& pose) {
  const double heading = corridor.X_WL.heading;
  Eigen::Matrix3d R_LW = Eigen::Matrix3d::Identity();
  R_LW.topLeftCorner<2, 2>() << std::cos(heading), std::sin(heading),
      -std::sin(heading), std::cos(heading);
  return {Between(corridor.X_WL, pose.X_WR),
          R_LW * pose.covariance * R_LW.transpose()};
}

bool IsIn(const CorridorGeometry& corridor, const CorridorPrior& prior) {
  const double along = kNumSigmas * std::sqrt(prior.covariance(0, 0));
  const double across = kNumSigmas * std::sqrt(prior.covariance(1, 1));
  const double half = 0.5 * corridor.width.value_or(kUnknownWidth);
  return prior.X_LR.x >= corridor.x_min - along &&
         prior.X_LR.x <= corridor.x_max + along &&
         std::abs(prior.X_LR.y) <= half + across;
}

}  // namespace

CorridorChoice ChooseCorridor(std::span<const CorridorGeometry> corridors,
                              const std::optional<PoseEstimate>& pose) {
  CorridorChoice choice;
  if (!pose) {
    if (corridors.size() == 1) {
      choice.corridor = 0;
    } else {
      choice.reason = "no pose that says in which corridor";
    }
    return choice;
  }
  double most_along = -1.0;
  for (std::size_t i = 0; i < corridors.size(); ++i) {
    const CorridorPrior prior = PriorIn(corridors[i], *pose);
    const double along = std::abs(std::cos(prior.X_LR.heading));
    if (!IsIn(corridors[i], prior) || along <= most_along) continue;
    most_along = along;
    choice.corridor = i;
    choice.prior = prior;
  }
  if (!choice.corridor) choice.reason = "in no known corridor";
  return choice;
}

}  // namespace waymark
