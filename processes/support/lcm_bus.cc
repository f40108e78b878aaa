#include "processes/support/lcm_bus.h"

#include "estimation/base/check.h"
#include "processes/support/channels.h"

#include <poll.h>
#include <signal.h>
#include <spdlog/fmt/fmt.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// A twin that has been silent for some of its 1 Hz reports is gone.
constexpr std::chrono::seconds kTwinTimeout{5};

// A message this much older than the newest is not late: time went back.
constexpr std::uint64_t kLateMicroseconds = 10'000'000;

std::string HostName() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

Time WallTime() {
  return Time(std::chrono::duration_cast<Duration>(
      std::chrono::system_clock::now().time_since_epoch()));
}

}  // namespace

LcmBus::LcmBus(std::string process, const std::string& url)
    : CountingBus(std::move(process)),
      host_(HostName()),
      lcm_(url),
      start_time_(WallTime()),
      start_(Steady::now()) {
  wake_fd_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  stop_fd_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  WAYMARK_CHECK(wake_fd_ >= 0 && stop_fd_ >= 0, std::strerror(errno));
}

LcmBus::~LcmBus() {
  Stop();
  ::close(wake_fd_);
  ::close(stop_fd_);
}

void LcmBus::SubscribeRaw(Subscription subscription) {
  WAYMARK_CHECK(!receiver_.joinable(), "subscribe before Start()");
  WAYMARK_CHECK(subscription.channel.size() <= LcmConnection::kMaxChannelBytes,
                subscription.channel);
  const std::size_t index = subscriptions().size();
  const std::string channel = subscription.channel;
  mailbox_.AddQueue(subscription.keep);
  CountingBus::SubscribeRaw(std::move(subscription));
  for (const auto& route : routes_) {
    if (route->channel != channel) continue;
    route->subscriptions.push_back(index);
    return;
  }
  routes_.push_back(std::make_unique<Route>(Route{channel, {index}}));
  lcm_.Subscribe(channel,
                 [this, route = routes_.back().get()](
                     std::span<const std::uint8_t> data, Time received) {
                   OnReceived(*route, data, received);
                 });
}

void LcmBus::WatchForTwins() {
  HideFurtherSubscriptions();
  Subscribe<status_t>(
      kStatus, Keep::All(), [this](const status_t& status, Time) {
        OnStatusOfTwin(status);
      });
}

void LcmBus::OnStatusOfTwin(const status_t& status) {
  if (status.process != process()) return;
  if (status.host == host_ && status.pid == ::getpid()) return;
  twin_ = fmt::format("another {} publishes here (pid {} on {})",
                      status.process,
                      status.pid,
                      status.host);
  twin_seen_ = Steady::now();
  if (std::exchange(has_warned_of_twin_, true)) return;
  Warn(twin_ + ": stop one, or leave its channels out of the log being played");
}

void LcmBus::Start() {
  WAYMARK_CHECK(!receiver_.joinable());
  // Signals are for the thread that waits for them. LCM's own thread was made
  // by the first subscription.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  receiver_ = std::thread([this] { Receive(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  timers().Start(now());
}

void LcmBus::Stop() {
  if (!receiver_.joinable()) return;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(stop_fd_, &one, sizeof(one));
  receiver_.join();
}

void LcmBus::Wake() {
  const std::uint64_t one = 1;
  // Full only where it is readable anyway.
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof(one));
}

// What had arrived when the end was asked for is handed on: what waits in LCM's
// queue and in the socket.
bool LcmBus::HasArrived(Steady::time_point deadline) {
  // LCM's thread holds a message between the two for less than this.
  constexpr std::chrono::milliseconds kBetween{5};
  pollfd wait{lcm_.fd(), POLLIN, 0};
  while (::poll(&wait, 1, static_cast<int>(kBetween.count())) <= 0) {
    if (socket().num_waiting_bytes == 0 || Steady::now() > deadline) {
      return false;
    }
  }
  return Steady::now() <= deadline;
}

void LcmBus::Receive() {
  std::array<pollfd, 2> waits{pollfd{lcm_.fd(), POLLIN, 0},
                              pollfd{stop_fd_, POLLIN, 0}};
  // At the end: others may go on publishing faster than this is emptied.
  constexpr std::chrono::milliseconds kLongestEnd{500};
  std::optional<Steady::time_point> deadline;
  try {
    while (true) {
      if (deadline) {
        if (!HasArrived(*deadline)) return;
      } else {
        if (::poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) {
          throw std::runtime_error(std::string("poll: ") +
                                   std::strerror(errno));
        }
        if (waits[1].revents != 0) {
          deadline = Steady::now() + kLongestEnd;
          continue;
        }
        if (waits[0].revents == 0) continue;
      }
      lcm_.Handle();
      const MutexLock lock(&failure_mutex_);
      if (failure_) break;
    }
  } catch (...) {
    const MutexLock lock(&failure_mutex_);
    failure_ = std::current_exception();
  }
  Wake();
}

void LcmBus::OnReceived(const Route& route,
                        std::span<const std::uint8_t> data,
                        Time received) {
  // Nothing may be thrown through LCM's C code: the next handle would abort.
  try {
    const auto bytes = std::make_shared<const std::vector<std::uint8_t>>(
        data.begin(), data.end());
    bool was_empty = false;
    for (const std::size_t subscription : route.subscriptions) {
      was_empty |= mailbox_.Push(subscription, bytes, received);
    }
    if (was_empty) Wake();
  } catch (...) {
    const MutexLock lock(&failure_mutex_);
    failure_ = std::current_exception();
  }
}

