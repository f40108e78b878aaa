// Where a simulated robot may start.
#pragma once

#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world.h"
#include "estimation/geometry/pose2.h"

#include <string>

namespace waymark {

// Why a robot of `radius` cannot start at X_WR while people are where they are
// at time 0: one line without its end; empty where it can. Who goes beside the
// robot makes room. `people` and `area` are those of `world`.
[[nodiscard]] std::string FaultOfStart(const Pose2& X_WR,
                                       double radius,
                                       const WalkArea& area,
                                       const World& world,
                                       const People& people);

}  // namespace waymark
