#include "processes/path_follower/path_follower_process.h"

#include "processes/convert/task_convert.h"
#include "processes/support/channels.h"

#include <string>

namespace waymark {

PathFollowerProcess::PathFollowerProcess(const Config& config, Bus* bus)
    : follower_(config,
                {.name = kName, .kind = "waypoints", .pose_channel = kPose},
                bus) {
  bus->Subscribe<pose_t>(
      kPose, Keep::Latest(), [this](const pose_t& m, Time) { OnPose(m); });
}

void PathFollowerProcess::OnPose(const pose_t& message) {
  std::string reason;
  const auto X_WR = PoseFromMessage(message, &reason);
  if (X_WR && message.is_known == 0) {
    follower_.OnNoPose(TimeFromMicroseconds(message.utime),
                       "pose unknown: " + message.reason);
  } else {
    follower_.OnPose(message.utime, X_WR, reason);
  }
}

}  // namespace waymark
