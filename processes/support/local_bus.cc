#include "processes/support/local_bus.h"

#include "processes/support/counting_bus.h"
#include "processes/support/mailbox.h"

#include <map>
#include <optional>
#include <utility>

namespace waymark {

class LocalBus::Process final : public CountingBus {
 public:
  Process(std::string name, Duration latency, bool is_test, Impl* world)
      : CountingBus(std::move(name)),
        latency_(latency),
        is_test_(is_test),
        world_(world) {}

  [[nodiscard]] bool is_offline() const override { return true; }
  [[nodiscard]] status_t MakeStatus() override;
  [[nodiscard]] std::int64_t event_utime() const override;

  void OnArrival(const RawMessage& message, const Mailbox::Bytes& data);

 protected:
  void SubscribeRaw(Subscription subscription) override {
    mailbox_.AddQueue(subscription.keep);
    CountingBus::SubscribeRaw(std::move(subscription));
  }
  void PublishRaw(std::string_view channel,
                  std::span<const std::uint8_t> data,
                  Time utime) override;

 private:
  // Handles what waits, as far as handlers take no time.
  void Serve();

  Duration latency_;
  bool is_test_;
  Impl* world_;
  Mailbox mailbox_;
  bool is_busy_ = false;
};

class LocalBus::Impl {
 public:
  struct Event {
    std::string channel;
    std::vector<std::uint8_t> data;
    std::function<void()> action;  // Instead of a message.
  };

  void Queue(Time time, Event event) {
    events_.emplace(std::pair(std::max(time, now), next_sequence_++),
                    std::move(event));
  }

  // Delivers the next event, if it is not after `end`.
  bool Step(Time end) {
    const auto next = events_.begin();
    if (next == events_.end() || next->first.first > end) return false;
    now = next->first.first;
    Event event = std::move(next->second);
    events_.erase(next);
    if (event.action) {
      event.action();
      return true;
    }
    const auto data =
        std::make_shared<const std::vector<std::uint8_t>>(event.data);
    recording.push_back(
        RawMessage{std::move(event.channel), std::move(event.data), now});
    // A copy: a handler that adds a process or publishes must not move it.
    const std::string channel = recording.back().channel;
    const RawMessage arrived{channel, {}, now};
    for (std::size_t i = 0; i < processes.size(); ++i) {
      processes[i]->OnArrival(arrived, data);
    }
    return true;
  }

  std::vector<std::unique_ptr<Process>> processes;
  std::vector<RawMessage> recording;
  Time now;

 private:
  std::map<std::pair<Time, std::int64_t>, Event> events_;
  std::int64_t next_sequence_ = 0;
};

void LocalBus::Process::OnArrival(const RawMessage& message,
                                  const Mailbox::Bytes& data) {
  for (std::size_t i = 0; i < subscriptions().size(); ++i) {
    if (subscriptions()[i].channel != message.channel) continue;
    mailbox_.Push(i, data, message.log_time);
  }
  if (!is_busy_) Serve();
}

void LocalBus::Process::Serve() {
  while (std::optional<Mailbox::Item> item = mailbox_.Pop()) {
    Deliver(item->subscription, *item->data, item->arrival);
    if (latency_ == Duration(0)) continue;
    is_busy_ = true;
    world_->Queue(world_->now + latency_, {{}, {}, [this] {
                                             is_busy_ = false;
                                             Serve();
                                           }});
    return;
  }
}

void LocalBus::Process::PublishRaw(std::string_view channel,
                                   std::span<const std::uint8_t> data,
                                   Time /*utime*/) {
  if (!is_test_) CountPublished(channel);
  world_->Queue(world_->now + latency_,
                {std::string(channel), {data.begin(), data.end()}, {}});
}

std::int64_t LocalBus::Process::event_utime() const {
  return Microseconds(world_->now);
}

status_t LocalBus::Process::MakeStatus() {
  status_t status = CountingBus::MakeStatus();
  status.num_received = 0;
  for (std::size_t i = 0; i < status.channels.size(); ++i) {
    const Mailbox::Counts counts = mailbox_.counts(i);
    status.channels[i].num_received = counts.num_arrived;
    status.channels[i].num_dropped = counts.num_dropped;
    status.num_received += counts.num_arrived;
    status.num_dropped += counts.num_dropped;
  }
  return status;
}

LocalBus::LocalBus() : impl_(std::make_unique<Impl>()) {
  impl_->processes.push_back(
      std::make_unique<Process>("test", Duration(0), true, impl_.get()));
}

LocalBus::~LocalBus() = default;

Bus* LocalBus::AddProcess(std::string name, Duration handler_latency) {
  WAYMARK_CHECK(handler_latency >= Duration(0), handler_latency.count());
  impl_->processes.push_back(std::make_unique<Process>(
      std::move(name), handler_latency, false, impl_.get()));
  return impl_->processes.back().get();
}

Bus* LocalBus::bus() {
  return impl_->processes.front().get();
}

void LocalBus::PublishBytesAt(Time arrival,
                              std::string_view channel,
                              std::vector<std::uint8_t> data) {
  impl_->Queue(arrival, {std::string(channel), std::move(data), {}});
}

void LocalBus::CallAt(Time time, std::function<void()> action) {
  impl_->Queue(time, {{}, {}, std::move(action)});
}

void LocalBus::Run() {
  while (impl_->Step(Time::max())) {
  }
}

void LocalBus::RunUntil(Time end) {
  while (impl_->Step(end)) {
  }
  impl_->now = std::max(impl_->now, end);
}

Time LocalBus::now() const {
  return impl_->now;
}

const std::vector<RawMessage>& LocalBus::recording() const {
  return impl_->recording;
}

status_t LocalBus::Status(std::string_view name) const {
  for (const auto& process : impl_->processes) {
    if (process->process() == name) return process->MakeStatus();
  }
  WAYMARK_CHECK(false, "no process", name);
  return {};
}

}  // namespace waymark
