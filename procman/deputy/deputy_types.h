// What a deputy is told and what it does, as values.
#pragma once

#include "estimation/base/time.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace waymark {

// As a sheriff describes a command.
struct CommandSpec {
  std::string id;
  std::string exec;  // See exec_words.h.
  std::string group;
  bool auto_respawn = false;
  int stop_signal = 2;
  double stop_time_allowed_s = 7.0;

  friend bool operator==(const CommandSpec&, const CommandSpec&) = default;
};

struct CommandOrder {
  CommandSpec spec;
  std::int32_t desired_runid = 0;  // 0: no opinion.
  bool force_quit = false;         // It shall not run.
};

// All that a sheriff wants of one deputy: what is not named shall go.
struct DeputyOrders {
  Time utime;  // By the sheriff's clock.
  std::string deputy_id;
  std::string sheriff_id;
  std::vector<CommandOrder> commands;
};

// ---- what is to be done, in order -------------------------------------------

// Answered by DeputyState::OnStarted or OnStartFailed before the next action is
// done.
struct StartChild {
  std::string id;
};
// Of the process and all its descendants.
struct SignalFamily {
  std::string id;
  std::int32_t pid = 0;
  int signal = 0;
};
// Descendants that a process has left behind get SIGKILL.
struct EndFamily {
  std::string id;
  std::int32_t pid = 0;  // Of the process, which has ended.
};
// A line for who looks at the command's output; id "": at the deputy's.
struct SayText {
  std::string id;
  std::string text;
};
// The whole state is published at once.
struct PublishInfo {};

using DeputyAction =
    std::variant<StartChild, SignalFamily, EndFamily, SayText, PublishInfo>;

}  // namespace waymark
