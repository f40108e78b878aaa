#include "logs/import/lcm_maebot_logs.h"

#include "estimation/geometry/angle.h"
#include "processes/support/decode.h"
#include "processes/support/log_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <span>

namespace waymark {
namespace {

constexpr std::uint64_t kEncodersType = 0x7d090bfb221d74f9;
constexpr std::uint64_t kMotorFeedbackType = 0x8dc5a028fca42ff9;
constexpr std::uint64_t kPoseType = 0x1f317af1246276ac;
constexpr std::uint64_t kLaserType = 0x89dc5b879a5056cf;

constexpr double kWheelDiameter = 0.032;  // m.
constexpr double kWheelBase = 0.080;      // m.
// Earlier than this (2001-09-09) a utime counts from somewhere else.
constexpr std::int64_t kFirstDate = 1'000'000'000'000'000;

// Hostile stamps stay within this, so that differences do not overflow; it is
// no time of any log.
constexpr std::int64_t kMaxStamp = std::int64_t{1} << 60;

// A recorded message of one kind: its event, and the members behind utime.
struct Message {
  std::int64_t number = 0;
  Time event_time;
  std::int64_t utime = 0;
  std::vector<double> values;
};

// Big-endian members one after the other.
class Members {
 public:
  // `where` names the event in errors.
  Members(std::span<const std::uint8_t> data, std::string where)
      : data_(data), where_(std::move(where)) {}

  std::uint64_t Unsigned(std::size_t num_bytes) {
    if (data_.size() - position_ < num_bytes) Fail("is cut short");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < num_bytes; ++i) {
      value = value << 8 | data_[position_++];
    }
    return value;
  }
  std::int64_t Int64() { return static_cast<std::int64_t>(Unsigned(8)); }
  std::int32_t Int32() {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(Unsigned(4)));
  }
  double Float() {
    const auto bits = static_cast<std::uint32_t>(Unsigned(4));
    const double value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) Fail("has a number that is not finite");
    return value;
  }
  [[nodiscard]] std::size_t num_left() const {
    return data_.size() - position_;
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(where_ + what);
  }

 private:
  std::span<const std::uint8_t> data_;
  std::string where_;
  std::size_t position_ = 0;
};

// The messages of the log by type, and what else is in it by channel.
struct Content {
  std::map<std::uint64_t, std::vector<Message>> messages;
  std::map<std::string, int> left_out;
  LogReadReport report;
};

void ReadMembers(std::uint64_t type, Members* members, Message* message) {
  message->utime = std::clamp(members->Int64(), -kMaxStamp, kMaxStamp);
  if (type == kPoseType) {
    for (int i = 0; i < 3; ++i) message->values.push_back(members->Float());
    return;
  }
  if (type != kLaserType) {
    for (int i = 0; i < 2; ++i) message->values.push_back(members->Int32());
    return;
  }
  const std::int32_t num_ranges = members->Int32();
  // Each beam has a range, an angle, a time and an intensity: 20 bytes.
  if (num_ranges < 0 ||
      static_cast<std::size_t>(num_ranges) > members->num_left() / 20) {
    members->Fail("states " + std::to_string(num_ranges) + " beams, has " +
                  std::to_string(members->num_left() / 20));
  }
  // Ranges, then angles.
  for (int i = 0; i < 2 * num_ranges; ++i) {
    message->values.push_back(members->Float());
  }
}

Content ReadContent(const std::string& path) {
  Content content;
  LogReader reader(path);
  while (const auto event = reader.Next()) {
    const auto type = BigEndian64(event->data);
    if (type != kEncodersType && type != kMotorFeedbackType &&
        type != kPoseType && type != kLaserType) {
      ++content.left_out[event->channel];
      continue;
    }
    Members members(event->data,
                    path + ": event " + std::to_string(event->number) + " (" +
                        event->channel + "): ");
    (void)members.Unsigned(8);  // The fingerprint.
    Message message;
    message.number = event->number;
    message.event_time = TimeFromMicroseconds(
        std::clamp(Microseconds(event->time), -kMaxStamp, kMaxStamp));
    ReadMembers(*type, &members, &message);
    content.messages[*type].push_back(std::move(message));
  }
  content.report = reader.report();
  return content;
}

