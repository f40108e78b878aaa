// What every bus does alike: fingerprints, decoding, counting, faults.
#pragma once

#include "processes/support/bus.h"
#include "processes/support/timers.h"

#include <waymark/status_t.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace waymark {

// The bus of one process, without the transport. A transport hands arrived
// messages to Deliver() in its handler thread, and nothing here is touched
// from another thread.
class CountingBus : public Bus {
 public:
  // `process` names it on STATUS, CONFIG and in warnings.
  explicit CountingBus(std::string process);

  void ReportBad(std::string_view channel,
                 Bad kind,
                 std::string_view reason) override;
  void SetFault(std::string_view fault) override { fault_ = fault; }
  void Every(Duration period, std::function<void(Time)> action) override {
    timers_.Add(period, std::move(action));
  }

  // Checks the fingerprint, decodes, calls the handler, counts. `arrival`
  // counts the messages that arrived for this subscription from 1, including
  // those that were dropped before they came here: a gap in a sender's
  // sequence numbers is loss only where it is wider than the gap in `arrival`.
  // Returns the message's utime, nullopt where it was not handled. What the
  // handler throws passes through.
  std::optional<std::int64_t> Deliver(std::size_t subscription,
                                      std::span<const std::uint8_t> data,
                                      std::int64_t arrival);

  // Counts, fault, name and event time; the caller fills in what it knows of
  // host and sequence. Subscriptions of the runner itself are left out.
  [[nodiscard]] virtual status_t MakeStatus();
  // The newest time that this bus knows of, 0 where it knows none.
  [[nodiscard]] virtual std::int64_t event_utime() const { return 0; }

  // "receives A, B; sends C": what the process has declared so far.
  [[nodiscard]] std::string ChannelsText() const;

  // Run by the transport, on its clock.
  [[nodiscard]] Timers& timers() { return timers_; }
  [[nodiscard]] const Timers& timers() const { return timers_; }

  [[nodiscard]] const std::string& process() const { return process_; }
  [[nodiscard]] const std::vector<Subscription>& subscriptions() const {
    return subscriptions_;
  }
  [[nodiscard]] const std::string& fault() const { return fault_; }

  // Whether this process would have sent `data` on `channel`: advertised by
  // it, or its own STATUS or CONFIG.
  [[nodiscard]] bool IsOwn(std::string_view channel,
                           std::span<const std::uint8_t> data) const;

 protected:
  void SubscribeRaw(Subscription subscription) override;
  void AdvertiseRaw(Advertisement advertisement) override;
  // Call in PublishRaw: throws std::logic_error where the process has not
  // advertised the channel. Counts.
  void CountPublished(std::string_view channel);
  // Counts of what a mailbox saw, for MakeStatus.
  void SetArrivals(std::size_t subscription,
                   std::int64_t num_arrived,
                   std::int64_t num_dropped);
  // Subscriptions made from now on are the runner's own.
  void HideFurtherSubscriptions() { hide_subscriptions_ = true; }
  // Warnings thin out by count, not by a clock: the 1st, 10th, 100th, ...
  [[nodiscard]] static bool IsPowerOfTen(std::int64_t count);
  // One line for the user.
  virtual void Warn(const std::string& text);
  // Further words for the warning of lost messages.
  [[nodiscard]] virtual std::string LossAdvice() const { return {}; }

 private:
  struct Counter {
    std::int64_t num_received = 0;
    std::int64_t num_dropped = 0;
    std::int64_t num_lost = 0;
    std::int64_t num_bad = 0;
    std::int64_t last_arrival = 0;
    // Arrived, but never decoded: not lost, though its number is missing.
    std::int64_t num_unseen = 0;
    std::map<std::string, std::int64_t> last_seq;  // By sender.
    bool hidden = false;
  };

  void CountLoss(Counter* counter,
                 const std::string& channel,
                 const Delivery& delivery);
  void CountBad(Counter* counter,
                const std::string& channel,
                std::string_view reason);

  std::string process_;
  std::vector<Subscription> subscriptions_;
  std::vector<Counter> counters_;  // One per subscription.
  std::vector<Advertisement> advertisements_;
  Timers timers_;
  std::int64_t num_published_ = 0;
  std::string fault_;
  bool hide_subscriptions_ = false;
};

}  // namespace waymark
