#include "estimation/base/fingerprint.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace waymark {
namespace {

std::uint64_t Of(std::string_view text) {
  Fingerprint print;
  print.AddBytes(std::as_bytes(std::span<const char>(text)));
  return print.value();
}

// Values of the function's authors.
TEST(Fingerprint, IsFnv1aOf64Bits) {
  EXPECT_EQ(Of(""), 0xcbf29ce484222325u);
  EXPECT_EQ(Of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(Of("foobar"), 0x85944171f73967e8u);
}

TEST(Fingerprint, NeighboursKeepApart) {
  Fingerprint first;
  first.Add(std::string_view("ab"));
  first.Add(std::string_view("c"));
  Fingerprint second;
  second.Add(std::string_view("a"));
  second.Add(std::string_view("bc"));
  EXPECT_NE(first.value(), second.value());
}

}  // namespace
}  // namespace waymark
