#include "processes/tools/experiment/corridor_bound.h"

#include "processes/convert/corridor_convert.h"
#include "processes/support/channels.h"

#include <waymark/corridor_pose_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cstddef>
#include <string>

namespace waymark {

CorridorBound::CorridorBound(const Pose2& X_WL,
                             double sigma_m,
                             double sigma_rad,
                             LocalBus* bus) {
  fix_.has = {false, true, true};
  fix_.covariance.diagonal() << 0.0, sigma_m * sigma_m, sigma_rad * sigma_rad;
  fix_.X_WF = X_WL;
  bus->bus()->Subscribe<truth_t>(
      kTruth, Keep::All(), [this](const truth_t& m, Time) {
        truth_ = {TimeFromMicroseconds(m.utime), 0, 0, {m.x, m.y, m.heading}};
        Note();
      });
  bus->bus()->Subscribe<encoders_t>(
      kEncoders, Keep::All(), [this](const encoders_t& m, Time) {
        ticks_ = {
            TimeFromMicroseconds(m.utime), m.right_ticks, m.left_ticks, {}};
        Note();
      });
  bus->bus()->Subscribe<corridor_pose_t>(
      kCorridorPose, Keep::All(), [this](const corridor_pose_t& m, Time) {
        std::string reason;
        const auto answer = CorridorAnswerFromMessage(m, &reason);
        if (answer && answer->estimate.status == CorridorStatus::kAccepted) {
          seen_.push_back(answer->time);
        }
      });
}

void CorridorBound::Note() {
  if (!truth_ || !ticks_ || truth_->time != ticks_->time) return;
  Reading reading = *ticks_;
  reading.X_WR = truth_->X_WR;
  readings_.push_back(reading);
  truth_.reset();
  ticks_.reset();
}

void CorridorBound::Follow(PosteriorBound* bound) const {
  std::vector<Time> seen = seen_;
  std::sort(seen.begin(), seen.end());
  auto next = seen.begin();
  for (std::size_t i = 1; i < readings_.size(); ++i) {
    const Reading& from = readings_[i - 1];
    const Reading& to = readings_[i];
    bound->Predict(from.X_WR,
                   {static_cast<double>(to.right - from.right),
                    static_cast<double>(to.left - from.left)});
    // An image between two readings counts at the second: within 20 ms nothing
    // of this changes.
    for (; next != seen.end() && *next <= to.time; ++next) {
      bound->Update(to.X_WR, fix_);
    }
  }
}

}  // namespace waymark
