// A network of a test's own.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace waymark {

// Moves the calling process, before it makes threads, into a new network
// namespace whose loopback carries multicast. Returns the reason where that is
// not allowed (it needs root), empty on success.
[[nodiscard]] std::string EnterNetworkNamespace();

// Removes and restores the multicast route of the current namespace.
void RemoveMulticastRoute();
void AddMulticastRoute();

// Sets net.core.rmem_max of the host and restores it, also where the test is
// killed: a child watches. Construct it before EnterNetworkNamespace(): inside
// one the setting cannot be seen.
class ReceiveBufferLimit {
 public:
  ReceiveBufferLimit();
  ~ReceiveBufferLimit();
  ReceiveBufferLimit(const ReceiveBufferLimit&) = delete;
  ReceiveBufferLimit& operator=(const ReceiveBufferLimit&) = delete;

  // False where it may not be set.
  [[nodiscard]] bool Set(std::int64_t num_bytes);

 private:
  int fd_ = -1;
  std::string before_;
  int alive_fd_ = -1;  // The watcher restores when this closes.
  pid_t watcher_ = -1;
};

}  // namespace waymark
