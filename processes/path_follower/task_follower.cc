#include "processes/path_follower/task_follower.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"

#include <array>
#include <cstdio>
#include <utility>

namespace waymark {
namespace {

constexpr Duration kPeriod{100'000};
// Messages that overtake each other; what is older is another run.
constexpr Duration kRestart{1'000'000};
// How old a saved place in the task may be.
constexpr Duration kSavePeriod{5'000'000};

}  // namespace

TaskFollower::TaskFollower(const TaskFollowerConfig& config,
                           const Role& role,
                           Bus* bus)
    : config_(config),
      role_(role),
      bus_(bus),
      tracker_(config.tracker),
      saver_(config.task_file, bus->is_offline()) {
  if (!config_.task_file.empty()) {
    try {
      kept_ = LoadTaskFile(config_.task_file);
    } catch (const InputError& error) {
      // A robot that stands is better than a process that does not start.
      load_fault_ = error.what();
    }
  }
  ShowFault();
  bus->Advertise<velocity_t>(kMotionRequest, role.name);
  bus->Advertise<task_status_t>(kTaskStatus, role.name);
  bus->Subscribe<task_t>(
      kTask, Keep::All(), [this](const task_t& m, Time) { OnTask(m); });
  bus->Subscribe<velocity_t>(
      kMotionCommand, Keep::Latest(), [this](const velocity_t& m, Time) {
        OnCommand(m);
      });
  bus->Every(kPeriod, [this](Time now) { OnTimer(now); });
}

void TaskFollower::OnTask(const task_t& message) {
  std::string reason;
  const std::optional<Task> task = TaskFromMessage(message, &reason);
  if (!task) {
    bus_->ReportBad(kTask, Bad::kContent, reason);
    return;
  }
  // Whoever sends a task may repeat it.
  if (task_ && task->source == task_->source && task->time == task_->time) {
    return;
  }
  if (task_ && task->source == task_->source && task->time < task_->time &&
      task_->time - task->time <= kRestart) {
    bus_->ReportBad(kTask, Bad::kContent, "time goes back");
    return;
  }
  kept_.reset();
  tracker_.Clear();
  task_.reset();
  num_reached_ = 0;
  if (task->kind == role_.kind) {
    task_ = task;
    tracker_.Start(task->waypoints, task->max_speed);
  }
  state_ = TrackState::kIdle;  // Until the next pose.
  Save(pose_time_.value_or(task->time));
}

void TaskFollower::OnCommand(const velocity_t& message) {
  guard_reason_ = message.source == role_.name ? message.reason : "";
}

bool TaskFollower::IsLate(Time t) {
  const bool is_late =
      pose_time_ && t < *pose_time_ && *pose_time_ - t <= kRestart;
  if (is_late) {
    bus_->ReportBad(role_.pose_channel, Bad::kContent, "time goes back");
  } else {
    pose_time_ = t;
    pose_arrived_ = bus_->now();
  }
  return is_late;
}

void TaskFollower::OnPose(std::int64_t utime,
                          const std::optional<Pose2>& X_WR,
                          const std::string& reason) {
  if (!X_WR) {
    bus_->ReportBad(role_.pose_channel, Bad::kContent, reason);
    return;
  }
  const Time t = TimeFromMicroseconds(utime);
  if (IsLate(t)) return;
  Resume(t);
  Finish(t, tracker_.Update(t, *X_WR));
}

void TaskFollower::OnNoPose(Time t, const std::string& reason) {
  if (!IsLate(t)) Finish(t, tracker_.Hold(t, reason));
}

void TaskFollower::OnTimer(Time now) {
  ShowFault();
  if (!pose_time_) {
    if (task_ && tracker_.is_active()) {
      task_status_t status = ToMessage(
          tracker_.Hold(std::nullopt, "no pose yet"), now, status_seq_++);
      status.source = role_.name;
      status.task_utime = Microseconds(task_->time);
      bus_->Publish(kTaskStatus, status);
    }
    return;
  }
  const double age = Seconds(now - pose_arrived_);
  if (age < config_.pose_timeout_s) return;
  std::array<char, 64> text{};
  std::snprintf(text.data(),
                text.size(),
                "no %s for %.1f s",
                std::string(role_.pose_channel).c_str(),
                age);
  Finish(*pose_time_, tracker_.Hold(*pose_time_, text.data()));
}

void TaskFollower::Resume(Time t) {
  if (!kept_) return;
  const TaskProgress kept = *std::exchange(kept_, std::nullopt);
  const double age = Seconds(t - kept.time);
  // A restart of everything may have set time back.
  if (std::abs(age) > config_.resume_within_s || kept.task.kind != role_.kind) {
    return;
  }
  task_ = kept.task;
  num_reached_ = kept.num_reached;
  tracker_.Start(task_->waypoints, task_->max_speed, kept.num_reached);
}

void TaskFollower::Finish(Time t, TrackReport report) {
  if (report.state == TrackState::kWaiting && !guard_reason_.empty()) {
    report.reason += ": " + guard_reason_;
  }
  velocity_t request;
  request.utime = Microseconds(t);
  request.seq = request_seq_++;
  request.source = role_.name;
  request.forward = report.velocity.forward;
  request.turn_rate = report.velocity.turn_rate;
  if (report.velocity.is_zero()) {
    request.reason =
        report.reason.empty() ? NameOf(report.state) : report.reason;
  }
  bus_->Publish(kMotionRequest, request);
  task_status_t status = ToMessage(report, t, status_seq_++);
  status.source = role_.name;
  status.task_utime = task_ ? Microseconds(task_->time) : 0;
  bus_->Publish(kTaskStatus, status);
  const bool is_news =
      state_ != report.state || num_reached_ != report.num_reached;
  state_ = report.state;
  num_reached_ = report.num_reached;
  const bool is_due = tracker_.is_active() &&
                      (!saved_ || t < *saved_ || t - *saved_ >= kSavePeriod);
  if (is_news || is_due) Save(t);
}

void TaskFollower::Save(Time t) {
  if (config_.task_file.empty()) return;
  saved_ = t;
  std::optional<TaskProgress> progress;
  if (task_ && tracker_.is_active()) {
    progress = TaskProgress{*task_, t, num_reached_};
  }
  saver_.Save(TextOfTask(progress));
  load_fault_.clear();
  ShowFault();
}

void TaskFollower::ShowFault() {
  // Where a file cannot be written driving goes on.
  const std::string fault = saver_.fault();
  bus_->SetFault(fault.empty() ? load_fault_ : fault);
}

}  // namespace waymark
