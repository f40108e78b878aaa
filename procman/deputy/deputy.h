// The deputy of a host: runs commands as a sheriff orders over LCM.
#pragma once

#include "estimation/base/time.h"
#include "procman/deployment/deployment_types.h"
#include "procman/deputy/child.h"
#include "procman/deputy/clean_text.h"
#include "procman/deputy/deputy_messages.h"
#include "procman/deputy/deputy_state.h"
#include "procman/deputy/output_gate.h"
#include "procman/deputy/proc_table.h"

#include <lcm/lcm-cpp.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace waymark {

struct DeputyOptions {
  std::string id;
  std::string lcm_url;
  // What may be run, by id and exec string; nullopt: whatever is ordered.
  std::optional<Deployment> deployment;
  OutputGateOptions output;
};

// Speaks procman_lcm (PM_*), as stock deputies do.
class Deputy {
 public:
  // Throws InputError where the network cannot be used.
  explicit Deputy(const DeputyOptions& options);
  ~Deputy();
  Deputy(const Deputy&) = delete;
  Deputy& operator=(const Deputy&) = delete;

  // Until SIGINT, SIGTERM, SIGHUP or SIGQUIT, and all children have ended:
  // returns 0. Returns 2 where another deputy of this id is there already.
  // Throws std::runtime_error where LCM stops working.
  [[nodiscard]] int Run();

 private:
  struct Terminal {
    int fd = -1;
    CleanText clean;
  };
  struct Measured {
    Duration at{};
    std::uint64_t ticks = 0;  // Of the command with its descendants.
  };

  void OnInfo(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void OnDiscover(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void OnOrders(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  void Do(const DeputyState::Actions& actions);
  void Start(const std::string& id);
  void Read(const std::string& id);
  void CloseTerminal(const std::string& id);
  void Say(const std::string& id, const std::string& text);
  void Reap();
  void Measure(Duration now);
  void PublishDiscover();
  void PublishInfo();
  void PublishOutput();
  // Readable files are looked at, until something is due.
  void Wait(Duration until);
  [[nodiscard]] std::string WhyRefused(const CommandSpec& spec) const;

  DeputyOptions options_;
  std::unique_ptr<lcm::LCM> lcm_;
  DeputyState state_;
  OutputGate gate_;
  std::map<std::string, Terminal> terminals_;  // By command.
  std::map<std::string, CommandUse> uses_;
  std::map<std::string, Measured> measured_;
  std::optional<MachineTicks> machine_;
  MachineMemory memory_;
  double cpu_load_ = 0.0;
  int signals_ = -1;      // Of those that end it, and SIGCHLD.
  bool is_open_ = false;  // Nobody else has this id: orders are taken.
  bool has_conflict_ = false;
  bool is_asked_to_end_ = false;
  bool is_info_due_ = false;
};

}  // namespace waymark
