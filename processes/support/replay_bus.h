// Processes on a recorded log, as fast as the machine goes; the same log in
// gives the same bytes out.
#pragma once

#include "estimation/base/time.h"
#include "processes/support/bus.h"
#include "processes/support/log_file.h"
#include "processes/support/process_class.h"

#include <waymark/status_t.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Takes the events of a log one by one. Each is written to the output and
// handled by the processes in the order in which they were added; what they
// publish is written at the event's time and handled by all of them in order
// before the next event is taken. So the output is the log with what these
// processes recorded left out and what they publish now put in; everything
// else, subscribed or not, is copied with its time and bytes.
//
// Timers follow event time: those due up to an event's time are called at their
// own times before it, except over a gap of the log.
//
// STATUS and CONFIG follow event time; what depends on the machine is absent.
class ReplayBus {
 public:
  using Sink = std::function<void(
      Time time, std::string_view channel, std::span<const std::uint8_t> data)>;

  // `write` gets the output in order; may be empty.
  explicit ReplayBus(Sink write);
  ~ReplayBus();
  ReplayBus(const ReplayBus&) = delete;
  ReplayBus& operator=(const ReplayBus&) = delete;

  // The bus of one more process, owned by this object; before the first event.
  // `yaml` is its resolved configuration, for CONFIG.
  Bus* AddProcess(std::string name, std::string yaml);

  // What a handler throws passes through.
  void Handle(const LogEvent& event);
  // Handles what processes published in Finish(), then writes the last STATUS
  // of each. Last call.
  void Finish();

  [[nodiscard]] status_t Status(std::string_view process) const;
  // Events of the log that were left out, since the processes make them anew.
  [[nodiscard]] std::int64_t num_left_out() const;

 private:
  class Process;
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// One process of an offline run.
struct ReplayProcess {
  ProcessClass process_class;
  std::string config_path;  // Empty: defaults.
  std::vector<std::string> settings;
};

struct ReplayOptions {
  std::string log_in;
  std::string log_out;  // Empty: nothing is written.
  IfExists if_exists = IfExists::kFail;
  // Asked before each event; true ends the run as the end of the log would.
  std::function<bool()> stop;
  // Told before each event how many bytes of the log were read; may be empty.
  std::function<void(std::int64_t)> progress;
};

struct ReplayReport {
  LogReadReport read;
  std::int64_t num_left_out = 0;
  std::int64_t num_written = 0;
  bool was_stopped = false;
  std::vector<status_t> statuses;  // The last of each process.
};

// Runs processes, named once each, on a log. Throws InputError for a
// configuration or log that cannot be used, or an output that exists or is the
// input; std::runtime_error naming event and channel for what a handler throws
// (what was written until then is flushed).
[[nodiscard]] ReplayReport RunReplay(
    const std::vector<ReplayProcess>& processes, const ReplayOptions& options);

}  // namespace waymark
