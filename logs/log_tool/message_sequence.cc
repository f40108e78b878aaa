#include "logs/log_tool/message_sequence.h"

#include "processes/support/decode.h"
#include "processes/support/message_fields.h"

#include <algorithm>

namespace waymark {

std::optional<MessageSequence> SequenceOfMessage(
    const MessageTypeInfo& type, std::span<const std::uint8_t> data) {
  if (!type.has_sequence) return std::nullopt;
  std::optional<std::int64_t> number;
  std::string sender;
  bool is_image_sequence = false;  // The last key was "seq".
  const auto visit = [&](std::string_view name, const FieldValue& value) {
    if (name == "seq") {
      if (const auto* seq = std::get_if<std::int64_t>(&value)) number = *seq;
    } else if (name == "source" || name == "process") {
      if (const auto* text = std::get_if<std::string_view>(&value)) {
        sender = *text;
      }
    } else if (name.ends_with("].key")) {
      const auto* key = std::get_if<std::string_view>(&value);
      is_image_sequence = key != nullptr && *key == "seq";
    } else if (is_image_sequence && name.ends_with("].value")) {
      const auto* bytes = std::get_if<std::span<const std::uint8_t>>(&value);
      if (bytes != nullptr && bytes->size() == sizeof(std::int64_t)) {
        number = static_cast<std::int64_t>(*BigEndian64(*bytes));
      }
    }
  };
  if (!VisitFields(*type.schema, data, visit).empty() || !number) {
    return std::nullopt;
  }
  return MessageSequence{*number, sender};
}

void SequenceCounter::Add(const MessageSequence& sequence) {
  num_lost_ = std::max<std::int64_t>(num_lost_, 0);
  const auto [last, is_first] =
      last_.try_emplace(sequence.sender, sequence.number);
  if (is_first) return;
  if (sequence.number <= last->second) {
    ++num_restarts_;
  } else {
    // Hostile numbers may lie 2^64 apart.
    const auto step = static_cast<std::uint64_t>(sequence.number) -
                      static_cast<std::uint64_t>(last->second);
    constexpr std::uint64_t kMost = std::uint64_t{1} << 60;
    num_lost_ += static_cast<std::int64_t>(std::min(step - 1, kMost));
    num_lost_ = std::min(num_lost_, static_cast<std::int64_t>(kMost));
  }
  last->second = sequence.number;
}

}  // namespace waymark