// Event time minus utime: its median, and how far it spreads.
struct ClockOffset {
  Duration median{0};
  Duration spread{0};
};

ClockOffset OffsetOf(const std::vector<Message>& messages) {
  std::vector<Duration> offsets;
  offsets.reserve(messages.size());
  for (const Message& message : messages) {
    offsets.push_back(message.event_time - TimeFromMicroseconds(message.utime));
  }
  std::sort(offsets.begin(), offsets.end());
  return {offsets[offsets.size() / 2], offsets.back() - offsets.front()};
}

// The recording's clock is the event clock moved by `from_event`.
class Clock {
 public:
  explicit Clock(const std::vector<Message>& encoders) {
    const ClockOffset offset = OffsetOf(encoders);
    const bool has_dates =
        std::all_of(encoders.begin(), encoders.end(), [](const Message& m) {
          return m.utime >= kFirstDate && m.utime < 4 * kFirstDate;
        });
    if (has_dates && Seconds(offset.spread) <= kMaxClockSpread) {
      from_event_ = -offset.median;
    }
  }

  // Replaces event times by times on this clock; says whether utimes served.
  bool Apply(std::vector<Message>* messages) const {
    const ClockOffset offset = OffsetOf(*messages);
    const bool keeps_step =
        Seconds(offset.spread) <= kMaxClockSpread &&
        std::abs(Seconds(offset.median + from_event_)) <= kMaxClockSpread;
    for (Message& message : *messages) {
      message.event_time = keeps_step ? TimeFromMicroseconds(message.utime)
                                      : message.event_time + from_event_;
    }
    return keeps_step;
  }

 private:
  Duration from_event_{0};
};

// Times as messages of `what`, in order; drops those that are not later.
std::vector<Message> InOrder(std::vector<Message> messages,
                             const Clock& clock,
                             const std::string& what,
                             std::vector<std::string>* notes) {
  if (messages.empty()) return messages;
  if (!clock.Apply(&messages)) {
    notes->push_back(
        what + ": event times, since the utimes are no dates or keep no step");
  }
  std::vector<Message> kept;
  for (Message& message : messages) {
    if (kept.empty() || message.event_time > kept.back().event_time) {
      kept.push_back(std::move(message));
    }
  }
  if (kept.size() < messages.size()) {
    notes->push_back(what + ": " +
                     std::to_string(messages.size() - kept.size()) +
                     " messages left out that were not later than the last");
  }
  return kept;
}

void AddEncoders(const std::vector<Message>& messages, Recording* recording) {
  EncoderReading reading;
  for (const Message& message : messages) {
    const auto left = static_cast<std::int32_t>(message.values[0]);
    const auto right = static_cast<std::int32_t>(message.values[1]);
    if (recording->encoders.empty()) {
      reading.left = left;
      reading.right = right;
    } else {
      // The counters have 32 bits: the difference modulo 2^32, signed.
      const auto step = [](std::int32_t now, std::int64_t before) {
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(now) -
                                         static_cast<std::uint32_t>(before));
      };
      reading.left += step(left, reading.left);
      reading.right += step(right, reading.right);
    }
    reading.time = message.event_time;
    recording->encoders.push_back(reading);
    ++reading.seq;
  }
}

