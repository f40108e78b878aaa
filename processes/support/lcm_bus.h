// The live bus of one process.
#pragma once

#include "estimation/base/mutex.h"
#include "processes/support/counting_bus.h"
#include "processes/support/lcm_connection.h"
#include "processes/support/mailbox.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace waymark {

// A thread of its own drains LCM into mailboxes, since LCM's own queue drops
// the newest messages and its socket overflows while a handler is busy. Where
// the user may (root, or RLIMIT_RTPRIO), LCM's reader runs at real-time
// priority. Handlers run in the caller's thread, in HandleOne(), in order of
// arrival.
//
// Not thread-safe: one thread constructs, subscribes, publishes, handles.
class LcmBus final : public CountingBus {
 public:
  // `url` as LcmUrl() makes it. Throws InputError where LCM cannot be created
  // with it: no multicast route, no broker.
  LcmBus(std::string process, const std::string& url);
  // Stops and joins; what still waits is dropped.
  ~LcmBus() override;
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  // Warns once, and shows it as a fault, where another process of the same
  // name publishes on this bus.
  void WatchForTwins();

  // Starts to receive; after all subscriptions.
  void Start();
  // Stops to receive, when all that has arrived is in (half a second at most).
  // It can still be handled.
  void Stop();
  // From now on a pause after each message: what a process still has to say at
  // its end comes in one burst, and receivers built on LCM alone (lcm-logger,
  // lcm-spy) keep 30 messages of a subscription and drop the rest.
  void PaceLastWords() { is_paced_ = true; }

  // Handles the message that arrived first; false where none waits. What a
  // handler throws passes through, and so does what ended the receiving
  // thread.
  bool HandleOne();

  // Makes the timers' calls that are due. What they throw passes through.
  void RunTimers();
  // Until the next one is due; nullopt without a timer.
  [[nodiscard]] std::optional<Duration> UntilNextTimer() const;

  [[nodiscard]] Time now() const override;

  // Readable while messages may wait; HandleOne() clears it once none does.
  [[nodiscard]] int wake_fd() const { return wake_fd_; }

  // With host, pid, times, and what this bus knows of loss; the worst handler
  // time starts anew.
  [[nodiscard]] status_t MakeStatus() override;
  // Of the messages handled, else of the one published last.
  [[nodiscard]] std::int64_t event_utime() const override {
    return newest_utime_ != 0 ? newest_utime_ : published_utime_;
  }

  [[nodiscard]] bool is_offline() const override { return false; }

  using Socket = LcmConnection::Socket;
  [[nodiscard]] Socket socket() const { return lcm_.socket(); }

 protected:
  void SubscribeRaw(Subscription subscription) override;
  void PublishRaw(std::string_view channel,
                  std::span<const std::uint8_t> data,
                  Time utime) override;
  [[nodiscard]] std::string LossAdvice() const override {
    return socket().LossAdvice();
  }

 private:
  using Steady = std::chrono::steady_clock;
  // One channel at LCM; several subscriptions may share it.
  struct Route {
    std::string channel;
    std::vector<std::size_t> subscriptions;
  };

  void Receive();
  [[nodiscard]] bool HasArrived(Steady::time_point deadline);
  void OnReceived(const Route& route,
                  std::span<const std::uint8_t> data,
                  Time received);
  void NoteTime(std::int64_t utime, std::int64_t received_utime);
  void OnStatusOfTwin(const status_t& status);
  [[nodiscard]] std::string Faults();
  void Wake();

  int wake_fd_ = -1;
  int stop_fd_ = -1;
  std::string host_;
  std::vector<std::unique_ptr<Route>> routes_;
  Mailbox mailbox_;
  LcmConnection lcm_;

  const Time start_time_;  // Of the wall clock, at start_.
  const Steady::time_point start_;
  Steady::duration worst_handler_{0};
  std::int64_t newest_utime_ = 0;     // Of those handled.
  std::int64_t published_utime_ = 0;  // Of the message published last.
  std::int64_t clock_offset_us_ = 0;
  std::int64_t num_unsent_ = 0;
  std::int64_t num_unsent_shown_ = 0;
  std::int64_t num_datagrams_shown_ = 0;
  std::int64_t num_datagrams_warned_ = 0;
  bool is_paced_ = false;
  std::string twin_;
  Steady::time_point twin_seen_;
  bool has_warned_of_twin_ = false;

  Mutex failure_mutex_;
  std::exception_ptr failure_ WAYMARK_GUARDED_BY(failure_mutex_);
  std::thread receiver_;
};

}  // namespace waymark
