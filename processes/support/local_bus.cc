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
  [[nodiscard]] Time now() const override;

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

  // Delivers the next event, or runs the next timer, if that is not after
  // `end`.
  bool Step(Time end) {
    const auto next = events_.begin();
    const bool has_event = next != events_.end() && next->first.first <= end;
    if (has_event && !has_started) StartTimers(next->first.first);
    const Time until = has_event ? next->first.first : end;
    if (RunTimer(until, !has_event)) return true;
    if (!has_event) return false;
    now = next->first.first;
    Event event = std::move(next->second);
    events_.erase(next);
    if (event.action) {
      event.action();
      return true;
    }
    const auto data =
        std::make_shared<const std::vector<std::uint8_t>>(event.data);
    // A copy: a handler that adds a process or publishes must not move it.
    const RawMessage arrived{event.channel, {}, now};
    RawMessage message{std::move(event.channel), std::move(event.data), now};
    if (sink) {
      sink(message);
    } else {
      recording.push_back(std::move(message));
    }
    for (std::size_t i = 0; i < processes.size(); ++i) {
      processes[i]->OnArrival(arrived, data);
    }
    return true;
  }

  [[nodiscard]] bool has_event() const { return !events_.empty(); }

  void StartTimers(Time time) {
    has_started = true;
    for (const auto& process : processes) process->timers().Start(time);
  }

  std::vector<std::unique_ptr<Process>> processes;
  std::vector<RawMessage> recording;
  std::function<void(const RawMessage&)> sink;
  Time now;
  bool has_started = false;

 private:
  // Runs the timer that is due first: before `until`, or at it where nothing
  // else is (`includes_end`).
  bool RunTimer(Time until, bool includes_end) {
    Process* first = nullptr;
    for (const auto& process : processes) {
      const std::optional<Time> next = process->timers().next();
      if (!next || *next > until || (*next == until && !includes_end)) continue;
      if (first == nullptr || *next < *first->timers().next()) {
        first = process.get();
      }
    }
    if (first == nullptr) return false;
    now = *first->timers().next();
    first->timers().RunDue(now);
    return true;
  }

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

Time LocalBus::Process::now() const {
  return world_->now;
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

LocalBus::LocalBus(std::optional<Time> start)
    : impl_(std::make_unique<Impl>()) {
  impl_->processes.push_back(
      std::make_unique<Process>("test", Duration(0), true, impl_.get()));
  if (!start) return;
  impl_->now = *start;
  impl_->StartTimers(*start);
}

LocalBus::~LocalBus() = default;

Bus* LocalBus::AddProcess(std::string name, Duration handler_latency) {
  WAYMARK_CHECK(handler_latency >= Duration(0), handler_latency.count());
  impl_->processes.push_back(std::make_unique<Process>(
      std::move(name), handler_latency, false, impl_.get()));
  if (impl_->has_started) impl_->processes.back()->timers().Start(impl_->now);
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
  while (impl_->has_event() && impl_->Step(Time::max())) {
  }
}

void LocalBus::RecordTo(std::function<void(const RawMessage&)> sink) {
  impl_->sink = std::move(sink);
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
