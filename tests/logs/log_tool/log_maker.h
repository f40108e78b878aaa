// Small logs for the tests of waymark-log.
#pragma once

#include "processes/support/log_file.h"
#include "tests/support/temporary_directory.h"

#include <waymark/encoders_t.hpp>
#include <waymark/pose_t.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace waymark {

inline constexpr std::int64_t kLogStart = 1'700'000'000'000'000;

inline encoders_t MakeEncoders(std::int64_t utime, std::int32_t seq) {
  encoders_t message{};
  message.utime = utime;
  message.seq = seq;
  message.left_ticks = 10 * seq;
  message.right_ticks = -10 * seq;
  return message;
}

inline pose_t MakePose(std::int64_t utime, std::int32_t seq) {
  pose_t message{};
  message.utime = utime;
  message.seq = seq;
  message.is_known = 1;
  message.pose_W[0] = 0.5 * seq;
  message.pose_W[2] = 0.1 * seq;
  return message;
}

inline std::vector<LogEvent> ReadAll(const std::string& path) {
  LogReader reader(path);
  std::vector<LogEvent> events;
  while (auto event = reader.Next()) events.push_back(std::move(*event));
  return events;
}

class LogToolTest : public testing::Test {
 protected:
  // ENCODERS at 10 Hz and POSE at 5 Hz for two seconds: 20 and 10 events.
  void WriteDrive() {
    LogWriter writer(log_);
    for (int i = 0; i < 20; ++i) {
      const std::int64_t utime = kLogStart + 100'000 * i;
      writer.Write("ENCODERS", MakeEncoders(utime, i));
      if (i % 2 == 0) writer.Write("POSE", MakePose(utime, i / 2));
    }
    writer.Close();
  }

  template <typename Function>
  static std::string ErrorOf(const Function& function) {
    try {
      function();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no InputError";
  }

  TemporaryDirectory directory_{TemporaryDirectory::FastParent()};
  std::string log_ = directory_ / "drive.log";
  std::string out_ = directory_ / "out.log";
};

}  // namespace waymark