bool LcmBus::HandleOne() {
  {
    const MutexLock lock(&failure_mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }
  std::optional<Mailbox::Item> item = mailbox_.Pop();
  if (!item) {
    // Clear first, look again: a message may have come in between.
    std::uint64_t count = 0;
    [[maybe_unused]] const auto read = ::read(wake_fd_, &count, sizeof(count));
    item = mailbox_.Pop();
    if (!item) return false;
    Wake();
  }
  const auto begin = Steady::now();
  const auto utime = Deliver(item->subscription, *item->data, item->arrival);
  worst_handler_ = std::max(worst_handler_, Steady::now() - begin);
  if (utime && subscriptions()[item->subscription].channel != kStatus) {
    NoteTime(*utime, Microseconds(item->received));
  }
  return true;
}

void LcmBus::RunTimers() {
  const std::optional<Time> next = timers().next();
  if (!next || *next > now()) return;
  const auto begin = Steady::now();
  timers().RunDue(now());
  worst_handler_ = std::max(worst_handler_, Steady::now() - begin);
}

std::optional<Duration> LcmBus::UntilNextTimer() const {
  const std::optional<Time> next = timers().next();
  if (!next) return std::nullopt;
  return *next - now();
}

Time LcmBus::now() const {
  return start_time_ +
         std::chrono::duration_cast<Duration>(Steady::now() - start_);
}

void LcmBus::NoteTime(std::int64_t utime, std::int64_t received_utime) {
  // Late messages do not set the time back; a log that is played again, a
  // clock that was set, or the message after one from the far future does.
  // Unsigned: a sender's utime may be anything.
  const auto difference = [](std::int64_t a, std::int64_t b) {
    return static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
  };
  if (utime < newest_utime_ &&
      difference(newest_utime_, utime) < kLateMicroseconds) {
    return;
  }
  newest_utime_ = utime;
  clock_offset_us_ =
      static_cast<std::int64_t>(difference(received_utime, utime));
}

void LcmBus::PublishRaw(std::string_view channel,
                        std::span<const std::uint8_t> data,
                        Time utime) {
  CountPublished(channel);
  WAYMARK_CHECK(channel.size() <= LcmConnection::kMaxChannelBytes, channel);
  if (data.size() > LcmConnection::kMaxMessageBytes) {
    throw std::runtime_error(
        fmt::format("{}: a message of {} bytes, LCM takes "
                    "{} at most",
                    channel,
                    data.size(),
                    LcmConnection::kMaxMessageBytes));
  }
  if (channel != kStatus && channel != kConfig) {
    published_utime_ = Microseconds(utime);
  }
  if (lcm_.Send(std::string(channel), data)) {
    // 30 messages take 60 ms: longer than a receiver waits for its turn.
    constexpr std::chrono::milliseconds kPause(2);
    if (is_paced_) std::this_thread::sleep_for(kPause);
    return;
  }
  // A network that went away may come back: the process lives on.
  const int error = errno;
  if (IsPowerOfTen(++num_unsent_)) {
    Warn(fmt::format("{}: {} messages not sent so far: {}",
                     channel,
                     num_unsent_,
                     std::strerror(error)));
  }
}

std::string LcmBus::Faults() {
  std::vector<std::string> faults;
  if (!fault().empty()) faults.push_back(fault());
  if (!twin_.empty() && Steady::now() - twin_seen_ > kTwinTimeout) {
    twin_.clear();
  }
  if (!twin_.empty()) faults.push_back(twin_);
  if (num_unsent_ > std::exchange(num_unsent_shown_, num_unsent_)) {
    faults.push_back(fmt::format("{} messages not sent", num_unsent_));
  }
  const Socket now = socket();
  if (now.num_dropped > std::exchange(num_datagrams_shown_, now.num_dropped)) {
    faults.push_back(fmt::format("the kernel dropped {} datagrams{}",
                                 now.num_dropped,
                                 now.LossAdvice()));
  }
  return fmt::format("{}", fmt::join(faults, "; "));
}

status_t LcmBus::MakeStatus() {
  for (std::size_t i = 0; i < subscriptions().size(); ++i) {
    const Mailbox::Counts counts = mailbox_.counts(i);
    SetArrivals(i, counts.num_arrived, counts.num_dropped);
  }
  const Socket now = socket();
  // The only sign where no message of a channel gets through whole.
  if (now.num_dropped >=
      std::max<std::int64_t>(10 * num_datagrams_warned_, 1)) {
    num_datagrams_warned_ = now.num_dropped;
    Warn(fmt::format("the kernel dropped {} datagrams so far{}",
                     now.num_dropped,
                     now.LossAdvice()));
  }
  status_t status = CountingBus::MakeStatus();
  status.host = host_;
  status.pid = ::getpid();
  status.num_datagrams_dropped = now.num_dropped;
  status.has_timing = 1;
  status.worst_handler_us =
      std::chrono::duration_cast<std::chrono::microseconds>(
          std::exchange(worst_handler_, Steady::duration(0)))
          .count();
  status.clock_offset_us = clock_offset_us_;
  status.fault = Faults();
  return status;
}

}  // namespace waymark
