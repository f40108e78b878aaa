// A number that tells contents apart.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace waymark {

// FNV-1a of 64 bits, the same on every machine of one byte order. Not against
// someone who wants two contents to look alike.
class Fingerprint {
 public:
  void AddBytes(std::span<const std::byte> bytes) {
    for (const std::byte b : bytes) {
      value_ = (value_ ^ static_cast<std::uint64_t>(b)) * 0x100000001b3u;
    }
  }
  // Values without padding, and their number, so that neighbours keep apart.
  template <typename T>
  requires std::is_arithmetic_v<T>
  void Add(std::span<const T> values) {
    Add(values.size());
    AddBytes(std::as_bytes(values));
  }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void Add(T value) { AddBytes(std::as_bytes(std::span<const T>(&value, 1))); }
  void Add(std::string_view text) {
    Add(std::span<const char>(text.data(), text.size()));
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace waymark
