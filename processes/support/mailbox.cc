#include "processes/support/mailbox.h"

#include "estimation/base/check.h"

#include <utility>

namespace waymark {

void Mailbox::AddQueue(Keep keep) {
  WAYMARK_CHECK(keep.max_messages >= 1, keep.max_messages);
  const MutexLock lock(&mutex_);
  queues_.push_back(Queue{keep, {}, {}});
}

bool Mailbox::Push(std::size_t subscription, Bytes data, Time received) {
  const MutexLock lock(&mutex_);
  const bool was_empty = num_waiting_ == 0;
  Queue& queue = queues_.at(subscription);
  ++queue.counts.num_arrived;
  if (queue.entries.size() >=
      static_cast<std::size_t>(queue.keep.max_messages)) {
    ++queue.counts.num_dropped;
    if (!queue.keep.newest) return false;
    queue.entries.pop_front();
    --num_waiting_;
  }
  queue.entries.push_back(Entry{
      next_order_++,
      Item{subscription, std::move(data), received, queue.counts.num_arrived}});
  ++num_waiting_;
  return was_empty;
}

std::optional<Mailbox::Item> Mailbox::Pop() {
  const MutexLock lock(&mutex_);
  Queue* first = nullptr;
  for (Queue& queue : queues_) {
    if (queue.entries.empty()) continue;
    if (first == nullptr ||
        queue.entries.front().order < first->entries.front().order) {
      first = &queue;
    }
  }
  if (first == nullptr) return std::nullopt;
  Item item = std::move(first->entries.front().item);
  first->entries.pop_front();
  --num_waiting_;
  return item;
}

bool Mailbox::empty() const {
  const MutexLock lock(&mutex_);
  return num_waiting_ == 0;
}

Mailbox::Counts Mailbox::counts(std::size_t subscription) const {
  const MutexLock lock(&mutex_);
  return queues_.at(subscription).counts;
}

}  // namespace waymark
