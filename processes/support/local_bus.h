// Several processes in one thread, in lock-step: closed-loop simulation and
// tests of process classes.
#pragma once

#include "estimation/base/check.h"
#include "estimation/base/time.h"
#include "processes/support/bus.h"

#include <waymark/status_t.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// A world of processes with a simulated clock. Messages arrive in the order of
// (time, sequence of publication), so a run depends on nothing but its input.
//
//   LocalBus world;
//   PoseFilterProcess process(config, world.AddProcess("pose_filter"));
//   world.Publish(kEncoders, encoders);  // Arrives at its own utime.
//   world.Run();
//   const auto poses = world.Messages<pose_t>(kPose);
class LocalBus {
 public:
  // The clock starts at `start`, and so do timers; without it at the first
  // event.
  explicit LocalBus(std::optional<Time> start = std::nullopt);
  ~LocalBus();
  LocalBus(const LocalBus&) = delete;
  LocalBus& operator=(const LocalBus&) = delete;

  // The bus of one more process, owned by this object. Each of its handlers
  // takes `handler_latency` of simulated time: what it publishes arrives that
  // much later, and what arrives for it meanwhile waits in a mailbox under the
  // subscription's policy. At equal times processes are served in the order in
  // which they were added. A process receives its own messages too, as on LCM.
  Bus* AddProcess(std::string name, Duration handler_latency = Duration(0));

  // The test's own place on the bus: publishes (arriving at once, on any
  // channel) and subscribes.
  Bus* bus();

  // Input that arrives at the message's own utime.
  template <typename M>
  void Publish(std::string_view channel, const M& message) {
    PublishAt(TimeFromMicroseconds(message.utime), channel, message);
  }
  // Input that arrives at `arrival`, whatever its utime: late messages.
  template <typename M>
  void PublishAt(Time arrival, std::string_view channel, const M& message) {
    std::vector<std::uint8_t> data(
        static_cast<std::size_t>(message.getEncodedSize()));
    const int size =
        message.encode(data.data(), 0, static_cast<int>(data.size()));
    data.resize(static_cast<std::size_t>(size));  // As in Bus::Publish.
    PublishBytesAt(arrival, channel, std::move(data));
  }
  // Any bytes. What should have arrived before now() arrives now.
  void PublishBytesAt(Time arrival,
                      std::string_view channel,
                      std::vector<std::uint8_t> data);
  // Calls `action` at a time, between messages: a simulator's clock.
  void CallAt(Time time, std::function<void()> action);

  // Delivers until nothing is queued (timers run as long as something is), or
  // until everything up to and including `end` has been delivered and the
  // timers have run (now() is then `end`). At equal times messages come before
  // timers. What a handler throws passes through.
  void Run();
  void RunUntil(Time end);

  // Time of the event being delivered, or delivered last.
  [[nodiscard]] Time now() const;

  // From now on messages go here as they are delivered, and recording() gets no
  // more: for runs too long to be kept.
  void RecordTo(std::function<void(const RawMessage&)> sink);

  // Every message delivered so far, input and output, in order; log_time is
  // its time of arrival.
  [[nodiscard]] const std::vector<RawMessage>& recording() const;
  // Those of one channel. Throws std::logic_error where one is no M.
  template <typename M>
  [[nodiscard]] std::vector<M> Messages(std::string_view channel) const {
    std::vector<M> messages;
    for (const RawMessage& raw : recording()) {
      if (raw.channel != channel) continue;
      std::optional<M> message = DecodeMessage<M>(raw.data);
      WAYMARK_CHECK(message.has_value(), channel);
      messages.push_back(std::move(*message));
    }
    return messages;
  }

  // Counts and fault of a process that was added under `name`.
  [[nodiscard]] status_t Status(std::string_view name) const;

 private:
  class Process;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace waymark
