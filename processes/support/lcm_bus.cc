#include "processes/support/lcm_bus.h"

#include "estimation/base/check.h"
#include "processes/support/channels.h"
#include "processes/support/input_error.h"
#include "processes/support/lcm_url.h"

#include <dirent.h>
#include <lcm/lcm.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/fmt/fmt.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#ifdef __SANITIZE_THREAD__
extern "C" void AnnotateIgnoreWritesBegin(const char* file, int line);
extern "C" void AnnotateIgnoreWritesEnd(const char* file, int line);
#endif

namespace waymark {
namespace {

// LCM's queue between its reader and our draining thread. Large enough for a
// burst while we are not scheduled; what overflows shows as a gap in the
// numbers.
constexpr int kLcmQueueMessages = 1000;
// LCM's limit of a channel's name.
constexpr std::size_t kMaxChannelBytes = 63;
// A twin that has been silent for some of its 1 Hz reports is gone.
constexpr std::chrono::seconds kTwinTimeout{5};

// A message this much older than the newest is not late: time went back.
constexpr std::uint64_t kLateMicroseconds = 10'000'000;

std::string HostName() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

// While one exists, threads that the calling thread makes run before ordinary
// ones, where the user may do that (root, or RLIMIT_RTPRIO). The
// stock receive buffer holds one raw image: on a busy machine LCM's reader, who
// only copies, must not wait for its turn.
class MakesUrgentThreads {
 public:
  MakesUrgentThreads() {
    ::pthread_getschedparam(::pthread_self(), &policy_, &parameters_);
    sched_param lowest_real_time{};
    lowest_real_time.sched_priority = 1;
    is_set_ = ::pthread_setschedparam(
                  ::pthread_self(), SCHED_RR, &lowest_real_time) == 0;
  }
  ~MakesUrgentThreads() {
    if (is_set_) {
      ::pthread_setschedparam(::pthread_self(), policy_, &parameters_);
    }
  }
  MakesUrgentThreads(const MakesUrgentThreads&) = delete;
  MakesUrgentThreads& operator=(const MakesUrgentThreads&) = delete;

