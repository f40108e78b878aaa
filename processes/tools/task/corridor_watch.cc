#include "processes/tools/task/corridor_watch.h"

#include "estimation/corridor/corridor_types.h"
#include "estimation/geometry/angle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

// What has no counterpart yet: a second of both, at any rate of theirs.
constexpr std::size_t kMaxWaiting = 200;

std::optional<Pose2> PoseOf(double x, double y, double heading) {
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(heading)) {
    return std::nullopt;
  }
  return Pose2{x, y, heading};
}

}  // namespace

void CorridorWatch::OnAnswer(const corridor_pose_t& message) {
  ++num_images_;
  ++statuses_[CorridorStatusFromName(message.status) ? message.status
                                                     : "unknown"];
  if (message.corridor.empty()) return;
  const double* X = message.corridor_W;
  if (const auto pose = PoseOf(X[0], X[1], X[2])) X_WL_ = pose;
}

void CorridorWatch::OnPose(const pose_t& message) {
  if (message.is_known == 0) return;
  waiting_[message.utime].estimated =
      PoseOf(message.pose_W[0], message.pose_W[1], message.pose_W[2]);
  Compare(message.utime);
}

void CorridorWatch::OnTruth(const truth_t& message) {
  if (message.has_heading == 0) return;
  waiting_[message.utime].truth = PoseOf(message.x, message.y, message.heading);
  Compare(message.utime);
}

void CorridorWatch::Compare(std::int64_t utime) {
  // Time went back: what waits for its like will never meet it.
  constexpr std::int64_t kMaxApartUs = 10'000'000;
  if (!waiting_.empty() && waiting_.rbegin()->first - utime > kMaxApartUs) {
    const Pair own = waiting_[utime];
    waiting_.clear();
    waiting_[utime] = own;
  }
  const Pair pair = waiting_[utime];
  if (pair.estimated && pair.truth) {
    waiting_.erase(utime);
    if (!X_WL_) return;
    const Pose2 believed_LR = Between(*X_WL_, *pair.estimated);
    const Pose2 X_LR = Between(*X_WL_, *pair.truth);
    has_error_ = true;
    error_m_ = std::max(error_m_, std::abs(believed_LR.y - X_LR.y));
    error_rad_ = std::max(
        error_rad_, std::abs(WrapAngle(believed_LR.heading - X_LR.heading)));
  }
  if (waiting_.size() > kMaxWaiting) waiting_.erase(waiting_.begin());
}

std::string CorridorWatch::News() {
  if (num_images_ == 0) return "";
  const std::int64_t accepted = statuses_[NameOf(CorridorStatus::kAccepted)];
  std::string text = fmt::format("{} of {} images", accepted, num_images_);
  statuses_.erase(NameOf(CorridorStatus::kAccepted));
  const auto most = std::max_element(
      statuses_.begin(), statuses_.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      });
  if (most != statuses_.end()) text += " (" + most->first + ")";
  if (has_error_) {
    text += fmt::format(", off by {:.1f} cm, {:.2f} deg",
                        100.0 * error_m_,
                        DegreesFromRadians(error_rad_));
  }
  num_images_ = 0;
  statuses_.clear();
  has_error_ = false;
  error_m_ = 0.0;
  error_rad_ = 0.0;
  return text;
}

}  // namespace waymark
