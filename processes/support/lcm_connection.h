// LCM's C library as LcmBus needs it.
#pragma once

#include "estimation/base/time.h"

#include <lcm/lcm.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace waymark {

// One process's handle of LCM, with the socket and the reading thread that LCM
// makes and keeps to itself. Where the user may (root, or RLIMIT_RTPRIO), that
// thread runs at real-time priority.
//
// One thread may Handle() while another sends; Subscribe() before either.
class LcmConnection {
 public:
  // LCM's limits of a channel's name and of a message.
  static constexpr std::size_t kMaxChannelBytes = 63;
  static constexpr std::size_t kMaxMessageBytes = LCM_MAX_MESSAGE_SIZE;

  // Must not throw: LCM's next handle would abort.
  using Handler =
      std::function<void(std::span<const std::uint8_t> data, Time received)>;

  // `url` as LcmUrl() makes it. Throws InputError where LCM cannot be created
  // with it: no multicast route, no broker.
  explicit LcmConnection(std::string url);

  // Once per channel, whose name is taken literally. Throws InputError where
  // LCM cannot receive.
  void Subscribe(const std::string& channel, Handler handler);

  // Readable while Handle() has a message.
  [[nodiscard]] int fd() const;
  // Waits for one message and calls its handler. Throws std::runtime_error
  // where LCM stopped receiving.
  void Handle();

  // False, with errno, where the message was not sent.
  [[nodiscard]] bool Send(const std::string& channel,
                          std::span<const std::uint8_t> data);

  // Bytes that the kernel holds for this process (what it grants is twice
  // what was asked for), and datagrams that it dropped since they did not fit.
  // 0 where the transport is not UDP, and before the first subscription.
  struct Socket {
    std::int64_t wanted_bytes = 0;
    std::int64_t granted_bytes = 0;
    std::int64_t num_waiting_bytes = 0;  // Not read by LCM's thread yet.
    std::int64_t num_dropped = 0;

    // What to do against dropped datagrams, as the end of a sentence; empty
    // where there are none.
    [[nodiscard]] std::string LossAdvice() const;
  };
  [[nodiscard]] Socket socket() const;

 private:
  struct Closer {
    void operator()(lcm_t* lcm) const;
  };

  std::string url_;
  int port_ = 0;
  std::int64_t wanted_bytes_ = 0;
  int socket_fd_ = -1;  // LCM's own receiving socket.
  std::vector<std::unique_ptr<Handler>> handlers_;
  std::unique_ptr<lcm_t, Closer> lcm_;
};

}  // namespace waymark
