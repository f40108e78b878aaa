#include "estimation/base/check.h"

#include <stdexcept>

namespace waymark {

void ThrowCheckFailure(const char* file,
                       int line,
                       const char* condition,
                       const std::string& values) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) +
                         ": check failed: " + condition + values);
}

}  // namespace waymark
