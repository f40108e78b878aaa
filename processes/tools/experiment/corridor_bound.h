// How well the wheels could be known after a run in a corridor.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/filter/posterior_bound.h"
#include "estimation/geometry/pose2.h"
#include "processes/support/local_bus.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace waymark {

// Listens to TRUTH, ENCODERS and CORRIDOR_POSE: of the answers that were
// accepted only the times matter, and the true errors of the model that they
// come from.
class CorridorBound {
 public:
  // Outlived by `bus`'s world.
  CorridorBound(const Pose2& X_WL,
                double sigma_m,
                double sigma_rad,
                LocalBus* bus);

  // Moves `bound` along the run, which is over.
  void Follow(PosteriorBound* bound) const;

 private:
  struct Reading {
    Time time;
    std::int64_t right = 0;
    std::int64_t left = 0;
    Pose2 X_WR;
  };
  void Note();

  AbsoluteFix fix_;               // In L, without a value.
  std::optional<Reading> truth_;  // Waits for the ticks of its time, and
  std::optional<Reading> ticks_;  // these for it.
  std::vector<Reading> readings_;
  std::vector<Time> seen_;
};

}  // namespace waymark
