#include "processes/support/lcm_url.h"

#include "estimation/base/input_error.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace waymark {
namespace {

constexpr std::string_view kDefaultGroup = "239.255.76.67";
constexpr int kDefaultPort = 7667;
constexpr int kDefaultBrokerPort = 7700;

// provider://network?key=value&key=value
struct Url {
  std::string provider;
  std::string network;
  std::vector<std::pair<std::string, std::string>> options;
};

// A descriptor that closes itself.
class Socket {
 public:
  Socket(int domain, int type)
      : fd_(::socket(domain, type | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

[[noreturn]] void Refuse(std::string_view url, const std::string& reason) {
  throw InputError(fmt::format("LCM URL {}: {}", url, reason));
}

std::optional<std::int64_t> ParseNumber(std::string_view text) {
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

Url Parse(std::string_view text) {
  Url url;
  const std::size_t colon = text.find("://");
  if (colon == std::string_view::npos) {
    Refuse(text,
           "must be provider://..., for example udpm://239.255.76.67:7667");
  }
  url.provider = text.substr(0, colon);
  constexpr std::array kProviders = {"udpm", "memq", "tcpq", "file", "mpudpm"};
  if (std::find(kProviders.begin(), kProviders.end(), url.provider) ==
      kProviders.end()) {
    Refuse(text,
           fmt::format("unknown provider; known: {}",
                       fmt::join(kProviders, ", ")));
  }
  std::string_view rest = text.substr(colon + 3);
  const std::size_t question = rest.find('?');
  url.network = rest.substr(0, question);
  while (question != std::string_view::npos && !rest.empty()) {
    rest.remove_prefix(std::min(rest.find_first_of("?&"), rest.size() - 1) + 1);
    const std::string_view option = rest.substr(0, rest.find('&'));
    const std::size_t equals = option.find('=');
    if (!option.empty()) {
      url.options.emplace_back(option.substr(0, equals),
                               equals == std::string_view::npos
                                   ? std::string_view{}
                                   : option.substr(equals + 1));
    }
    if (rest.find('&') == std::string_view::npos) break;
  }
  return url;
}

std::string Join(const Url& url) {
  std::string text = url.provider + "://" + url.network;
  char separator = '?';
  for (const auto& [key, value] : url.options) {
    text += fmt::format("{}{}={}", separator, key, value);
    separator = '&';
  }
  return text;
}

const std::string* Find(const Url& url, std::string_view key) {
  for (const auto& option : url.options) {
    if (option.first == key) return &option.second;
  }
  return nullptr;
}

struct Endpoint {
  std::string host;
  int port = 0;
};

Endpoint ParseEndpoint(std::string_view text,
                       const Url& url,
                       std::string_view default_host,
                       int default_port) {
  Endpoint endpoint{std::string(default_host), default_port};
  const std::size_t colon = url.network.find(':');
  const std::string host = url.network.substr(0, colon);
  if (!host.empty()) endpoint.host = host;
  if (colon != std::string::npos) {
    const auto port = ParseNumber(url.network.substr(colon + 1));
    if (!port || *port < 1 || *port > 65535) {
      Refuse(text, "the port must be a number in [1, 65535]");
    }
    endpoint.port = static_cast<int>(*port);
  }
  return endpoint;
}

Endpoint Group(std::string_view text, const Url& url) {
  Endpoint group = ParseEndpoint(text, url, kDefaultGroup, kDefaultPort);
  in_addr address{};
  if (::inet_pton(AF_INET, group.host.c_str(), &address) != 1 ||
      !IN_MULTICAST(ntohl(address.s_addr))) {
    Refuse(text, "the group must be an address in 224.0.0.0/4");
  }
  return group;
}

void CheckUdpOptions(std::string_view text, const Url& url) {
  for (const auto& option : url.options) {
    const auto& [key, value] = option;
    // Which of two would count is left to no one's guess.
    if (value.find('?') != std::string::npos) {
      Refuse(text, fmt::format("{} holds a second '?'", key));
    }
    if (Find(url, key) != &value) {
      Refuse(text, fmt::format("{} stands there twice", key));
    }
    std::int64_t min = 0;
    std::int64_t max = 0;
    if (key == "ttl") {
      max = 255;
    } else if (key == "recv_buf_size") {
      min = 1;
      max = std::numeric_limits<std::int32_t>::max();
    } else if (key != "transmit_only") {
      Refuse(text,
             fmt::format("unknown option {}; known: ttl, recv_buf_size", key));
    }
    const auto number = ParseNumber(value);
    if (max > 0 && (!number || *number < min || *number > max)) {
      Refuse(text,
             fmt::format("{} must be a number in [{}, {}]", key, min, max));
    }
  }
}

bool IsLoopbackUp(int fd) {
  ifreq request{};
  std::strncpy(request.ifr_name, "lo", IFNAMSIZ - 1);
  return ::ioctl(fd, SIOCGIFFLAGS, &request) == 0 &&
         (request.ifr_flags & IFF_UP) != 0;
}

void CheckMulticast(std::string_view text, const Url& url) {
  const Endpoint group = Group(text, url);
  const Socket socket(AF_INET, SOCK_DGRAM);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(group.port));
  ::inet_pton(AF_INET, group.host.c_str(), &address.sin_addr);
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  const bool works = ::connect(socket.fd(),
                               reinterpret_cast<const sockaddr*>(&address),
                               sizeof(address)) == 0 &&
                     ::setsockopt(socket.fd(),
                                  IPPROTO_IP,
                                  IP_ADD_MEMBERSHIP,
                                  &membership,
                                  sizeof(membership)) == 0;
  if (works) return;
  const int error = errno;
  throw InputError(fmt::format(
      "LCM cannot use {}:{}: {}; add a multicast route: sudo sh -c '{}ip route "
      "add 224.0.0.0/4 dev lo' (or dev of the network that robots share)",
      group.host,
      group.port,
      std::strerror(error),
      IsLoopbackUp(socket.fd()) ? "" : "ip link set lo up; "));
}

void CheckBroker(std::string_view text, const Url& url) {
  const Endpoint broker =
      ParseEndpoint(text, url, "127.0.0.1", kDefaultBrokerPort);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(
      broker.host.c_str(), std::to_string(broker.port).c_str(), &hints, &found);
  if (error != 0) {
    Refuse(text, fmt::format("{}: {}", broker.host, ::gai_strerror(error)));
  }
  const Socket socket(AF_INET, SOCK_STREAM);
  const bool answers =
      ::connect(socket.fd(), found->ai_addr, found->ai_addrlen) == 0;
  const int cause = errno;
  ::freeaddrinfo(found);
  if (answers) return;
  Refuse(text,
         fmt::format("no broker answers ({}); start one: java -cp "
                     "/usr/share/java/lcm.jar lcm.lcm.TCPService {}",
                     std::strerror(cause),
                     broker.port));
}

}  // namespace

std::string LcmUrl(std::string_view from_flag) {
  if (!from_flag.empty()) return CompleteLcmUrl(from_flag);
  const char* from_environment = std::getenv("LCM_DEFAULT_URL");
  if (from_environment != nullptr && *from_environment != '\0') {
    return CompleteLcmUrl(from_environment);
  }
  return CompleteLcmUrl(
      fmt::format("udpm://{}:{}", kDefaultGroup, kDefaultPort));
}

std::string CompleteLcmUrl(std::string_view text) {
  Url url = Parse(text);
  if (url.provider != "udpm") return std::string(text);
  Group(text, url);
  CheckUdpOptions(text, url);
  if (Find(url, "recv_buf_size") == nullptr) {
    url.options.emplace_back("recv_buf_size",
                             std::to_string(kReceiveBufferBytes));
  }
  if (Find(url, "ttl") == nullptr) url.options.emplace_back("ttl", "0");
  return Join(url);
}

void CheckLcmReachable(std::string_view text) {
  const Url url = Parse(text);
  if (url.provider == "udpm") CheckMulticast(text, url);
  if (url.provider == "tcpq") CheckBroker(text, url);
}

std::int64_t ReceiveBufferOf(std::string_view text) {
  const Url url = Parse(text);
  if (url.provider != "udpm") return 0;
  const std::string* value = Find(url, "recv_buf_size");
  return value == nullptr ? 0 : ParseNumber(*value).value_or(0);
}

std::string WithReceiveBuffer(std::string_view text, std::int64_t num_bytes) {
  Url url = Parse(text);
  for (auto& [key, value] : url.options) {
    if (key == "recv_buf_size") value = std::to_string(num_bytes);
  }
  return Join(url);
}

int PortOf(std::string_view text) {
  const Url url = Parse(text);
  return url.provider == "udpm" ? Group(text, url).port : 0;
}

std::int64_t LargestReceiveBuffer() {
  const Socket socket(AF_INET, SOCK_DGRAM);
  // Below half of int's range, since the kernel doubles it.
  constexpr int kMuch = 1 << 29;
  ::setsockopt(socket.fd(), SOL_SOCKET, SO_RCVBUF, &kMuch, sizeof(kMuch));
  int granted = 0;
  socklen_t size = sizeof(granted);
  ::getsockopt(socket.fd(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return granted / 2;
}

std::string WithGrantedBuffer(std::string_view url) {
  return WithReceiveBuffer(
      url, std::min(ReceiveBufferOf(url), 2 * LargestReceiveBuffer()));
}

}  // namespace waymark