void AddReference(const std::vector<Message>& messages, Recording* recording) {
  Reference& reference = recording->reference;
  reference.source = "laser SLAM";
  reference.sigma = {0.02, 0.02, 0.03};
  for (const Message& message : messages) {
    TruthSample sample;
    sample.time = message.event_time;
    sample.p_WS = {message.values[0], message.values[1]};
    sample.heading = WrapAngle(message.values[2]);
    reference.samples.push_back(sample);
  }
  if (reference.samples.empty()) return;
  const TruthSample& first = reference.samples.front();
  recording->start =
      StatedStart(first.time,
                  {first.p_WS.x(), first.p_WS.y(), *first.heading},
                  reference.sigma);
  recording->notes.push_back(
      "assumed: laser SLAM good to 20 mm a coordinate and 30 mrad");
}

// nullopt where the beams are not evenly spaced.
std::optional<RangeScan> ScanFrom(const Message& message) {
  const std::size_t n = message.values.size() / 2;
  if (n < 2) return std::nullopt;
  const double* const angles = message.values.data() + n;
  RangeScan scan;
  scan.time = message.event_time;
  scan.first_angle = angles[0];
  scan.step = WrapAngle(angles[1] - angles[0]);
  double last = angles[0];
  for (std::size_t i = 0; i < n; ++i) {
    scan.ranges.push_back(static_cast<float>(message.values[i]));
    if (i == 0) continue;
    // A tenth of the spacing is below what a map of the ranges shows.
    const double step = WrapAngle(angles[i] - last);
    if (std::abs(step - scan.step) > 0.1 * std::abs(scan.step)) {
      return std::nullopt;
    }
    last = angles[i];
  }
  return scan;
}

void AddScans(const std::vector<Message>& messages, Recording* recording) {
  int num_uneven = 0;
  for (const Message& message : messages) {
    if (auto scan = ScanFrom(message)) {
      recording->scans.push_back(std::move(*scan));
    } else {
      ++num_uneven;
    }
  }
  if (num_uneven > 0) {
    recording->notes.push_back(
        std::to_string(num_uneven) +
        " laser scans left out: beams not evenly spaced");
  }
}

void AddLeftOut(const Content& content, Recording* recording) {
  std::string text;
  for (const auto& [channel, count] : content.left_out) {
    text += (text.empty() ? "left out: " : ", ") + std::to_string(count) + " " +
            channel;
  }
  if (!text.empty()) recording->notes.push_back(text);
  if (!content.report.is_sound()) {
    recording->notes.push_back("damaged: " + content.report.SkippedText() +
                               " skipped");
  }
}

}  // namespace

Recording ReadMaebotLog(const std::string& path) {
  Content content = ReadContent(path);
  auto& messages = content.messages;
  const bool has_encoders = messages.contains(kEncodersType);
  if (!has_encoders && !messages.contains(kMotorFeedbackType)) {
    throw InputError(path +
                     ": no MAEBot encoder or motor feedback messages in it");
  }
  if (has_encoders && messages.contains(kMotorFeedbackType)) {
    // Both count the same wheels.
    content.left_out["motor feedback"] =
        static_cast<int>(messages[kMotorFeedbackType].size());
  }
  Recording recording;
  recording.format = "lcm_maebot_logs";
  recording.name = std::filesystem::path(path).stem().string();
  const std::uint64_t wheels =
      has_encoders ? kEncodersType : kMotorFeedbackType;
  const Clock clock(messages[wheels]);
  auto* notes = &recording.notes;
  AddEncoders(InOrder(messages[wheels], clock, "encoders", notes), &recording);
  AddReference(InOrder(messages[kPoseType], clock, "pose", notes), &recording);
  AddScans(InOrder(messages[kLaserType], clock, "laser", notes), &recording);
  AddLeftOut(content, &recording);

  const double ticks_per_turn = has_encoders ? 1200.0 : 480.0;
  const double k = kPi * kWheelDiameter / ticks_per_turn;
  recording.nominal = NominalParameters(recording.encoders.front().time,
                                        {k, k, kWheelBase},
                                        {0.05 * k, 0.05 * k, 0.1 * kWheelBase});
  return recording;
}

}  // namespace waymark
