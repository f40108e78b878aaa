#include "processes/support/mailbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::Pair;

Mailbox::Bytes Bytes(std::uint8_t value) {
  return std::make_shared<const std::vector<std::uint8_t>>(1, value);
}

// (subscription, value) in the order in which they come out.
std::vector<std::pair<int, int>> Drain(Mailbox* mailbox) {
  std::vector<std::pair<int, int>> items;
  while (const auto item = mailbox->Pop()) {
    items.emplace_back(static_cast<int>(item->subscription), (*item->data)[0]);
  }
  return items;
}

TEST(Mailbox, ComesOutInOrderOfArrivalAcrossQueues) {
  Mailbox mailbox;
  mailbox.AddQueue(Keep::All());
  mailbox.AddQueue(Keep::All());
  EXPECT_TRUE(mailbox.Push(1, Bytes(1), {}));
  EXPECT_FALSE(mailbox.Push(0, Bytes(2), {}));
  EXPECT_FALSE(mailbox.Push(0, Bytes(3), {}));
  EXPECT_FALSE(mailbox.Push(1, Bytes(4), {}));
  EXPECT_THAT(Drain(&mailbox),
              ElementsAre(Pair(1, 1), Pair(0, 2), Pair(0, 3), Pair(1, 4)));
  EXPECT_TRUE(mailbox.empty());
  EXPECT_TRUE(mailbox.Push(0, Bytes(5), {}));
}

TEST(Mailbox, LatestDisplacesTheOldestAndTakesItsOwnPlace) {
  Mailbox mailbox;
  mailbox.AddQueue(Keep::Latest());
  mailbox.AddQueue(Keep::All());
  mailbox.Push(0, Bytes(1), {});
  mailbox.Push(1, Bytes(2), {});
  mailbox.Push(0, Bytes(3), {});
  EXPECT_THAT(Drain(&mailbox), ElementsAre(Pair(1, 2), Pair(0, 3)));
  EXPECT_EQ(mailbox.counts(0).num_arrived, 2);
  EXPECT_EQ(mailbox.counts(0).num_dropped, 1);
  EXPECT_EQ(mailbox.counts(1).num_dropped, 0);
}

TEST(Mailbox, NewestKeepsTheLastFew) {
  Mailbox mailbox;
  mailbox.AddQueue(Keep{3, true});
  for (std::uint8_t i = 0; i < 10; ++i) mailbox.Push(0, Bytes(i), {});
  EXPECT_THAT(Drain(&mailbox), ElementsAre(Pair(0, 7), Pair(0, 8), Pair(0, 9)));
  EXPECT_EQ(mailbox.counts(0).num_dropped, 7);
}

TEST(Mailbox, AllRefusesTheArrivingOne) {
  Mailbox mailbox;
  mailbox.AddQueue(Keep::All(3));
  for (std::uint8_t i = 0; i < 10; ++i) mailbox.Push(0, Bytes(i), {});
  const auto first = mailbox.Pop();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->arrival, 1);
  // Refused: 3 to 9. The next one has arrival number 11.
  mailbox.Push(0, Bytes(10), {});
  EXPECT_THAT(Drain(&mailbox),
              ElementsAre(Pair(0, 1), Pair(0, 2), Pair(0, 10)));
  EXPECT_EQ(mailbox.counts(0).num_arrived, 11);
  EXPECT_EQ(mailbox.counts(0).num_dropped, 7);
}

TEST(Mailbox, EmptyBoundIsRefused) {
  Mailbox mailbox;
  EXPECT_THROW(mailbox.AddQueue(Keep{0, true}), std::logic_error);
}

TEST(Mailbox, TwoThreadsLoseNothing) {
  Mailbox mailbox;
  mailbox.AddQueue(Keep::All(100000));
  mailbox.AddQueue(Keep::All(100000));
  constexpr int kNumEach = 5000;
  std::thread writer([&] {
    for (int i = 0; i < kNumEach; ++i) {
      mailbox.Push(0, Bytes(0), TimeFromMicroseconds(2 * i));
      mailbox.Push(1, Bytes(1), TimeFromMicroseconds(2 * i + 1));
    }
  });
  std::int64_t expected = 0;
  while (expected < 2 * kNumEach) {
    const auto item = mailbox.Pop();
    if (!item) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(Microseconds(item->received), expected);
    ++expected;
  }
  writer.join();
  EXPECT_TRUE(mailbox.empty());
}

}  // namespace
}  // namespace waymark
