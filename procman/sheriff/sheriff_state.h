// What a sheriff knows of deputies and their commands, and what it wants of
// them.
#pragma once

#include "estimation/base/time.h"
#include "procman/deployment/deployment_types.h"
#include "procman/deputy/deputy_types.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// Of one command, as a deputy reports it.
struct CommandReport {
  CommandSpec spec;
  std::int32_t pid = 0;
  std::int32_t actual_runid = 0;
  std::int32_t exit_code = 0;  // As wait() says it.
  double cpu_share = 0.0;      // Of the whole machine.
  std::int64_t resident_bytes = 0;
};

// The whole state of one deputy.
struct DeputyReport {
  Time utime;  // By the deputy's clock.
  std::string deputy_id;
  double cpu_load = 0.0;
  std::int64_t memory_total_bytes = 0;
  std::int64_t memory_free_bytes = 0;
  std::vector<CommandReport> commands;
};

// As stock sheriffs show it.
enum class CommandStatus : std::uint8_t {
  kUnknown,  // Its deputy was not heard of.
  kStarting,
  kRestarting,
  kRunning,
  kStopping,
  kRemoving,
  kStopped,  // As it was asked to, or with 0.
  kFailed,   // Ended with something else.
};
[[nodiscard]] const char* NameOf(CommandStatus status);

struct SheriffCommand {
  DeploymentCommand command;  // Exec and deputy; from a file, or as reported.
  bool is_loaded = false;     // From a file.
  std::int32_t desired_runid = 0;
  bool force_quit = true;
  bool is_removing = false;
  std::optional<CommandReport> report;  // The last one.

  [[nodiscard]] CommandStatus status() const;
  [[nodiscard]] bool is_running() const { return report && report->pid != 0; }
};

struct SheriffDeputy {
  DeputyReport report;  // The last one, without its commands.
  Duration heard{};     // By the steady clock.
  // The deputy's clock less this host's, and the way of a message: the least of
  // the last ones is nearest to the truth.
  Duration clock_offset{};
};

// Of procman's sheriffs, without messages and clocks. Deputies are adopted
// before they are ordered anything: what they run goes on. Where another
// sheriff gives orders, this one gives none any longer.
class SheriffState {
 public:
  // Reports older than this say nothing of now.
  static constexpr Duration kStale = std::chrono::seconds(30);

  explicit SheriffState(std::string sheriff_id, bool is_observer = false);

  // Adds its commands, which are not started. What is there already takes the
  // file's exec, group, signals and times. Throws std::invalid_argument where a
  // command of another deputy has its id.
  void Load(const Deployment& deployment);

  // What it says; nullopt where it is too old. `wall` is this host's clock.
  // True where a command's status has changed.
  bool OnReport(const DeputyReport& report, Time wall, Duration now);
  // Orders on the network, own ones too. True where another's are the first.
  bool OnOrders(const DeputyOrders& orders);

  // Each throws std::invalid_argument where there is no such command, and
  // std::logic_error where this is an observer.
  void Start(const std::string& id);
  void Stop(const std::string& id);
  void Restart(const std::string& id);
  void Remove(const std::string& id);

  // For each deputy that was heard; none where this is an observer.
  [[nodiscard]] std::vector<DeputyOrders> Orders(Time wall) const;

  [[nodiscard]] const std::string& id() const { return sheriff_id_; }
  [[nodiscard]] bool is_observer() const { return is_observer_; }
  // Who gives orders instead; empty: nobody else does.
  [[nodiscard]] const std::string& other_sheriff() const { return other_; }
  [[nodiscard]] const std::map<std::string, SheriffCommand>& commands() const {
    return commands_;
  }
  [[nodiscard]] const std::map<std::string, SheriffDeputy>& deputies() const {
    return deputies_;
  }

 private:
  SheriffCommand* Find(const std::string& id);
  void Adopt(const std::string& deputy_id, const CommandReport& report);

  std::string sheriff_id_;
  bool is_observer_;
  std::string other_;
  std::map<std::string, SheriffCommand> commands_;
  std::map<std::string, SheriffDeputy> deputies_;
};

}  // namespace waymark
