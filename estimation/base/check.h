// Contract checks that are always on.
#pragma once

#include <sstream>
#include <string>

namespace waymark {

// Throws std::logic_error with "file:line: condition: values". Called by
// WAYMARK_CHECK only.
[[noreturn]] void ThrowCheckFailure(const char* file,
                                    int line,
                                    const char* condition,
                                    const std::string& values);

namespace check_internal {
template <typename... Values>
std::string Join(const Values&... values) {
  std::ostringstream out;
  out.precision(17);
  ((out << ' ' << values), ...);
  return out.str();
}
}  // namespace check_internal

}  // namespace waymark

// The caller broke the contract unless `condition` holds; further arguments
// are streamed into the message.
#define WAYMARK_CHECK(condition, ...)                    \
  do {                                                   \
    if (!(condition)) {                                  \
      ::waymark::ThrowCheckFailure(                      \
          __FILE__,                                      \
          __LINE__,                                      \
          #condition,                                    \
          ::waymark::check_internal::Join(__VA_ARGS__)); \
    }                                                    \
  } while (false)
