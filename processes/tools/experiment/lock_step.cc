#include "processes/tools/experiment/lock_step.h"

#include "processes/support/channels.h"

#include <waymark/base_status_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cmath>

namespace waymark {

LockStep::LockStep(Time start, const std::string& log_path)
    : start_(start), bus_(start) {
  if (!log_path.empty()) {
    log_ = std::make_unique<LogWriter>(log_path, IfExists::kReplace);
  }
  bus_.RecordTo([this](const RawMessage& message) { Note(message); });
}

bool LockStep::Run(const std::function<bool(const Trip&)>& is_over,
                   Duration limit) {
  constexpr Duration kLook = std::chrono::milliseconds(50);
  bool is_done = false;
  for (Time t = start_; !is_done && t < start_ + limit;) {
    t = std::min(t + kLook, start_ + limit);
    bus_.RunUntil(t);
    is_done = is_over(trip_);
  }
  for (const auto& process : processes_) process->Finish();
  if (log_) log_->Close();
  return is_done;
}

double LockStep::duration_s() const {
  return Seconds(bus_.now() - start_);
}

void LockStep::Note(const RawMessage& message) {
  if (log_) log_->Write(message.log_time, message.channel, message.data);
  if (message.channel == kTruth) {
    const auto truth = DecodeMessage<truth_t>(message.data);
    if (!truth) return;
    const Pose2 X_WR{truth->x, truth->y, truth->heading};
    if (trip_.X_WR) {
      trip_.way_m += (X_WR.position() - trip_.X_WR->position()).norm();
    }
    trip_.X_WR = X_WR;
    truth_utime_ = truth->utime;
  } else if (message.channel == kBase) {
    const auto base = DecodeMessage<base_status_t>(message.data);
    if (base) trip_.num_touches = base->num_contacts;
  } else if (message.channel == kTaskStatus) {
    auto status = DecodeMessage<task_status_t>(message.data);
    if (status) trip_.task = std::move(*status);
  } else if (message.channel == kPose) {
    const auto pose = DecodeMessage<pose_t>(message.data);
    if (!pose || pose->is_known == 0 || !trip_.X_WR ||
        pose->utime != truth_utime_) {
      return;
    }
    trip_.pose_error_m = std::hypot(pose->pose_W[0] - trip_.X_WR->x,
                                    pose->pose_W[1] - trip_.X_WR->y);
    trip_.max_pose_error_m =
        std::max(trip_.max_pose_error_m, *trip_.pose_error_m);
  }
}

}  // namespace waymark
