#include "processes/support/replay_bus.h"

#include "estimation/base/check.h"
#include "estimation/base/input_error.h"
#include "processes/support/counting_bus.h"
#include "processes/support/status_reporter.h"

#include <spdlog/fmt/fmt.h>

#include <deque>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace waymark {

class ReplayBus::Process final : public CountingBus {
 public:
  Process(std::string name, std::string yaml, Impl* world)
      : CountingBus(std::move(name)),
        reporter(this, std::move(yaml)),
        world_(world) {}

  [[nodiscard]] bool is_offline() const override { return true; }
  [[nodiscard]] Time now() const override;

  void OnMessage(const RawMessage& message) {
    for (std::size_t i = 0; i < subscriptions().size(); ++i) {
      if (subscriptions()[i].channel != message.channel) continue;
      Deliver(i, message.data, ++num_arrived_[i]);
    }
  }

  StatusReporter reporter;

 protected:
  void SubscribeRaw(Subscription subscription) override {
    CountingBus::SubscribeRaw(std::move(subscription));
    num_arrived_.push_back(0);
  }
  void PublishRaw(std::string_view channel,
                  std::span<const std::uint8_t> data,
                  Time utime) override;

 private:
  std::vector<std::int64_t> num_arrived_;
  Impl* world_;
};

class ReplayBus::Impl {
 public:
  explicit Impl(Sink write) : write_(std::move(write)) {}

  void Handle(const LogEvent& event) {
    RunTimers(event.time);
    now_ = event.time;
    if (!std::exchange(has_begun, true)) Report();
    DeliverQueued();
    for (const auto& process : processes) {
      if (!process->IsOwn(event.channel, event.data)) continue;
      ++num_left_out;
      return;
    }
    Deliver(RawMessage{event.channel, event.data, event.time});
    DeliverQueued();
    Report();
  }

  void Finish() {
    DeliverQueued();
    for (const auto& process : processes) {
      process->reporter.ReportStatus(now_.time_since_epoch());
    }
    DeliverQueued();
  }

  void Queue(std::string_view channel, std::span<const std::uint8_t> data) {
    queue_.push_back(
        RawMessage{std::string(channel), {data.begin(), data.end()}, now_});
  }

  [[nodiscard]] Time now() const { return now_; }

  std::vector<std::unique_ptr<Process>> processes;
  bool has_begun = false;
  std::int64_t num_left_out = 0;

 private:
  // Timers due before or at `end`, each at its own time.
  void RunTimers(Time end) {
    // Nothing was recorded for so long: no robot ran.
    constexpr Duration kLongestGap = std::chrono::seconds(10);
    for (const auto& process : processes) {
      Timers& timers = process->timers();
      // Damaged logs have any time: a difference may be too large to be one.
      const bool is_gap = end < now_ || (now_ < Time::max() - kLongestGap &&
                                         now_ + kLongestGap < end);
      if (!timers.has_started() || is_gap) {
        timers.Start(end);
      }
    }
    while (Process* process = NextTimer(end)) {
      now_ = *process->timers().next();
      process->timers().RunDue(now_);
      DeliverQueued();
    }
  }

  // Of the process whose timer is due first, none where that is after `end`.
  Process* NextTimer(Time end) {
    Process* first = nullptr;
    for (const auto& process : processes) {
      const std::optional<Time> next = process->timers().next();
      if (!next || *next > end) continue;
      if (first == nullptr || *next < *first->timers().next()) {
        first = process.get();
      }
    }
    return first;
  }

  void Deliver(const RawMessage& message) {
    if (write_) write_(message.log_time, message.channel, message.data);
    for (const auto& process : processes) process->OnMessage(message);
  }

  void DeliverQueued() {
    while (!queue_.empty()) {
      RawMessage message = std::move(queue_.front());
      queue_.pop_front();
      message.log_time = now_;  // Published in a constructor: the first event.
      Deliver(message);
    }
  }

