#include "estimation/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace waymark {
namespace {

// The reference values of SplitMix64 with seed 1234567 (S. Vigna's
// splitmix64.c).
TEST(Random, IsSplitMix64) {
  Random random(1234567);
  EXPECT_EQ(random.Bits(), 6457827717110365317ull);
  EXPECT_EQ(random.Bits(), 3203168211198807973ull);
  EXPECT_EQ(random.Bits(), 9817491932198370423ull);
}

TEST(Random, NormalHasTheMomentsOfAStandardNormal) {
  Random random(5);
  constexpr int kDraws = 200000;
  double sum = 0, square = 0, fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double z = random.Normal();
    sum += z;
    square += z * z;
    fourth += z * z * z * z;
  }
  // Four standard deviations of each sample moment.
  EXPECT_NEAR(sum / kDraws, 0, 4 * std::sqrt(1.0 / kDraws));
  EXPECT_NEAR(square / kDraws, 1, 4 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourth / kDraws, 3, 4 * std::sqrt(96.0 / kDraws));
}

TEST(Random, UniformStaysInItsInterval) {
  Random random(6);
  double sum = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.Uniform(-2, 3);
    EXPECT_GE(u, -2);
    EXPECT_LT(u, 3);
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 4 * 5 / std::sqrt(12.0 * kDraws));
}

TEST(Random, SameSeedSameNumbers) {
  Random a(7), b(7), c(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double x = a.Normal();
    EXPECT_EQ(x, b.Normal());
    differs |= x != c.Normal();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, SeedsOfNamesAndOfSeedsDiffer) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    for (const char* name :
         {"", "a", "b", "aa", "robot.wheels", "robot.slip"}) {
      seeds.insert(SeedFor(seed, name));
    }
  }
  EXPECT_EQ(seeds.size(), 6000u);
  // Fixed: it decides what every stored experiment was run with.
  EXPECT_EQ(SeedFor(1, "robot.wheels"), SeedFor(1, "robot.wheels"));
}

}  // namespace
}  // namespace waymark
