#include "drivers/wheels/create_protocol.h"

#include "estimation/base/check.h"

#include <array>
#include <cstddef>
#include <cstdlib>

namespace waymark {
namespace {

constexpr std::uint8_t kStart = 128;
constexpr std::uint8_t kSafe = 131;
constexpr std::uint8_t kFull = 132;
constexpr std::uint8_t kDriveDirect = 145;
constexpr std::uint8_t kStream = 148;
constexpr std::uint8_t kPauseResumeStream = 150;
constexpr std::uint8_t kFrameHeader = 19;

struct Packet {
  std::uint8_t id;
  std::uint8_t size;
};
// In the order in which they are asked for and sent.
enum PacketIndex {
  kBumps,
  kCliffLeft,
  kCliffFrontLeft,
  kCliffFrontRight,
  kCliffRight,
  kCharge,
  kCapacity,
  kChargers,
  kMode,
  kLeftTicks,
  kRightTicks,
  kNumPackets
};
constexpr std::array<Packet, kNumPackets> kPackets{{{7, 1},
                                                    {9, 1},
                                                    {10, 1},
                                                    {11, 1},
                                                    {12, 1},
                                                    {25, 2},
                                                    {26, 2},
                                                    {34, 1},
                                                    {35, 1},
                                                    {43, 2},
                                                    {44, 2}}};

// Offset of the id of packet i within the frame; of the checksum for i =
// kNumPackets.
constexpr std::size_t OffsetOf(std::size_t i) {
  std::size_t offset = 2;  // Header and length.
  for (std::size_t k = 0; k < i; ++k) offset += 1u + kPackets[k].size;
  return offset;
}
constexpr std::size_t kFrameSize = OffsetOf(kNumPackets) + 1;
// Counts ids and data only.
constexpr std::uint8_t kFrameLength = kFrameSize - 3;

bool IsFrame(std::span<const std::uint8_t> frame) {
  if (frame[0] != kFrameHeader || frame[1] != kFrameLength) return false;
  for (std::size_t i = 0; i < kPackets.size(); ++i) {
    if (frame[OffsetOf(i)] != kPackets[i].id) return false;
  }
  // All bytes, checksum included, add up to 0 modulo 256.
  unsigned sum = 0;
  for (const std::uint8_t byte : frame) sum += byte;
  return (sum & 0xffu) == 0;
}

CreateSensors SensorsOf(std::span<const std::uint8_t> frame) {
  const auto byte = [&](std::size_t i) { return frame[OffsetOf(i) + 1]; };
  const auto word = [&](std::size_t i) {
    return static_cast<std::uint16_t>(byte(i) << 8 | frame[OffsetOf(i) + 2]);
  };
  CreateSensors sensors;
  sensors.is_bumper_right = (byte(kBumps) & 1) != 0;
  sensors.is_bumper_left = (byte(kBumps) & 2) != 0;
  sensors.is_wheel_dropped = (byte(kBumps) & 12) != 0;
  for (std::size_t i = kCliffLeft; i <= kCliffRight; ++i) {
    sensors.is_cliff |= byte(i) != 0;
  }
  sensors.is_charging = byte(kChargers) != 0;
  sensors.mode = byte(kMode);
  sensors.charge = word(kCharge);
  sensors.capacity = word(kCapacity);
  sensors.left_ticks = word(kLeftTicks);
  sensors.right_ticks = word(kRightTicks);
  return sensors;
}

void AppendSpeed(int speed, Bytes* bytes) {
  const auto bits = static_cast<std::uint16_t>(speed);
  bytes->push_back(static_cast<std::uint8_t>(bits >> 8));
  bytes->push_back(static_cast<std::uint8_t>(bits & 0xff));
}

}  // namespace

Bytes EncodeStart() {
  return {kStart};
}

Bytes EncodeMode(CreateMode mode) {
  WAYMARK_CHECK(mode == CreateMode::kSafe || mode == CreateMode::kFull);
  return {mode == CreateMode::kSafe ? kSafe : kFull};
}

Bytes EncodeDriveDirect(int right, int left) {
  WAYMARK_CHECK(
      std::abs(right) <= kCreateMaxSpeed && std::abs(left) <= kCreateMaxSpeed,
      right,
      left);
  Bytes bytes{kDriveDirect};
  AppendSpeed(right, &bytes);
  AppendSpeed(left, &bytes);
  return bytes;
}

Bytes EncodeStream() {
  Bytes bytes{kStream, kNumPackets};
  for (const Packet& packet : kPackets) bytes.push_back(packet.id);
  return bytes;
}

Bytes EncodeStreamPause() {
  return {kPauseResumeStream, 0};
}

Bytes EncodeStop() {
  // A command that was cut short takes at most the first four bytes for its
  // own; zeros are no commands; the last byte stops in any case.
  Bytes bytes = EncodeDriveDirect(0, 0);
  bytes.push_back(kStart);
  return bytes;
}

std::vector<CreateSensors> CreateStreamParser::Add(
    std::span<const std::uint8_t> data) {
  pending_.insert(pending_.end(), data.begin(), data.end());
  std::vector<CreateSensors> frames;
  std::size_t at = 0;
  while (pending_.size() - at >= kFrameSize) {
    const auto frame = std::span(pending_).subspan(at, kFrameSize);
    if (IsFrame(frame)) {
      frames.push_back(SensorsOf(frame));
      ++num_frames_;
      at += kFrameSize;
    } else {
      ++num_skipped_;
      ++at;
    }
  }
  pending_.erase(pending_.begin(),
                 pending_.begin() + static_cast<std::ptrdiff_t>(at));
  return frames;
}

}  // namespace waymark
