// A robot driven by the keys of a terminal.
#pragma once

#include "processes/support/bus.h"
#include "processes/teleop/teleop_config.h"
#include "processes/teleop/teleop_keys.h"
#include "processes/teleop/terminal.h"

#include <waymark/base_status_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// Keys -> MOTION_REQUEST (20 Hz, also where no key is pressed), STOP. Shows
// what it asks for, what is allowed and why (MOTION_COMMAND), BASE and POSE.
// Its time stamps are the robot's time as BASE tells it, so that it can drive
// a simulation whose time is not the clock's.
class TeleopProcess {
 public:
  using Config = TeleopConfig;
  static constexpr std::string_view kName = "teleop";
  static constexpr std::string_view kAbout =
      "A robot driven by the keys of a terminal; shows MOTION_COMMAND, BASE "
      "and POSE -> MOTION_REQUEST, STOP.";
  static constexpr bool kIsLiveOnly = true;

  // Throws InputError where `input_fd` is no terminal.
  TeleopProcess(const Config& config,
                Bus* bus,
                int input_fd = 0,
                int output_fd = 1);
  // Asks for nothing any more.
  void Finish();

 private:
  void OnTimer(Time now);
  [[nodiscard]] Time RobotTime(Time now) const;
  void Ask(Time now, const Velocity& velocity);
  void SendStop(Time now, bool is_stopped);
  void Draw(Time now);

  Bus* bus_;
  Terminal terminal_;
  TeleopKeys keys_;
  Velocity asked_;
  std::int32_t request_seq_ = 0;
  std::int32_t stop_seq_ = 0;
  std::int64_t num_ticks_ = 0;
  std::optional<velocity_t> command_;
  Time command_arrived_;
  std::optional<base_status_t> base_;
  Time base_arrived_;
  std::optional<pose_t> pose_;
  Time pose_arrived_;
  std::string shown_;
};

}  // namespace waymark
