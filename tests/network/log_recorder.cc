#include "tests/network/log_recorder.h"

#include <poll.h>

#include <span>

namespace waymark {

LogRecorder::LogRecorder(const std::string& url,
                         const std::set<std::string>& channels,
                         const std::string& path)
    : writer_(path), connection_(url) {
  for (const std::string& channel : channels) {
    connection_.Subscribe(
        channel,
        [this, channel](std::span<const std::uint8_t> data, Time received) {
          try {
            writer_.Write(received, channel, data);
          } catch (const InputError& error) {  // Not through LCM.
            fault_ = error.what();
          }
        });
  }
  thread_ = std::thread([this] { Run(); });
}

LogRecorder::~LogRecorder() {
  is_over_ = true;
  if (thread_.joinable()) thread_.join();
}

void LogRecorder::Run() {
  while (true) {
    pollfd wait{connection_.fd(), POLLIN, 0};
    if (::poll(&wait, 1, 20) > 0) {
      connection_.Handle();
    } else if (is_over_) {
      return;
    }
  }
}

void LogRecorder::Stop() {
  is_over_ = true;
  thread_.join();
  if (!fault_.empty()) throw InputError(fault_);
  writer_.Close();
}

}  // namespace waymark
