#include "tests/support/create_emulator.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace waymark {

int CreateEmulator::DataSize(std::uint8_t opcode) {
  switch (opcode) {
    case 128:  // Start.
    case 131:  // Safe.
    case 132:  // Full.
    case 173:  // Stop.
      return 0;
    case 150:  // Pause or resume stream.
      return 1;
    case 145:  // Drive direct.
      return 4;
    case 148:  // Stream.
      return -1;
    default:
      return 0;
  }
}

void CreateEmulator::Receive(std::span<const std::uint8_t> bytes) {
  if (is_silent_) return;
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  while (at < pending_.size()) {
    int size = DataSize(pending_[at]);
    if (size < 0) {
      if (at + 1 >= pending_.size()) break;
      size = 1 + pending_[at + 1];
    }
    const std::size_t end = at + 1 + static_cast<std::size_t>(size);
    if (end > pending_.size()) break;
    Obey(pending_[at],
         std::span(pending_).subspan(at + 1, static_cast<std::size_t>(size)));
    at = end;
  }
  pending_.erase(pending_.begin(),
                 pending_.begin() + static_cast<std::ptrdiff_t>(at));
}

void CreateEmulator::Halt() {
  left_speed_ = 0;
  right_speed_ = 0;
}

void CreateEmulator::Obey(std::uint8_t opcode,
                          std::span<const std::uint8_t> data) {
  const auto speed_at = [&](std::size_t i) {
    return static_cast<std::int16_t>(data[i] << 8 | data[i + 1]);
  };
  if (mode_ == kOff && opcode != 128) return;
  switch (opcode) {
    case 128:
      mode_ = kPassive;
      Halt();
      break;
    case 131:
      mode_ = (bumps_ & 12) != 0 ? kPassive : kSafe;
      break;
    case 132:
      mode_ = kFull;
      break;
    case 145:
      if (mode_ != kSafe && mode_ != kFull) break;
      right_speed_ = speed_at(0);
      left_speed_ = speed_at(2);
      break;
    case 148:
      stream_.assign(data.begin() + 1, data.end());
      is_streaming_ = true;
      break;
    case 150:
      is_streaming_ = data[0] != 0;
      break;
    case 173:
      SetMode(kOff);
      break;
    default:
      ++num_unknown_;
  }
}

CreateEmulator::Bytes CreateEmulator::Packet(std::uint8_t id) const {
  const auto word = [](std::uint16_t value) {
    return Bytes{static_cast<std::uint8_t>(value >> 8),
                 static_cast<std::uint8_t>(value & 0xff)};
  };
  const auto ticks = [&](double value) {
    return word(static_cast<std::uint16_t>(
        static_cast<std::int64_t>(std::floor(value)) & 0xffff));
  };
  switch (id) {
    case 7:
      return {bumps_};
    case 9:
      return {static_cast<std::uint8_t>(is_cliff_)};
    case 10:
    case 11:
    case 12:
    case 34:
      return {0};
    case 25:
      return word(charge_);
    case 26:
      return word(capacity_);
    case 35:
      return {mode_};
    case 43:
      return ticks(left_ticks_);
    case 44:
      return ticks(right_ticks_);
    default:
      return {};
  }
}

CreateEmulator::Bytes CreateEmulator::Frame() const {
  Bytes frame{19, 0};
  for (const std::uint8_t id : stream_) {
    frame.push_back(id);
    const Bytes data = Packet(id);
    frame.insert(frame.end(), data.begin(), data.end());
  }
  frame[1] = static_cast<std::uint8_t>(frame.size() - 2);
  unsigned sum = 0;
  for (const std::uint8_t byte : frame) sum += byte;
  frame.push_back(static_cast<std::uint8_t>(256 - (sum & 0xff)));
  return frame;
}

void CreateEmulator::SendNoisy(const Bytes& bytes, Bytes* out) {
  for (const std::uint8_t byte : bytes) {
    if (random_.Uniform() < added_) {
      out->push_back(static_cast<std::uint8_t>(random_.Index(256)));
    }
    if (random_.Uniform() < lost_) continue;
    const bool is_changed = random_.Uniform() < changed_;
    out->push_back(
        is_changed ? static_cast<std::uint8_t>(byte ^ (1 + random_.Index(255)))
                   : byte);
  }
}

CreateEmulator::Bytes CreateEmulator::Step(double dt) {
  constexpr double kPeriod = 0.015;
  Bytes out;
  while (dt > 0.0) {
    const double step = std::min(dt, kPeriod - since_frame_);
    left_ticks_ += left_speed_ * 1e-3 * step * kTicksPerMeter;
    right_ticks_ += right_speed_ * 1e-3 * step * kTicksPerMeter;
    since_frame_ += step;
    dt -= step;
    // Rounding of sums of steps.
    if (since_frame_ < kPeriod - 1e-9) continue;
    since_frame_ = 0.0;
    if (!is_streaming_ || is_silent_) continue;
    ++num_frames_;
    SendNoisy(Frame(), &out);
  }
  return out;
}

void CreateEmulator::SetMode(std::uint8_t mode) {
  mode_ = mode;
  if (mode != kSafe && mode != kFull) Halt();
  if (mode == kOff) is_streaming_ = false;
}

void CreateEmulator::SetBumpers(bool left, bool right) {
  bumps_ = static_cast<std::uint8_t>((bumps_ & 12) | (left ? 2 : 0) |
                                     (right ? 1 : 0));
}

void CreateEmulator::SetWheelDrop(bool is_dropped) {
  bumps_ = static_cast<std::uint8_t>((bumps_ & 3) | (is_dropped ? 8 : 0));
  if (is_dropped && mode_ == kSafe) SetMode(kPassive);
}

void CreateEmulator::SetCliff(bool is_cliff) {
  is_cliff_ = is_cliff;
  if (is_cliff && mode_ == kSafe) SetMode(kPassive);
}

void CreateEmulator::SetTicks(double left, double right) {
  left_ticks_ = left;
  right_ticks_ = right;
}

void CreateEmulator::SetCharge(std::uint16_t charge, std::uint16_t capacity) {
  charge_ = charge;
  capacity_ = capacity;
}

void CreateEmulator::SetNoise(double lost, double changed, double added) {
  lost_ = lost;
  changed_ = changed;
  added_ = added;
}

}  // namespace waymark
