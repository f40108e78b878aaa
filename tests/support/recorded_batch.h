// Recordings by others as batch problems.
#pragma once

#include "estimation/batch/batch_types.h"
#include "logs/import/recording.h"

namespace waymark {

// Every reference sample becomes a fix of source recording.reference.source;
// relative motions are taken as they are. `sigma` (m, m, rad) is that of a fix;
// nullopt: as the recording states it.
[[nodiscard]] BatchLog BatchLogFromRecording(
    const Recording& recording,
    const std::optional<Eigen::Vector3d>& sigma = std::nullopt);

// Root mean square distance between dead reckoning with these parameters and
// the reference samples, m, where dead reckoning starts at X_WR at the time of
// the first sample. The reference's clock is `time_offset_s` ahead of the
// encoders'. Samples outside the readings do not count.
[[nodiscard]] double DeadReckoningRmse(const Recording& recording,
                                       const WheelParameters& parameters,
                                       const Pose2& X_WR,
                                       const Eigen::Vector2d& p_RS,
                                       double time_offset_s = 0.0);

}  // namespace waymark