  void Report() {
    for (const auto& process : processes) {
      process->reporter.Report(now_.time_since_epoch());
    }
    DeliverQueued();
  }

  Sink write_;
  std::deque<RawMessage> queue_;
  Time now_;
};

Time ReplayBus::Process::now() const {
  return world_->now();
}

void ReplayBus::Process::PublishRaw(std::string_view channel,
                                    std::span<const std::uint8_t> data,
                                    Time /*utime*/) {
  CountPublished(channel);
  world_->Queue(channel, data);
}

ReplayBus::ReplayBus(Sink write)
    : impl_(std::make_unique<Impl>(std::move(write))) {}

ReplayBus::~ReplayBus() = default;

Bus* ReplayBus::AddProcess(std::string name, std::string yaml) {
  WAYMARK_CHECK(!impl_->has_begun, name);
  impl_->processes.push_back(
      std::make_unique<Process>(std::move(name), std::move(yaml), impl_.get()));
  return impl_->processes.back().get();
}

void ReplayBus::Handle(const LogEvent& event) {
  impl_->Handle(event);
}

void ReplayBus::Finish() {
  impl_->Finish();
}

status_t ReplayBus::Status(std::string_view name) const {
  for (const auto& process : impl_->processes) {
    if (process->process() == name) return process->MakeStatus();
  }
  WAYMARK_CHECK(false, "no process", name);
  return {};
}

std::int64_t ReplayBus::num_left_out() const {
  return impl_->num_left_out;
}

ReplayReport RunReplay(const std::vector<ReplayProcess>& processes,
                       const ReplayOptions& options) {
  std::set<std::string> names;
  std::vector<std::unique_ptr<ProcessSetup>> setups;
  for (const ReplayProcess& process : processes) {
    const std::string& name = process.process_class.name;
    if (!names.insert(name).second) {
      throw InputError(name + ": named twice; a log has one of each process");
    }
    if (process.process_class.is_live_only) {
      throw InputError(name + ": drives a device, so it cannot run on a log");
    }
    setups.push_back(process.process_class.make_setup());
    setups.back()->Load(process.config_path, process.settings);
  }
  LogReader reader(options.log_in);
  if (!options.log_out.empty()) {
    CheckOutput(options.log_out, options.if_exists, {&options.log_in, 1});
  }
  std::optional<LogWriter> writer;  // Made once all processes stand.
  ReplayBus::Sink sink;
  if (!options.log_out.empty()) {
    sink = [&writer](Time time,
                     std::string_view channel,
                     std::span<const std::uint8_t> data) {
      writer->Write(time, channel, data);
    };
  }
  ReplayBus bus(sink);
  std::vector<std::unique_ptr<RunningProcess>> running;
  for (std::size_t i = 0; i < processes.size(); ++i) {
    ProcessSetup* setup = setups[i].get();
    running.push_back(setup->Construct(bus.AddProcess(
        processes[i].process_class.name,
        PrintConfiguration([setup](Describer& d) { setup->Describe(d); }))));
  }
  if (sink) writer.emplace(options.log_out, options.if_exists);

  ReplayReport report;
  while (true) {
    if (options.stop && options.stop()) {
      report.was_stopped = true;
      break;
    }
    if (options.progress) options.progress(reader.offset());
    const std::optional<LogEvent> event = reader.Next();
    if (!event) break;
    try {
      bus.Handle(*event);
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("{}: event {} ({}): {}",
                                           options.log_in,
                                           reader.report().num_events - 1,
                                           event->channel,
                                           error.what()));
    }
  }
  for (const auto& process : running) process->Finish();
  bus.Finish();
  if (writer) {
    writer->Close();
    report.num_written = writer->num_events();
  }
  report.read = reader.report();
  report.num_left_out = bus.num_left_out();
  for (const ReplayProcess& process : processes) {
    report.statuses.push_back(bus.Status(process.process_class.name));
  }
  return report;
}

}  // namespace waymark
