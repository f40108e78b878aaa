// Bytes of the iRobot Create 2 Open Interface [1]: commands to the robot, and
// the stream of sensor packets that it sends every 15 ms.
//
// [1] iRobot Create 2 Open Interface (OI) Specification based on the iRobot
//     Roomba 600, 2018.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace waymark {

using Bytes = std::vector<std::uint8_t>;

enum class CreateMode : std::uint8_t {
  kOff = 0,
  kPassive = 1,  // Obeys nothing that moves; stands unless it cleans.
  kSafe = 2,     // Obeys; stops by itself at cliffs, wheel drops, the charger.
  kFull = 3,     // Obeys whatever happens.
};

// What one frame of the stream says.
struct CreateSensors {
  bool is_bumper_left = false;
  bool is_bumper_right = false;
  bool is_wheel_dropped = false;  // Either one.
  bool is_cliff = false;          // Any of the four.
  bool is_charging = false;       // A charger is connected.
  // As sent: other numbers than CreateMode's have been seen on real robots.
  std::uint8_t mode = 0;
  std::uint16_t charge = 0;      // mAh.
  std::uint16_t capacity = 0;    // mAh; 0 where the robot does not know.
  std::uint16_t left_ticks = 0;  // Wrap; forward counts up.
  std::uint16_t right_ticks = 0;

  bool operator==(const CreateSensors&) const = default;
};

inline constexpr int kCreateMaxSpeed = 500;  // Of a wheel, mm/s.
// Wheels of 72 mm, 508.8 counts a turn: [1], packet 43.
inline constexpr double kCreateMetersPerTick = 0.072 * 3.14159265358979 / 508.8;
inline constexpr double kCreateWheelBase = 0.235;  // m.
inline constexpr double kCreateStreamPeriodS = 0.015;

// Enters passive mode from any other: the wheels stop.
[[nodiscard]] Bytes EncodeStart();
// kSafe or kFull.
[[nodiscard]] Bytes EncodeMode(CreateMode mode);
// Speeds in mm/s, within +-kCreateMaxSpeed (std::logic_error otherwise).
[[nodiscard]] Bytes EncodeDriveDirect(int right, int left);
// Starts the stream of everything in CreateSensors.
[[nodiscard]] Bytes EncodeStream();
[[nodiscard]] Bytes EncodeStreamPause();
// Stops the wheels whatever the robot was told before, even where the bytes
// before these were cut short within a command.
[[nodiscard]] Bytes EncodeStop();

// Finds the frames of EncodeStream() among whatever bytes come. A frame is
// taken only where header, length, every packet's id and the checksum agree;
// lengths that bytes state are compared, never used. After lost or wrong bytes
// the search goes on behind the first byte of what was no frame.
class CreateStreamParser {
 public:
  // Frames that `data` completes, in order.
  [[nodiscard]] std::vector<CreateSensors> Add(
      std::span<const std::uint8_t> data);
  // What was begun does not go on: the port was opened anew.
  void Clear() { pending_.clear(); }

  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }
  // Bytes that belonged to no frame.
  [[nodiscard]] std::int64_t num_skipped() const { return num_skipped_; }

 private:
  Bytes pending_;  // Less than a frame between calls.
  std::int64_t num_frames_ = 0;
  std::int64_t num_skipped_ = 0;
};

}  // namespace waymark
