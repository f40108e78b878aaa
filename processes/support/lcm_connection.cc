#include "processes/support/lcm_connection.h"

#include "estimation/base/input_error.h"
#include "processes/support/lcm_url.h"

#include <dirent.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <pthread.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <optional>
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

// While one exists, threads that the calling thread makes run before ordinary
// ones, where the user may do that (root, or RLIMIT_RTPRIO). The stock receive
// buffer holds one raw image: on a busy machine LCM's reader, who only copies,
// must not wait for its turn.
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

// Port that an IPv4 socket is bound to, 0 for any other descriptor.
int BoundPort(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
      address.sin_family != AF_INET) {
    return 0;
  }
  return ntohs(address.sin_port);
}

// Descriptors of this process's sockets on a port.
std::vector<int> SocketsAt(int port) {
  std::vector<int> sockets;
  DIR* directory = port > 0 ? ::opendir("/proc/self/fd") : nullptr;
  if (directory == nullptr) return sockets;
  while (const dirent* entry = ::readdir(directory)) {
    if (entry->d_name[0] == '.') continue;
    const int fd = std::atoi(entry->d_name);
    if (BoundPort(fd) == port) sockets.push_back(fd);
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

}  // namespace

void LcmConnection::Closer::operator()(lcm_t* lcm) const {
  lcm_destroy(lcm);
}

LcmConnection::LcmConnection(std::string url)
    : url_(std::move(url)),
      port_(PortOf(url_)),
      wanted_bytes_(2 * ReceiveBufferOf(url_)) {
  CheckLcmReachable(url_);
  // What it is short of is told when it matters.
  lcm_.reset(lcm_create(WithGrantedBuffer(url_).c_str()));
  if (lcm_ == nullptr) throw InputError("LCM refuses the URL " + url_);
}

void LcmConnection::Subscribe(const std::string& channel, Handler handler) {
  handlers_.push_back(std::make_unique<Handler>(std::move(handler)));
  // LCM opens its socket, and makes the thread that reads it, with the first
  // subscription.
  const bool is_first = handlers_.size() == 1;
  std::optional<MakesUrgentThreads> urgent;
  if (is_first) urgent.emplace();
  const std::vector<int> before = SocketsAt(is_first ? port_ : 0);
  lcm_subscription_t* made = lcm_subscribe(
      lcm_.get(),
      Literal(channel).c_str(),
      [](const lcm_recv_buf_t* buffer, const char*, void* context) {
        (*static_cast<const Handler*>(context))(
            {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size},
            TimeFromMicroseconds(buffer->recv_utime));
      },
      handlers_.back().get());
  if (made == nullptr) {
    throw InputError(url_ +
                     ": LCM cannot hear itself: is multicast blocked by a "
                     "firewall, or the interface of its route down?");
  }
  lcm_subscription_set_queue_capacity(made, kLcmQueueMessages);
  if (!is_first) return;
  for (const int fd : SocketsAt(port_)) {
    if (std::find(before.begin(), before.end(), fd) == before.end()) {
      socket_fd_ = fd;
    }
  }
}

int LcmConnection::fd() const {
  return lcm_get_fileno(lcm_.get());
}

void LcmConnection::Handle() {
  if (lcm_handle(lcm_.get()) < 0) {
    throw std::runtime_error("LCM stopped receiving on " + url_);
  }
}

bool LcmConnection::Send(const std::string& channel,
                         std::span<const std::uint8_t> data) {
  const UnseenBySanitizer unseen;
  return lcm_publish(lcm_.get(),
                     channel.c_str(),
                     data.data(),
                     static_cast<unsigned int>(data.size())) == 0;
}

LcmConnection::Socket LcmConnection::socket() const {
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

std::string LcmConnection::Socket::LossAdvice() const {
  if (granted_bytes == 0 || num_dropped == 0) return {};
  if (granted_bytes < wanted_bytes) {
    return fmt::format(
        "; the receive buffer is too small ({} of {} KiB): sudo sysctl -w "
        "net.core.rmem_max={}",
        granted_bytes / 1024,
        wanted_bytes / 1024,
        wanted_bytes / 2);
  }
  return fmt::format(
      "; the receive buffer of {} KiB is too small: put a larger recv_buf_size "
      "into the LCM URL",
      granted_bytes / 1024);
}

}  // namespace waymark
