// An iRobot Create 2 as its serial port shows it: obeys the Open Interface,
// turns its wheels in simulated time, streams its sensors.
#pragma once

#include "estimation/base/random.h"

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

// Written from the specification, not from the driver: what both get wrong in
// the same way stays hidden otherwise.
class CreateEmulator {
 public:
  using Bytes = std::vector<std::uint8_t>;
  enum Mode : std::uint8_t { kOff, kPassive, kSafe, kFull };

  // Bytes from the driver.
  void Receive(std::span<const std::uint8_t> bytes);
  // Lets dt seconds pass; returns what the robot sends meanwhile.
  [[nodiscard]] Bytes Step(double dt);

  // What happens to it.
  void SetBumpers(bool left, bool right);
  void SetWheelDrop(bool is_dropped);  // In safe mode: passive.
  void SetCliff(bool is_cliff);        // The same.
  void SetMode(std::uint8_t mode);     // Off ends the stream, as a reset does.
  // Sends nothing, and hears nothing: off, or its cable is broken.
  void SetSilent(bool is_silent) { is_silent_ = is_silent; }
  void SetTicks(double left, double right);
  void SetCharge(std::uint16_t charge, std::uint16_t capacity);
  // Each byte it sends is lost, changed or preceded by a wrong one with these
  // probabilities.
  void SetNoise(double lost, double changed, double added);

  [[nodiscard]] std::uint8_t mode() const { return mode_; }
  // Of the wheels, mm/s.
  [[nodiscard]] int left_speed() const { return left_speed_; }
  [[nodiscard]] int right_speed() const { return right_speed_; }
  [[nodiscard]] bool is_moving() const {
    return left_speed_ != 0 || right_speed_ != 0;
  }
  // Cumulative, not wrapped.
  [[nodiscard]] double left_ticks() const { return left_ticks_; }
  [[nodiscard]] double right_ticks() const { return right_ticks_; }
  [[nodiscard]] int num_unknown_commands() const { return num_unknown_; }
  [[nodiscard]] int num_frames() const { return num_frames_; }

  static constexpr double kTicksPerMeter = 508.8 / (3.14159265358979 * 0.072);

 private:
  // Bytes that follow an opcode; -1: as many as the first of them says.
  [[nodiscard]] static int DataSize(std::uint8_t opcode);
  void Obey(std::uint8_t opcode, std::span<const std::uint8_t> data);
  void Halt();
  [[nodiscard]] Bytes Packet(std::uint8_t id) const;
  [[nodiscard]] Bytes Frame() const;
  void SendNoisy(const Bytes& bytes, Bytes* out);

  std::uint8_t mode_ = kOff;
  Bytes pending_;
  int left_speed_ = 0;
  int right_speed_ = 0;
  double left_ticks_ = 0.0;
  double right_ticks_ = 0.0;
  std::uint8_t bumps_ = 0;
  bool is_cliff_ = false;
  bool is_silent_ = false;
  std::uint16_t charge_ = 2000;
  std::uint16_t capacity_ = 2500;
  Bytes stream_;  // Ids of the packets.
  bool is_streaming_ = false;
  double since_frame_ = 0.0;
  int num_unknown_ = 0;
  int num_frames_ = 0;
  double lost_ = 0.0;
  double changed_ = 0.0;
  double added_ = 0.0;
  Random random_{5};
};

}  // namespace waymark
