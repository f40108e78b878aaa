// What a user handed in and cannot be used: configuration, calibration, log,
// file.
#pragma once

#include <stdexcept>

namespace waymark {

// what() is the one line that the user sees: file, key or place, value,
// allowed range. RunProcess and RunTool print it and exit with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace waymark
