// Fixture of the simulator's tests: a small room, and how it is driven.
#pragma once

#include "processes/simulator/simulator_process.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/temporary_directory.h"

#include <waymark/encoders_t.hpp>
#include <waymark/pan_tilt_t.hpp>
#include <waymark/velocity_t.hpp>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <fstream>
#include <string>
#include <utility>

namespace waymark {

inline constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

inline velocity_t Velocity(Time t, double forward, double turn_rate) {
  velocity_t message{};
  message.utime = Microseconds(t);
  message.source = "test";
  message.forward = forward;
  message.turn_rate = turn_rate;
  return message;
}

inline pan_tilt_t Look(Time t, double pan, double tilt) {
  pan_tilt_t message{};
  message.utime = Microseconds(t);
  message.pan = pan;
  message.tilt = tilt;
  return message;
}

// The simulator on a bus of its own.
struct SimulatorOnBus {
  explicit SimulatorOnBus(const SimulatorConfig& config, Time start = kStart)
      : bus(start), process(config, bus.AddProcess("simulator")) {}

  // Sends a command ten times a second from `begin` until before `end`.
  void Drive(Time begin, Time end, double forward, double turn_rate) {
    for (Time t = begin; t < end; t += std::chrono::milliseconds(100)) {
      bus.Publish(kMotionCommand, Velocity(t, forward, turn_rate));
    }
  }

  // Adds a process that calls answer(its bus, how many ENCODERS came before,
  // the time of this one) for each ENCODERS.
  template <typename Answer>
  void AddDriver(Answer answer) {
    Bus* driver = bus.AddProcess("driver");
    driver->Advertise<velocity_t>(kMotionCommand);
    driver->Subscribe<encoders_t>(
        kEncoders,
        Keep::All(),
        [driver, answer = std::move(answer), num = 0](
            const encoders_t&, Time t) mutable { answer(driver, num++, t); });
  }

  LocalBus bus;
  SimulatorProcess process;
};

// A room of 6 x 4 m with one lamp, and a small camera, which is not used
// unless it gets a name.
class SimulatorTest : public testing::Test {
 protected:
  SimulatorTest() {
    Write("room.yaml",
          "rooms:\n"
          "  - {name: room, rectangle: [0, 0, 6, 4], lamps: [1, 1]}\n"
          "starts: [[1, 2, 0]]\n");
    WriteCamera(1);
    config_.world = Path("room.yaml");
    config_.camera.file = Path("camera.yaml");
    config_.camera.name = "";
    config_.light_cell = 2.0;  // Nobody looks: quick.
    config_.robot.wheel_variance = 0.0;
    config_.robot.base_variance = 0.0;
  }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return directory_ / name;
  }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name)) << text;
  }
  // Of 64 x 48 pixels times `scale`.
  void WriteCamera(int scale) const {
    Write("camera.yaml",
          fmt::format("{{model: perspective, width: {}, height: {}, fx: {}, "
                      "fy: {}, cx: {}, cy: {}, mounting: {{x: 0.1, z: 0.5}}}}",
                      64 * scale,
                      48 * scale,
                      50 * scale,
                      50 * scale,
                      32 * scale - 0.5,
                      24 * scale - 0.5));
  }

  TemporaryDirectory directory_;
  SimulatorConfig config_;
};

}  // namespace waymark
