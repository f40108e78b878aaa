// Driver of the robot's base.
#pragma once

#include "drivers/wheels/create_base.h"
#include "processes/support/bus.h"
#include "processes/wheels/wheels_config.h"

#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <string_view>

namespace waymark {

// MOTION_COMMAND -> an iRobot Create 2 at a serial port -> ENCODERS (16 bits,
// each period that brings news), BASE (10 Hz). Time stamps are those of
// reading, up to 15 ms and the period late. A port that is not there, a robot
// that does not answer or has stopped itself are faults on STATUS, and nothing
// is published that the robot did not say. The wheels stand before the first
// command and after the last.
class WheelsProcess {
 public:
  using Config = WheelsConfig;
  static constexpr std::string_view kName = "wheels";
  static constexpr std::string_view kAbout =
      "An iRobot Create 2 at a serial port: MOTION_COMMAND -> ENCODERS, BASE.";
  static constexpr bool kIsLiveOnly = true;

  WheelsProcess(const Config& config, Bus* bus);
  void Finish() { base_.Stop(); }

 private:
  void OnCommand(const velocity_t& message);
  void OnTimer(Time now);
  void Publish(Time now, const CreateReading& reading);
  void WarnOfSkippedBytes();

  Bus* bus_;
  CreateBase base_;
  Time base_published_;
  bool was_bumped_left_ = false;  // Since BASE was published last.
  bool was_bumped_right_ = false;
  std::int32_t encoders_seq_ = 0;
  std::int32_t base_seq_ = 0;
  std::int64_t next_warning_ = 1;  // At so many bytes.
};

}  // namespace waymark
