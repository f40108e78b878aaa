#include "planner/control/corridor_way.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

TEST(CorridorWayTest, GoesToAndFroOnTheAxis) {
  const auto way =
      CorridorWay({.begin = 2.0, .length = 10.0, .num_legs = 4, .zigzag = 0.0});
  ASSERT_EQ(way.size(), 4u);
  for (std::size_t i = 0; i < way.size(); ++i) {
    EXPECT_EQ(way[i], Eigen::Vector2d(i % 2 == 0 ? 12.0 : 2.0, 0.0));
  }
}

TEST(CorridorWayTest, ZigzagsToBothSidesAndEndsOnTheAxis) {
  const CorridorWayOptions options{
      .begin = 1.0, .length = 7.0, .num_legs = 2, .zigzag = 0.4};
  const auto way = CorridorWay(options);
  // At 2, 4 and 6 m of each leg, then its end.
  ASSERT_EQ(way.size(), 8u);
  EXPECT_EQ(way[0], Eigen::Vector2d(3.0, 0.4));
  EXPECT_EQ(way[1], Eigen::Vector2d(5.0, -0.4));
  EXPECT_EQ(way[3], Eigen::Vector2d(8.0, 0.0));
  EXPECT_EQ(way[4], Eigen::Vector2d(6.0, -0.4));
  EXPECT_EQ(way[7], Eigen::Vector2d(1.0, 0.0));
  for (std::size_t i = 1; i < way.size(); ++i) {
    EXPECT_EQ(way[i].x() > way[i - 1].x(), i < 4) << i;
  }
}

TEST(CorridorWayTest, RefusesWhatIsNoWay) {
  CorridorWayOptions options;
  options.length = 0.0;
  EXPECT_THROW((void)CorridorWay(options), std::invalid_argument);
  options = {};
  options.num_legs = 0;
  EXPECT_THROW((void)CorridorWay(options), std::invalid_argument);
  options = {};
  options.zigzag = -0.1;
  EXPECT_THROW((void)CorridorWay(options), std::invalid_argument);
  options = {};
  options.zigzag_step = 0.0;
  EXPECT_THROW((void)CorridorWay(options), std::invalid_argument);
  options = {};
  options.begin = std::nan("");
  EXPECT_THROW((void)CorridorWay(options), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
