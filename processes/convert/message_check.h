// What the conversions from messages have in common.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>

namespace waymark {

// Always false; *reason becomes the values side by side. `reason` must not be
// null.
template <typename... Values>
bool Refuse(std::string* reason, const Values&... values) {
  std::ostringstream out;
  out.precision(9);
  (out << ... << values);
  *reason = out.str();
  return false;
}

// Differences and sums of times that are let pass do not overflow.
inline bool CheckTime(const char* key,
                      std::int64_t utime,
                      std::string* reason) {
  constexpr std::int64_t kMost = std::int64_t{1} << 60;  // Far in the future.
  if (utime > kMost) {
    return Refuse(reason, key, ": ", utime, " must be below ", kMost);
  }
  return utime > 0 || Refuse(reason, key, ": ", utime, " must be positive");
}

}  // namespace waymark
