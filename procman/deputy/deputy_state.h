// The state of a deputy: which commands run, which end, which come again.
#pragma once

#include "estimation/base/time.h"
#include "procman/deputy/deputy_types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

enum class DeputyDialect : std::uint8_t {
  kProcman,     // Run id 0 is no opinion.
  kBotProcman,  // Run id 0 is a run id like any other: it ends what runs.
};

struct DeputyStateOptions {
  std::string deputy_id;
  DeputyDialect dialect = DeputyDialect::kProcman;
  // Why a command must not be run; empty: it may. Absent: all may.
  std::function<std::string(const CommandSpec&)> refuse;
};

struct CommandState {
  CommandSpec spec;
  std::int32_t pid = 0;  // 0: does not run.
  std::int32_t actual_runid = 0;
  std::int32_t exit_code = 0;  // As wait() says it; 0 while it runs.
  std::int32_t desired_runid = 0;
  bool force_quit = true;    // Until an order says otherwise.
  bool is_removing = false;  // Goes once it has ended.
  bool is_starting = false;  // StartChild is not answered yet.
  std::string refusal;       // Why it was not run last; empty: it was.
  std::int64_t num_starts = 0;
  std::int64_t num_respawns = 0;
  Duration started{};  // By the steady clock.
  Duration respawn_delay{};
  std::optional<Duration> respawn_at;
  std::optional<Duration> kill_at;  // While it is being stopped.

  [[nodiscard]] bool is_running() const { return pid != 0 || is_starting; }
};

// Of procman's deputies in both generations, without their processes and their
// clocks: these are told to it, and what is to be done is returned. It differs
// from stock deputies in that
//  - SIGKILL follows by the deputy's own timer, not with the next orders;
//  - what shall be restarted starts as soon as it has ended;
//  - a run id of 0 never starts anything (kProcman);
//  - what must not be run is refused, and shown as ended with status 126.
//
// `now` is a steady clock's, of any beginning.
class DeputyState {
 public:
  using Actions = std::vector<DeputyAction>;

  // Orders older than this are not followed.
  static constexpr Duration kStale = std::chrono::seconds(60);
  // Orders for more are passed over: anybody can send them.
  static constexpr std::size_t kMostCommands = 4096;
  // Raw status of a program that cannot be started, and of one that may not.
  static constexpr std::int32_t kCannotStart = 255 << 8;
  static constexpr std::int32_t kRefused = 126 << 8;

  explicit DeputyState(DeputyStateOptions options);

  // `wall` is this host's clock, which orders are compared with.
  [[nodiscard]] Actions OnOrders(const DeputyOrders& orders,
                                 Time wall,
                                 Duration now);
  [[nodiscard]] Actions OnStarted(const std::string& id,
                                  std::int32_t pid,
                                  Duration now);
  [[nodiscard]] Actions OnStartFailed(const std::string& id,
                                      const std::string& why,
                                      Duration now);
  // A child was reaped. Those of nobody are passed over.
  [[nodiscard]] Actions OnExit(std::int32_t pid,
                               std::int32_t status,
                               Duration now);
  // At next_timer(), or at any time.
  [[nodiscard]] Actions OnTimer(Duration now);
  // Stops all; nothing is started any longer.
  [[nodiscard]] Actions OnQuit(Duration now);

  // When something is due; nullopt: nothing is.
  [[nodiscard]] std::optional<Duration> next_timer() const;
  // It was told to quit, and nothing runs any longer.
  [[nodiscard]] bool is_done() const;

  [[nodiscard]] const std::map<std::string, CommandState>& commands() const {
    return commands_;
  }
  // Of messages with orders for this deputy.
  [[nodiscard]] std::int64_t num_orders() const { return num_orders_; }
  [[nodiscard]] std::int64_t num_stale() const { return num_stale_; }
  // Of commands in them.
  [[nodiscard]] std::int64_t num_refused() const { return num_refused_; }

 private:
  void Follow(const CommandOrder& order, Duration now, Actions* actions);
  // True where the command must not be run; then it is stopped if asked, and
  // no more.
  bool Refuse(const CommandOrder& order,
              CommandState* command,
              Duration now,
              Actions* actions);
  void Start(CommandState* command, Actions* actions);
  void Stop(CommandState* command, Duration now, Actions* actions);
  void Ended(const std::string& id,
             std::int32_t status,
             Duration now,
             Actions* actions);

  DeputyStateOptions options_;
  std::map<std::string, CommandState> commands_;
  std::map<std::int32_t, std::string> ids_;  // By pid.
  bool is_quitting_ = false;
  bool has_changed_ = false;
  std::int64_t num_orders_ = 0;
  std::int64_t num_stale_ = 0;
  std::int64_t num_refused_ = 0;
};

}  // namespace waymark
