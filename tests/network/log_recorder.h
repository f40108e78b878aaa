// A recorder that loses nothing that reached this machine.
#pragma once

#include "processes/support/lcm_connection.h"
#include "processes/support/log_file.h"

#include <atomic>
#include <set>
#include <string>
#include <thread>

namespace waymark {

// lcm-logger holds 30 messages that it has not written yet and drops what comes
// then: enough to watch a robot, not to compare every byte on a machine that
// stood still for a moment. This one is read at real-time priority.
class LogRecorder {
 public:
  // Records the given channels until Stop(). Throws InputError where the URL
  // or the file does not serve.
  LogRecorder(const std::string& url,
              const std::set<std::string>& channels,
              const std::string& path);
  ~LogRecorder();
  LogRecorder(const LogRecorder&) = delete;
  LogRecorder& operator=(const LogRecorder&) = delete;

  // Writes what has arrived, and closes the file. Throws InputError where
  // writing failed.
  void Stop();

 private:
  void Run();

  LogWriter writer_;
  LcmConnection connection_;
  std::string fault_;
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace waymark
