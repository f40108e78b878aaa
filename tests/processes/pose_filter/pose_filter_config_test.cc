#include "processes/pose_filter/pose_filter_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(PoseFilterConfig, RefusesWhatCannotWork) {
  const auto refused = [](auto spoil) -> std::string {
    PoseFilterConfig config;
    spoil(&config);
    try {
      config.Check();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused([](auto*) {}), "");
  EXPECT_THAT(refused([](auto* c) {
                c->nominal = {1, -1, 1};
              }),
              HasSubstr("wheels.nominal"));
  EXPECT_THAT(refused([](auto* c) {
                c->nominal_sigma = {1, 0, 1};
              }),
              HasSubstr("wheels.nominal_sigma"));
  EXPECT_THAT(refused([](auto* c) { c->gate.prior_regular = 0.9; }),
              HasSubstr("gate.prior_regular"));
  EXPECT_THAT(refused([](auto* c) { c->walk_per_sqrt_metre[1] = -1; }),
              HasSubstr("walk"));
  EXPECT_THAT(refused([](auto* c) { c->alignment.max_fixes = 4; }),
              HasSubstr("alignment.max_fixes"));
}

}  // namespace
}  // namespace waymark
