#include "procman/deputy/output_gate.h"

#include <algorithm>
#include <utility>

namespace waymark {
namespace {

// At the end of a line, else of a character, of at most `most` bytes.
std::size_t GoodLength(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text.size();
  const std::size_t line = text.rfind('\n', most == 0 ? 0 : most - 1);
  if (line != std::string::npos && most > 0) return line + 1;
  std::size_t length = most;
  while (length > 0 &&
         (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) {
    --length;
  }
  return length;
}

}  // namespace

OutputGate::OutputGate(const OutputGateOptions& options) : options_(options) {}

void OutputGate::Add(const std::string& command_id,
                     const std::string& text,
                     Duration now) {
  if (text.empty()) return;
  Command& command = commands_[command_id];
  if (!command.is_known) {
    command.is_known = true;
    command.budget = options_.burst_bytes;
  } else {
    command.budget = std::min(
        options_.burst_bytes,
        command.budget + options_.bytes_per_second * Seconds(now - command.at));
  }
  command.at = now;
  const std::size_t length =
      GoodLength(text, static_cast<std::size_t>(std::max(0.0, command.budget)));
  const auto num_cut = static_cast<std::int64_t>(text.size() - length);
  num_dropped_ += num_cut;
  std::string passed;
  if (length > 0 && command.num_left_out > 0) {
    passed = "[" + std::to_string(command.num_left_out) +
             " bytes of output left out here]\n";
    command.num_left_out = 0;
  }
  command.num_left_out += num_cut;
  passed += text.substr(0, length);
  command.budget -= static_cast<double>(length);
  if (passed.empty()) return;
  num_waiting_ += passed.size();
  const auto found = std::find_if(
      waiting_.begin(), waiting_.end(), [&command_id](const auto& waiting) {
        return waiting.command_id == command_id;
      });
  if (found == waiting_.end()) {
    waiting_.push_back({command_id, std::move(passed)});
  } else {
    found->text += passed;
  }
}

std::vector<OutputText> OutputGate::Take(Duration now) {
  const auto due = next();
  if (!due || *due > now) return {};
  last_sent_ = now;
  num_waiting_ = 0;
  return std::exchange(waiting_, {});
}

std::optional<Duration> OutputGate::next() const {
  if (waiting_.empty()) return std::nullopt;
  return num_waiting_ >= options_.full_bytes ? last_sent_
                                             : last_sent_ + options_.period;
}

}  // namespace waymark
