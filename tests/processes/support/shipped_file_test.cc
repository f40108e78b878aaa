#include "processes/support/shipped_file.h"

#include "estimation/base/input_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace waymark {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

std::string Find(const std::string& name) {
  return FindShippedFile(name, "cameras", "drivers/simulator/cameras", ".yaml");
}

TEST(ShippedFile, IsFoundInTheSourceByItsName) {
  const std::string path = Find("mirror");
  EXPECT_THAT(path, EndsWith("drivers/simulator/cameras/mirror.yaml"));
  EXPECT_TRUE(std::filesystem::is_regular_file(path));
}

TEST(ShippedFile, APathIsLeftAsItIs) {
  EXPECT_EQ(Find("./mirror"), "./mirror");
  EXPECT_EQ(Find("/nowhere/a.yaml"), "/nowhere/a.yaml");
}

TEST(ShippedFile, AnUnknownNameListsThoseThereAre) {
  try {
    (void)Find("miror");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("'miror' is neither a file nor one of the "
                                "cameras: "),
                      HasSubstr("fisheye, mirror, panorama, perspective")));
  }
}

}  // namespace
}  // namespace waymark
