// Where arrived messages wait for their handlers.
#pragma once

#include "estimation/base/mutex.h"
#include "estimation/base/time.h"
#include "processes/support/bus.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace waymark {

// One queue per subscription, each with its own policy `Keep`; taken out in
// the order of arrival across all of them. Thread-safe.
class Mailbox {
 public:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;
  struct Item {
    std::size_t subscription = 0;
    Bytes data;
    Time received;
    // Counts what arrived for this subscription from 1, displaced and refused
    // messages included.
    std::int64_t arrival = 0;
  };
  struct Counts {
    std::int64_t num_arrived = 0;
    std::int64_t num_dropped = 0;  // Displaced or refused.
  };

  // Adds a queue; they are numbered from 0. Throws std::logic_error where
  // keep.max_messages < 1.
  void AddQueue(Keep keep);

  // Returns true where nothing was waiting before: the reader needs a wake-up.
  bool Push(std::size_t subscription, Bytes data, Time received);

  // The message that arrived first.
  std::optional<Item> Pop();

  [[nodiscard]] bool empty() const;
  [[nodiscard]] Counts counts(std::size_t subscription) const;

 private:
  struct Entry {
    std::int64_t order = 0;  // Across all queues.
    Item item;
  };
  struct Queue {
    Keep keep;
    std::deque<Entry> entries;
    Counts counts;
  };

  mutable Mutex mutex_;
  std::vector<Queue> queues_ WAYMARK_GUARDED_BY(mutex_);
  std::int64_t next_order_ WAYMARK_GUARDED_BY(mutex_) = 0;
  std::size_t num_waiting_ WAYMARK_GUARDED_BY(mutex_) = 0;
};

}  // namespace waymark
