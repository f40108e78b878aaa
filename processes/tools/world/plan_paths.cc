#include "processes/tools/world/plan_paths.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/pose2.h"
#include "processes/support/channels.h"
#include "processes/support/decode.h"
#include "processes/support/log_file.h"

#include <waymark/pose_t.hpp>
#include <waymark/truth_t.hpp>

#include <optional>

namespace waymark {

std::vector<PlanPath> PathsOf(const std::string& log) {
  PlanPath truth{PlanPath::Kind::kDriven, {}};
  PlanPath odometry{PlanPath::Kind::kDeadReckoning, {}};
  PlanPath estimate{PlanPath::Kind::kBelieved, {}};
  std::vector<Pose2> X_OR;
  std::optional<Pose2> first_truth;
  std::optional<Pose2> first_estimate;
  LogReader reader(log);
  while (const auto event = reader.Next()) {
    if (event->channel == kTruth) {
      const auto message = DecodeMessage<truth_t>(event->data);
      if (!message) continue;
      truth.points.emplace_back(message->x, message->y);
      if (!first_truth && message->has_heading != 0) {
        first_truth = Pose2{message->x, message->y, message->heading};
      }
    } else if (event->channel == kPose || event->channel == kOdometry) {
      const auto message = DecodeMessage<pose_t>(event->data);
      if (!message || message->is_known == 0) continue;
      const Pose2 pose = Pose2::FromVector(
          {message->pose_W[0], message->pose_W[1], message->pose_W[2]});
      if (event->channel == kOdometry) {
        X_OR.push_back(pose);
        continue;
      }
      estimate.points.push_back(pose.position());
      if (!first_estimate) first_estimate = pose;
    }
  }
  if (truth.points.empty() && estimate.points.empty()) {
    throw InputError(log + ": has neither TRUTH nor POSE");
  }
  const auto start = first_truth ? first_truth : first_estimate;
  if (start && !X_OR.empty()) {
    const Pose2 X_WO = *start * Inverse(X_OR.front());
    for (const Pose2& pose : X_OR) {
      odometry.points.push_back((X_WO * pose).position());
    }
  }
  return {truth, odometry, estimate};
}

}  // namespace waymark
