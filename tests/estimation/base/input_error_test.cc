#include "estimation/base/input_error.h"

#include <gtest/gtest.h>

#include <string>

namespace waymark {
namespace {

TEST(InputError, IsOneLineWhateverItQuotes) {
  const std::string quoted("a\nb\r\x1b[31m\x7f\0c", 12);
  EXPECT_STREQ(InputError(quoted).what(), "a\\nb\\x0d\\x1b[31m\\x7f\\x00c");
}

TEST(InputError, LeavesTextOfAnyLanguage) {
  EXPECT_STREQ(InputError("käse.yaml:3: ü").what(), "käse.yaml:3: ü");
}

}  // namespace
}  // namespace waymark
