#include "processes/tour_driver/tour_driver_process.h"

#include "processes/convert/task_convert.h"
#include "processes/support/channels.h"

#include <string>

namespace waymark {

TourDriverProcess::TourDriverProcess(const Config& config, Bus* bus)
    : follower_(config,
                {.name = kName, .kind = "tour", .pose_channel = kTruth},
                bus) {
  bus->Subscribe<truth_t>(
      kTruth, Keep::Latest(), [this](const truth_t& m, Time) { OnTruth(m); });
}

void TourDriverProcess::OnTruth(const truth_t& message) {
  std::string reason;
  const auto X_WR = PoseFromMessage(message, &reason);
  if (X_WR && message.has_heading == 0) {
    follower_.OnNoPose(TimeFromMicroseconds(message.utime),
                       "TRUTH has no heading");
  } else {
    follower_.OnPose(message.utime, X_WR, reason);
  }
}

}  // namespace waymark
