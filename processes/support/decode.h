// The one way from bytes of others to a message.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

namespace waymark {

// Decodes one whole message of type M, fingerprint first. Returns nullopt for
// another type's fingerprint, a message cut short, bytes left over, or lengths
// that do not fit; takes no more memory than about ten times the data (the
// generated headers bound each length by the bytes that are left).
template <typename M>
[[nodiscard]] std::optional<M> DecodeMessage(
    std::span<const std::uint8_t> data) {
  if (data.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return std::nullopt;
  }
  const int size = static_cast<int>(data.size());
  std::optional<M> message(std::in_place);
  if (message->decode(data.data(), 0, size) != size) message.reset();
  return message;
}

// First eight bytes as an unsigned big-endian number: of a message, its
// fingerprint. nullopt if there are fewer.
[[nodiscard]] inline std::optional<std::uint64_t> BigEndian64(
    std::span<const std::uint8_t> data) {
  if (data.size() < 8) return std::nullopt;
  std::uint64_t value = 0;
  for (const std::uint8_t byte : data.first(8)) value = value << 8 | byte;
  return value;
}

// Sequence number by which a receiver sees loss: the field seq, or for images
// the metadata "seq" (eight bytes, big endian). -1: carries none.
template <typename M>
[[nodiscard]] std::int64_t SequenceOf(const M& message) {
  if constexpr (requires { message.seq; }) {
    return message.seq;
  } else if constexpr (requires { message.metadata[0].value; }) {
    for (const auto& item : message.metadata) {
      if (item.key != "seq" || item.value.size() != 8) continue;
      return static_cast<std::int64_t>(*BigEndian64(item.value));
    }
    return -1;
  } else {
    return -1;
  }
}

// Several senders may share a channel, each counting for itself: its source
// or process (with host and pid, where two may run); empty where the type names
// none.
template <typename M>
[[nodiscard]] std::string SenderOf(const M& message) {
  if constexpr (requires {
                  message.host + message.process;
                  message.pid;
                }) {
    return message.process + ' ' + message.host + ' ' +
           std::to_string(message.pid);
  } else if constexpr (requires { message.process; }) {
    return message.process;
  } else if constexpr (requires { message.source; }) {
    return message.source;
  } else {
    return {};
  }
}

}  // namespace waymark