 private:
  int policy_ = SCHED_OTHER;
  sched_param parameters_{};
  bool is_set_ = false;
};

// LCM reads channels as regular expressions.
std::string Literal(const std::string& channel) {
  std::string escaped;
  for (const char c : channel) {
    if (std::strchr("\\^$.|?*+()[]{}", c) != nullptr) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

// Port that a UDP socket is bound to, 0 for any other descriptor.
int BoundPort(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      address.sin_family != AF_INET) {
    return 0;
  }
  return ntohs(address.sin_port);
}

// Descriptors of this process's sockets on a UDP port.
std::vector<int> SocketsAt(int port) {
  std::vector<int> sockets;
  DIR* directory = port > 0 ? ::opendir("/proc/self/fd") : nullptr;
  if (directory == nullptr) return sockets;
  while (const dirent* entry = ::readdir(directory)) {
    const int fd = std::atoi(entry->d_name);
    if (fd > 2 && BoundPort(fd) == port) sockets.push_back(fd);
  }
  ::closedir(directory);
  return sockets;
}

// LCM hands messages from thread to thread under locks of GLib's, which the
// thread sanitizer cannot see, since both are built without it. While one
// exists it takes no note of what this thread writes.
class UnseenBySanitizer {
 public:
#ifdef __SANITIZE_THREAD__
  UnseenBySanitizer() {
    AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
  }
  ~UnseenBySanitizer() {
    AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
  }
#else
  UnseenBySanitizer() {}
  ~UnseenBySanitizer() {}
#endif
  UnseenBySanitizer(const UnseenBySanitizer&) = delete;
  UnseenBySanitizer& operator=(const UnseenBySanitizer&) = delete;
};

bool IsPowerOfTen(std::int64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

}  // namespace

void LcmBus::LcmCloser::operator()(lcm_t* lcm) const {
  lcm_destroy(lcm);
}

LcmBus::LcmBus(std::string process, const std::string& url)
    : CountingBus(std::move(process)),
      url_(url),
      port_(PortOf(url)),
      wanted_bytes_(2 * ReceiveBufferOf(url)),
      host_(HostName()) {
  CheckLcmReachable(url);
  // The kernel doubles what it is asked for, and LCM complains in three lines
  // of its own where the result is less than it asked for. We ask for what can
  // be had, and tell of it when it matters.
  const std::int64_t can_be_had = 2 * LargestReceiveBuffer();
  lcm_.reset(lcm_create(
      WithReceiveBuffer(url, std::min(ReceiveBufferOf(url), can_be_had))
          .c_str()));
  if (lcm_ == nullptr) throw InputError("LCM refuses the URL " + url);
  wake_fd_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  stop_fd_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  WAYMARK_CHECK(wake_fd_ >= 0 && stop_fd_ >= 0, std::strerror(errno));
}

LcmBus::~LcmBus() {
  Stop();
  lcm_.reset();
  ::close(wake_fd_);
  ::close(stop_fd_);
}

void LcmBus::SubscribeRaw(Subscription subscription) {
  WAYMARK_CHECK(!receiver_.joinable(), "subscribe before Start()");
  WAYMARK_CHECK(subscription.channel.size() <= kMaxChannelBytes,
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
  routes_.push_back(std::make_unique<Route>(Route{this, channel, {index}}));
  // LCM opens its socket, and makes the thread that reads it, with the first
  // subscription, and keeps both to itself.
  std::optional<MakesUrgentThreads> urgent;
  if (routes_.size() == 1) urgent.emplace();
  const std::vector<int> before = SocketsAt(routes_.size() == 1 ? port_ : 0);
  lcm_subscription_t* made = lcm_subscribe(
      lcm_.get(),
      Literal(channel).c_str(),
      [](const lcm_recv_buf_t* buffer, const char*, void* context) {
        const Route& target = *static_cast<const Route*>(context);
        target.bus->OnReceived(
            target,
            {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size},
            TimeFromMicroseconds(buffer->recv_utime));
      },
      routes_.back().get());
  if (made == nullptr) {
    throw InputError(url_ +
                     ": LCM cannot hear itself: is multicast blocked by a "
                     "firewall, or the interface of its route down?");
  }
  lcm_subscription_set_queue_capacity(made, kLcmQueueMessages);
  if (routes_.size() > 1) return;
  for (const int fd : SocketsAt(port_)) {
    if (std::find(before.begin(), before.end(), fd) == before.end()) {
      socket_fd_ = fd;
    }
  }
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
  constexpr int kBetween_ms = 5;
  pollfd wait{lcm_get_fileno(lcm_.get()), POLLIN, 0};
  while (::poll(&wait, 1, kBetween_ms) <= 0) {
    if (socket().num_waiting_bytes == 0 || Steady::now() > deadline) {
      return false;
    }
  }
  return Steady::now() <= deadline;
}

void LcmBus::Receive() {
  std::array<pollfd, 2> waits{pollfd{lcm_get_fileno(lcm_.get()), POLLIN, 0},
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
      if (lcm_handle(lcm_.get()) < 0) {
        throw std::runtime_error("LCM stopped receiving on " + url_);
      }
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
  WAYMARK_CHECK(channel.size() <= kMaxChannelBytes, channel);
  if (data.size() > LCM_MAX_MESSAGE_SIZE) {
    throw std::runtime_error(
        fmt::format("{}: a message of {} bytes, LCM takes "
                    "{} at most",
                    channel,
                    data.size(),
                    LCM_MAX_MESSAGE_SIZE));
  }
  if (channel != kStatus && channel != kConfig) {
    published_utime_ = Microseconds(utime);
  }
  const UnseenBySanitizer unseen;
  if (lcm_publish(lcm_.get(),
                  std::string(channel).c_str(),
                  data.data(),
                  static_cast<unsigned int>(data.size())) == 0) {
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

LcmBus::Socket LcmBus::socket() const {
  Socket socket;
  if (socket_fd_ < 0) return socket;
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof(info);
  if (::getsockopt(socket_fd_, SOL_SOCKET, SO_MEMINFO, info.data(), &size) !=
      0) {
    return socket;
  }
  socket.wanted_bytes = wanted_bytes_;
  socket.granted_bytes = info[SK_MEMINFO_RCVBUF];
  socket.num_waiting_bytes = info[SK_MEMINFO_RMEM_ALLOC];
  socket.num_dropped = info[SK_MEMINFO_DROPS];
  return socket;
}

std::string LcmBus::LossAdvice() const {
  const Socket now = socket();
  if (now.granted_bytes == 0 || now.num_dropped == 0) return {};
  if (now.granted_bytes < now.wanted_bytes) {
    return fmt::format(
        "; the receive buffer is too small ({} of {} KiB): sudo sysctl -w "
        "net.core.rmem_max={}",
        now.granted_bytes / 1024,
        now.wanted_bytes / 1024,
        now.wanted_bytes / 2);
  }
  return fmt::format(
      "; the receive buffer of {} KiB is too small: put a larger recv_buf_size "
      "into the LCM URL",
      now.granted_bytes / 1024);
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
  const std::int64_t num_datagrams = socket().num_dropped;
  if (num_datagrams > std::exchange(num_datagrams_shown_, num_datagrams)) {
    faults.push_back(fmt::format(
        "the kernel dropped {} datagrams{}", num_datagrams, LossAdvice()));
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
                     LossAdvice()));
  }
  status_t status = CountingBus::MakeStatus();
  status.utime = newest_utime_ != 0 ? newest_utime_ : published_utime_;
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
