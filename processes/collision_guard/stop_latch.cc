#include "processes/collision_guard/stop_latch.h"

#include "estimation/base/input_error.h"
#include "processes/support/configuration.h"
#include "processes/support/state_file.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string_view>

namespace waymark {
namespace {

// What is not there is a stop.
struct Contents {
  bool is_stopped = true;
  std::int64_t utime = 0;
  std::string reason;

  void Describe(Describer& d) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    d.Flag("is_stopped", &is_stopped, "Nothing may move");
    d.Integer("utime", &utime, 0, kMost, "Of the message");
    d.Text("reason", &reason, "Who stopped or let go, and why");
  }
};

// Texts come from anywhere and go into a file, a status line and a terminal.
std::string Printable(std::string_view text) {
  constexpr std::size_t kMost = 200;
  std::string result;
  for (const char c : text.substr(0, kMost)) {
    result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result;
}

std::string ReasonOf(const stop_t& stop) {
  return Printable(stop.source) +
         (stop.reason.empty() ? "" : ": " + Printable(stop.reason));
}

}  // namespace

StopLatch::StopLatch(const std::string& path) : path_(path) {
  if (path_.empty()) return;
  CheckStateFolder(path_);
  Load();
}

void StopLatch::Load() {
  is_stopped_ = true;
  std::error_code error;
  const bool is_there = std::filesystem::exists(path_, error);
  if (std::filesystem::exists(UnfinishedStateFile(path_), error)) {
    reason_ = "stopped: the writing of " + path_ + " was cut short";
    return;
  }
  if (!error && !is_there) {
    is_stopped_ = false;
    return;
  }
  Contents contents;
  try {
    LoadConfigurationFile(path_, [&](Describer& d) { contents.Describe(d); });
  } catch (const InputError& broken) {
    reason_ = std::string("stopped: ") + broken.what();
    return;
  }
  is_stopped_ = contents.is_stopped;
  if (is_stopped_) {
    reason_ = "stopped by " + contents.reason + " (before a restart)";
  }
}

void StopLatch::Set(const stop_t& stop) {
  is_stopped_ = stop.is_stopped != 0;
  reason_ = is_stopped_ ? "stopped by " + ReasonOf(stop) : "";
  if (path_.empty()) return;
  Contents contents{
      is_stopped_, std::max<std::int64_t>(stop.utime, 0), ReasonOf(stop)};
  try {
    SaveStateFile(
        path_,
        "# Kept by collision_guard: STOP.\n" +
            PrintConfiguration([&](Describer& d) { contents.Describe(d); }));
    fault_.clear();
  } catch (const InputError& error) {
    // What was asked for holds all the same, while this process lives.
    fault_ = error.what();
  }
}

}  // namespace waymark
