#include "processes/collision_guard/collision_guard_process.h"

#include "processes/convert/message_check.h"
#include "processes/convert/motion_convert.h"
#include "processes/support/channels.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace waymark {
namespace {

constexpr Duration kPeriod{50'000};
// Messages that overtake each other, or come twice; what is older is another
// run.
constexpr Duration kRestart{1'000'000};
// More senders than these are a fault of one that changes its name: those that
// were not heard of for longest are forgotten.
constexpr std::size_t kMaxSources = 100;

bool IsLate(Time t, Time newest) {
  return t < newest && newest - t <= kRestart;
}

std::string Text(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace

CollisionGuardProcess::CollisionGuardProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      latch_(config.stop_file),
      guard_(config.guard),
      choice_(DurationFromSeconds(config.request_timeout_s),
              config.preferred_source) {
  bus->Advertise<velocity_t>(kMotionCommand);
  bus->Subscribe<stop_t>(
      kStop, Keep::All(), [this](const stop_t& m, Time t) { OnStop(m, t); });
  bus->Subscribe<planar_lidar_t>(
      kRanges, Keep::Latest(), [this](const planar_lidar_t& m, Time) {
        OnRanges(m);
      });
  bus->Subscribe<base_status_t>(
      kBase, Keep::All(), [this](const base_status_t& m, Time t) {
        OnBase(m, t);
      });
  // All, since several sources share the channel.
  bus->Subscribe<velocity_t>(
      kMotionRequest, Keep::All(100), [this](const velocity_t& m, Time t) {
        OnRequest(m, t);
      });
  bus->Every(kPeriod, [this](Time now) { OnTimer(now); });
}

CollisionGuardProcess::Source& CollisionGuardProcess::SourceOf(
    const std::string& name) {
  if (sources_.find(name) == sources_.end() && sources_.size() >= kMaxSources) {
    sources_.erase(std::min_element(
        sources_.begin(), sources_.end(), [](const auto& a, const auto& b) {
          return a.second.last_use < b.second.last_use;
        }));
  }
  Source& source = sources_[name];
  source.last_use = ++num_uses_;
  return source;
}

void CollisionGuardProcess::NoteTime(Time t) {
  if (IsLate(t, newest_)) return;
  newest_ = t;
  arrived_ = bus_->now();
}

void CollisionGuardProcess::NoteRobotTime(Time t) {
  if (robot_time_ && IsLate(t, *robot_time_)) return;
  robot_time_ = t;
  robot_arrived_ = bus_->now();
  NoteTime(t);
}

// A host whose clock is wrong must not move the time back: that would be
// another run, in which nothing is known of commands in force and of bumpers.
void CollisionGuardProcess::NoteOtherTime(Time t, const std::string& source) {
  if (!robot_time_) return NoteTime(t);
  const Time now = bus_->now();
  const Time expected = *robot_time_ + (now - robot_arrived_);
  if (t <= expected + kRestart && expected <= t + kRestart) return NoteTime(t);
  NoteTime(std::max(newest_, expected));
  clock_fault_ = "clock of " + source +
                 Text(" is off the robot's by %.1f s", Seconds(t - expected));
  clock_fault_time_ = now;
}

void CollisionGuardProcess::OnRequest(const velocity_t& message, Time t) {
  std::string reason;
  Velocity velocity;
  std::string why = message.reason;
  if (CheckVelocity(message, &reason)) {
    velocity = {message.forward, message.turn_rate};
  } else {
    // Answered all the same: it asks for nothing that could be done.
    bus_->ReportBad(kMotionRequest, Bad::kContent, reason);
    if (!CheckTime("utime", message.utime, &reason)) return;
    why = "bad request: " + reason;
  }
  Source& source = SourceOf(message.source);
  if (source.request_time && IsLate(t, *source.request_time)) {
    bus_->ReportBad(kMotionRequest, Bad::kContent, "time goes back");
    return;
  }
  source.request_time = t;
  request_time_ = t;
  request_arrived_ = bus_->now();
  NoteOtherTime(t, message.source);
  choice_.Set({t, bus_->now(), message.source, velocity, why});
  if (const auto chosen = choice_.Choose(bus_->now())) Publish(t, *chosen);
}

void CollisionGuardProcess::Publish(Time utime, const MotionRequest& request) {
  if (latch_.is_stopped()) {
    guard_.Stop(newest_);
    Send(utime, request.source, {}, latch_.reason());
    return;
  }
  const AllowedVelocity allowed = guard_.Allow(newest_, request.velocity);
  Send(utime,
       request.source,
       allowed.velocity,
       allowed.reason.empty() ? request.reason : allowed.reason);
}

void CollisionGuardProcess::OnStop(const stop_t& message, Time t) {
  std::string reason;
  if (!CheckTime("utime", message.utime, &reason)) {
    bus_->ReportBad(kStop, Bad::kContent, reason);
    // A stop is a stop.
    if (message.is_stopped == 0) return;
  }
  if (message.is_stopped != 0) {
    // First of all, then whatever writing it down takes.
    guard_.Stop(newest_);
    Send(t, message.source, {}, "stopped by " + message.source);
  }
  latch_.Set(message);
  ShowFault(bus_->now());
}

void CollisionGuardProcess::OnRanges(const planar_lidar_t& message) {
  std::string reason;
  const auto scan = RangeScanFromMessage(message, &reason);
  if (!scan) {
    bus_->ReportBad(kRanges, Bad::kContent, reason);
    return;
  }
  if (ranges_time_ && IsLate(scan->time, *ranges_time_)) {
    bus_->ReportBad(kRanges, Bad::kContent, "time goes back");
    return;
  }
  ranges_time_ = scan->time;
  ranges_arrived_ = bus_->now();
  NoteRobotTime(scan->time);
  guard_.SetRanges(*scan);
}

void CollisionGuardProcess::OnBase(const base_status_t& message, Time t) {
  std::string reason;
  if (!CheckTime("utime", message.utime, &reason)) {
    bus_->ReportBad(kBase, Bad::kContent, reason);
    return;
  }
  if (ranges_time_) {
    NoteOtherTime(t, std::string(kBase));
  } else {
    NoteRobotTime(t);
  }
  if (message.is_bumper_left != 0 || message.is_bumper_right != 0) {
    guard_.SetContact(newest_);
  }
}

void CollisionGuardProcess::OnTimer(Time now) {
  ShowFault(now);
  const auto chosen = choice_.Choose(now);
  // Time has passed since the newest stamp, at most as long as a request lives.
  const Time event_now =
      newest_ + std::clamp(now - arrived_, Duration(0), kRestart / 2);
  if (!chosen) {
    guard_.Stop(event_now);
    std::string reason = "no request";
    if (request_time_) {
      reason += Text(" for %.1f s", config_.request_timeout_s);
    }
    if (latch_.is_stopped()) reason = latch_.reason();
    Send(request_time_.value_or(now), "", {}, reason);
    return;
  }
  // Requests that come often are looked at often, and by their own time alone:
  // the same requests get the same answers at any pace of the machine.
  if (sent_.is_zero() || now - request_arrived_ < 2 * kPeriod) return;
  // Not faster again before the next request: nobody has asked for it.
  const AllowedVelocity allowed = guard_.Allow(event_now, sent_);
  if (allowed.velocity == sent_) return;
  Send(*request_time_, sent_source_, allowed.velocity, allowed.reason);
}

void CollisionGuardProcess::ShowFault(Time now) {
  std::string fault;
  const auto add = [&](const std::string& text) {
    if (text.empty()) return;
    fault += (fault.empty() ? "" : "; ") + text;
  };
  if (latch_.is_stopped()) add(latch_.reason());
  if (config_.guard.ranges == RangeUse::kRequired) {
    const double age = Seconds(now - ranges_arrived_);
    if (!ranges_time_) {
      add("no RANGES yet");
    } else if (age > config_.guard.max_range_age) {
      add(Text("no RANGES for %.0f s", age));
    }
  }
  add(latch_.fault());
  if (now - clock_fault_time_ > kRestart) clock_fault_.clear();
  add(clock_fault_);
  bus_->SetFault(fault);
}

void CollisionGuardProcess::Send(Time utime,
                                 const std::string& source,
                                 const Velocity& velocity,
                                 const std::string& reason) {
  sent_ = velocity;
  sent_source_ = source;
  velocity_t message;
  message.utime = Microseconds(utime);
  message.seq = SourceOf(source).seq++;
  message.source = source;
  message.forward = velocity.forward;
  message.turn_rate = velocity.turn_rate;
  message.reason = reason;
  bus_->Publish(kMotionCommand, message);
}

}  // namespace waymark
