// What of the motion that is asked for the wheels may do.
#pragma once

#include "planner/control/request_choice.h"
#include "planner/control/velocity_guard.h"
#include "processes/collision_guard/collision_guard_config.h"
#include "processes/collision_guard/stop_latch.h"
#include "processes/support/bus.h"

#include <waymark/base_status_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/stop_t.hpp>
#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// MOTION_REQUEST, STOP, RANGES, BASE -> MOTION_COMMAND: at once for each
// request, with its utime; at once for a STOP; and by a timer (20 Hz) with the
// utime of the last request, where what was allowed is no longer safe, and as
// zero while nobody asks. Of several that ask RequestChoice chooses.
class CollisionGuardProcess {
 public:
  using Config = CollisionGuardConfig;
  static constexpr std::string_view kName = "collision_guard";
  static constexpr std::string_view kAbout =
      "Lets through what of a motion ends before the next obstacle: "
      "MOTION_REQUEST, STOP, RANGES, BASE -> MOTION_COMMAND.";

  // Throws InputError where the stop file cannot be written.
  CollisionGuardProcess(const Config& config, Bus* bus);

 private:
  // Who asks, or stops.
  struct Source {
    std::optional<Time> request_time;  // Of its last request.
    std::int32_t seq = 0;              // Of the next command that follows it.
    std::int64_t last_use = 0;         // Which of all uses.
  };

  // Forgets another one where there is no room for a new one.
  [[nodiscard]] Source& SourceOf(const std::string& name);
  void OnRequest(const velocity_t& message, Time t);
  void OnStop(const stop_t& message, Time t);
  void OnRanges(const planar_lidar_t& message);
  void OnBase(const base_status_t& message, Time t);
  void OnTimer(Time now);
  void ShowFault(Time now);

  // The newest time stamp of all inputs that go by the robot's clock: that of
  // RANGES, or of BASE where there are none, or else the requests' own.
  void NoteTime(Time t);
  void NoteRobotTime(Time t);
  void NoteOtherTime(Time t, const std::string& source);
  void Publish(Time utime, const MotionRequest& request);
  void Send(Time utime,
            const std::string& source,
            const Velocity& velocity,
            const std::string& reason);

  Config config_;
  Bus* bus_;
  StopLatch latch_;
  VelocityGuard guard_;
  RequestChoice choice_;

  Time newest_;   // By the inputs' time stamps,
  Time arrived_;  // and when it came, on the bus's clock.
  std::optional<Time> robot_time_;
  Time robot_arrived_;
  std::string clock_fault_;
  Time clock_fault_time_;  // On the bus's clock.
  std::optional<Time> ranges_time_;
  Time ranges_arrived_;
  std::optional<Time> request_time_;  // The last of all.
  Time request_arrived_;
  Velocity sent_;
  std::string sent_source_;
  std::map<std::string, Source> sources_;
  std::int64_t num_uses_ = 0;
};

}  // namespace waymark
