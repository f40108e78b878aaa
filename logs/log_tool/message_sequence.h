// Sequence numbers in messages of any type, and the losses they show.
#pragma once

#include "logs/log_tool/type_table.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace waymark {

struct MessageSequence {
  std::int64_t number = 0;
  std::string sender;  // Its source or process: each counts for itself.
};

// The field seq, or the metadata "seq" of an image; nullopt where the message
// has none or does not decode.
[[nodiscard]] std::optional<MessageSequence> SequenceOfMessage(
    const MessageTypeInfo& type, std::span<const std::uint8_t> data);

// Counts the numbers that are missing on one channel. A number that does not
// go up is a sender's restart.
class SequenceCounter {
 public:
  void Add(const MessageSequence& sequence);
  // -1 where no message had a number.
  [[nodiscard]] std::int64_t num_lost() const { return num_lost_; }
  [[nodiscard]] std::int64_t num_restarts() const { return num_restarts_; }

 private:
  std::map<std::string, std::int64_t> last_;
  std::int64_t num_lost_ = -1;
  std::int64_t num_restarts_ = 0;
};

}  // namespace waymark
