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

inline bool CheckTime(const char* key,
                      std::int64_t utime,
                      std::string* reason) {
  return utime > 0 || Refuse(reason, key, ": ", utime, " must be positive");
}

}  // namespace waymark
