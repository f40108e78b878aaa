#include "processes/support/counting_bus.h"

#include "estimation/base/check.h"
#include "processes/support/channels.h"

#include <waymark/config_t.hpp>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace waymark {
namespace {

// Senders whose numbers are remembered per channel. A hostile or broken sender
// may invent names without end; those beyond the bound are not followed.
constexpr std::size_t kMaxSenders = 64;

// Whether a power of ten lies in (before, after].
bool PassesPowerOfTen(std::int64_t before, std::int64_t after) {
  for (std::int64_t power = 1; power <= after; power *= 10) {
    if (power > before) return true;
    if (power > after / 10) break;
  }
  return false;
}

}  // namespace

CountingBus::CountingBus(std::string process) : process_(std::move(process)) {}

void CountingBus::SubscribeRaw(Subscription subscription) {
  WAYMARK_CHECK(!subscription.channel.empty());
  WAYMARK_CHECK(subscription.keep.max_messages >= 1, subscription.channel);
  subscriptions_.push_back(std::move(subscription));
  counters_.emplace_back();
  counters_.back().hidden = hide_subscriptions_;
}

void CountingBus::AdvertiseRaw(Advertisement advertisement) {
  WAYMARK_CHECK(!advertisement.channel.empty());
  advertisements_.push_back(std::move(advertisement));
}

std::optional<std::int64_t> CountingBus::Deliver(
    std::size_t subscription,
    std::span<const std::uint8_t> data,
    std::int64_t arrival) {
  const Subscription& target = subscriptions_.at(subscription);
  Counter& counter = counters_[subscription];
  counter.num_received = std::max(counter.num_received, arrival);
  counter.num_unseen += arrival - counter.last_arrival - 1;
  counter.last_arrival = arrival;
  const std::optional<std::uint64_t> fingerprint = BigEndian64(data);
  if (fingerprint != target.fingerprint) {
    ++counter.num_unseen;
    CountBad(&counter,
             target.channel,
             fmt::format("{} bytes with fingerprint {:016x}, expected {:016x}",
                         data.size(),
                         fingerprint.value_or(0),
                         target.fingerprint));
    return std::nullopt;
  }
  const Delivery delivery = target.deliver(data);
  if (!delivery.decoded) {
    ++counter.num_unseen;
    CountBad(&counter,
             target.channel,
             fmt::format("{} bytes that do not decode", data.size()));
    return std::nullopt;
  }
  CountLoss(&counter, target.channel, delivery);
  return delivery.utime;
}

void CountingBus::CountLoss(Counter* counter,
                            const std::string& channel,
                            const Delivery& delivery) {
  if (delivery.seq < 0) return;
  const auto known = counter->last_seq.find(delivery.sender);
  if (known == counter->last_seq.end()) {
    // What a sender sent before we joined is not lost.
    if (counter->last_seq.size() < kMaxSenders) {
      counter->last_seq.emplace(delivery.sender, delivery.seq);
    }
    return;
  }
  const std::int64_t missing = delivery.seq - known->second - 1;
  known->second = delivery.seq;
  if (missing < 0) {
    // A number again or a smaller one: the sender has started anew.
    counter->num_unseen = 0;
    return;
  }
  const std::int64_t unseen = std::min(missing, counter->num_unseen);
  counter->num_unseen -= unseen;
  if (missing == unseen) return;
  const std::int64_t before = counter->num_lost;
  counter->num_lost += missing - unseen;
  if (PassesPowerOfTen(before, counter->num_lost)) {
    Warn(fmt::format("{}: {} messages lost on the way so far{}",
                     channel,
                     counter->num_lost,
                     LossAdvice()));
  }
}

void CountingBus::CountBad(Counter* counter,
                           const std::string& channel,
                           std::string_view reason) {
  ++counter->num_bad;
  if (IsPowerOfTen(counter->num_bad)) {
    Warn(fmt::format(
        "{}: dropped, {} bad so far: {}", channel, counter->num_bad, reason));
  }
}

void CountingBus::ReportBad(std::string_view channel,
                            Bad /*kind*/,
                            std::string_view reason) {
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    if (subscriptions_[i].channel != channel || counters_[i].hidden) continue;
    CountBad(&counters_[i], subscriptions_[i].channel, reason);
    return;
  }
  WAYMARK_CHECK(false, channel, "is not subscribed");
}

void CountingBus::CountPublished(std::string_view channel) {
  const bool advertised =
      channel == kStatus || channel == kConfig ||
      std::any_of(advertisements_.begin(),
                  advertisements_.end(),
                  [&](const Advertisement& a) { return a.channel == channel; });
  WAYMARK_CHECK(advertised,
                process_,
                "publishes on",
                channel,
                "without bus->Advertise<type>(channel) in its constructor");
  ++num_published_;
}

void CountingBus::SetArrivals(std::size_t subscription,
                              std::int64_t num_arrived,
                              std::int64_t num_dropped) {
  Counter& counter = counters_.at(subscription);
  counter.num_received = num_arrived;
  counter.num_dropped = num_dropped;
}

status_t CountingBus::MakeStatus() {
  status_t status{};
  status.utime = event_utime();
  status.process = process_;
  status.num_published = num_published_;
  status.fault = fault_;
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    const Counter& counter = counters_[i];
    if (counter.hidden) continue;
    channel_status_t channel{};
    channel.channel = subscriptions_[i].channel;
    channel.num_received = counter.num_received;
    channel.num_lost = counter.num_lost;
    channel.num_dropped = counter.num_dropped;
    channel.num_bad = counter.num_bad;
    status.num_received += channel.num_received;
    status.num_lost += channel.num_lost;
    status.num_dropped += channel.num_dropped;
    status.num_bad += channel.num_bad;
    status.channels.push_back(std::move(channel));
  }
  status.num_channels = static_cast<std::int32_t>(status.channels.size());
  return status;
}

std::string CountingBus::ChannelsText() const {
  std::set<std::string> received;
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    if (!counters_[i].hidden) received.insert(subscriptions_[i].channel);
  }
  std::set<std::string> sent;
  for (const Advertisement& it : advertisements_) sent.insert(it.channel);
  const auto list = [](const std::set<std::string>& channels) {
    std::string text;
    for (const std::string& channel : channels) {
      text += (text.empty() ? "" : ", ") + channel;
    }
    return text.empty() ? std::string("nothing") : text;
  };
  return "receives " + list(received) + "; sends " + list(sent);
}

bool CountingBus::IsOwn(std::string_view channel,
                        std::span<const std::uint8_t> data) const {
  if (channel == kStatus) {
    const auto status = DecodeMessage<status_t>(data);
    return status && status->process == process_;
  }
  if (channel == kConfig) {
    const auto config = DecodeMessage<config_t>(data);
    return config && config->process == process_;
  }
  return std::any_of(advertisements_.begin(),
                     advertisements_.end(),
                     [&](const Advertisement& a) {
                       return a.channel == channel && a.is_own(data);
                     });
}

bool CountingBus::IsPowerOfTen(std::int64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

void CountingBus::Warn(const std::string& text) {
  spdlog::warn("{}: {}", process_, text);
}

}  // namespace waymark
