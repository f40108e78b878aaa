// The bus as a process sees it: typed publish and subscribe. LcmBus is live,
// ReplayBus runs a log, LocalBus runs several processes in one thread.
#pragma once

#include "estimation/base/time.h"
#include "processes/support/decode.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// What a subscription keeps while its handler is busy. Displaced or refused
// messages are counted on STATUS.
struct Keep {
  int max_messages = 0;  // Bound of the mailbox.
  bool newest = false;   // When full: true displaces the oldest, false refuses
                         // the arriving one.
  // Newest message only: images, states.
  static constexpr Keep Latest() { return {1, true}; }
  // Everything up to a bound: encoders, measurements.
  static constexpr Keep All(int bound = 4096) { return {bound, false}; }
};

// One message as it travels: the channel's name and the encoded bytes
// (fingerprint first).
struct RawMessage {
  std::string channel;
  std::vector<std::uint8_t> data;
  Time log_time;  // Receive time (live), event time stamp (log).
};

// Why a received message never reached, or was turned away by, its handler.
enum class Bad {
  kFingerprint,  // Another type, or too short for one.
  kDecode,       // The right type, cut short or with impossible lengths.
  kContent,      // Decoded, but refused by the handler (NaN, time backwards).
};

class Bus {
 public:
  virtual ~Bus() = default;

  // Calls `handler(message, t)` for each message of type M on `channel`, in
  // this bus's single handler thread; t is the message's own utime. All
  // subscriptions are made in the constructor of a process, none is undone.
  // Across the subscriptions of a process, messages are handled in the order
  // in which they arrived.
  template <typename M>
  void Subscribe(std::string_view channel,
                 Keep keep,
                 std::function<void(const M&, Time)> handler) {
    SubscribeRaw(Subscription{
        std::string(channel),
        static_cast<std::uint64_t>(M::getHash()),
        keep,
        [handler = std::move(handler)](
            std::span<const std::uint8_t> data) -> Delivery {
          const std::optional<M> message = DecodeMessage<M>(data);
          if (!message) return {};
          Delivery delivery{
              true, message->utime, SequenceOf(*message), SenderOf(*message)};
          handler(*message, TimeFromMicroseconds(message->utime));
          return delivery;
        }});
  }

  // Declares in the constructor of a process that it publishes on `channel`,
  // and, where several senders share the channel, under which `source` (the
  // message's field of that name; empty: all messages of the channel are this
  // process's). An offline run leaves these messages of the log out, since it
  // makes them anew.
  template <typename M>
  void Advertise(std::string_view channel, std::string_view source = {}) {
    AdvertiseRaw(Advertisement{
        std::string(channel),
        [source = std::string(source)](std::span<const std::uint8_t> data) {
          if (source.empty()) return true;
          if constexpr (requires(const M& m) { m.source; }) {
            const std::optional<M> message = DecodeMessage<M>(data);
            return message && message->source == source;
          } else {
            return true;
          }
        }});
  }

  // Encodes and sends on a channel that was advertised. Throws
  // std::logic_error where it was not, std::runtime_error where the bus cannot
  // send (message too large, log not writable).
  template <typename M>
  void Publish(std::string_view channel, const M& message) {
    std::vector<std::uint8_t> data(
        static_cast<std::size_t>(message.getEncodedSize()));
    const int size =
        message.encode(data.data(), 0, static_cast<int>(data.size()));
    // A text with a zero byte inside is cut there: fewer bytes than counted.
    data.resize(static_cast<std::size_t>(size));
    PublishRaw(channel, data, TimeFromMicroseconds(message.utime));
  }

  // Calls `action(now())` every `period` in the handler thread, first one
  // period after the bus starts. Made in the constructor of a process, never
  // undone. A call that comes late by several periods is made once.
  virtual void Every(Duration period, std::function<void(Time)> action) = 0;

  // The bus's own clock. Live: the wall clock when the bus was made plus the
  // steady time since, so it never jumps; offline the time of the event being
  // handled; simulated on LocalBus. For time-outs and for who makes messages
  // out of nothing (drivers, people); all others go by the messages' utime.
  [[nodiscard]] virtual Time now() const = 0;

  // A handler that finds a message's content impossible reports it here once:
  // counted per channel on STATUS, one rate-limited warning with `reason`.
  virtual void ReportBad(std::string_view channel,
                         Bad kind,
                         std::string_view reason) = 0;

  // Shown on STATUS until it is cleared with "".
  virtual void SetFault(std::string_view fault) = 0;

  // True where the bus runs offline and times that depend on the machine are
  // to be written as absent.
  [[nodiscard]] virtual bool is_offline() const = 0;

  struct Delivery {
    bool decoded = false;
    std::int64_t utime = 0;
    std::int64_t seq = -1;  // -1: this message carries none.
    std::string sender;     // Who counts seq; empty: one sender per channel.
  };
  struct Subscription {
    std::string channel;
    std::uint64_t fingerprint = 0;
    Keep keep;
    // Decodes and handles; what a handler throws passes through.
    std::function<Delivery(std::span<const std::uint8_t>)> deliver;
  };
  struct Advertisement {
    std::string channel;
    // Whether this process would have sent `data` on the channel.
    std::function<bool(std::span<const std::uint8_t>)> is_own;
  };

 protected:
  virtual void SubscribeRaw(Subscription subscription) = 0;
  virtual void AdvertiseRaw(Advertisement advertisement) = 0;
  virtual void PublishRaw(std::string_view channel,
                          std::span<const std::uint8_t> data,
                          Time utime) = 0;
};

}  // namespace waymark
