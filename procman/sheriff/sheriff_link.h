// A sheriff's state, connected to deputies over LCM.
#pragma once

#include "procman/sheriff/sheriff_state.h"

#include <lcm/lcm-cpp.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace waymark {

struct SheriffLinkOptions {
  std::string lcm_url;
  bool is_observer = false;
};

// Reports, orders and output on PM_INFO, PM_ORDERS and PM_OUTPUT. Orders go out
// once a second, and at once when Send() is called; none do before Adopt().
class SheriffLink {
 public:
  // Throws InputError where the network cannot be used.
  explicit SheriffLink(const SheriffLinkOptions& options);
  SheriffLink(const SheriffLink&) = delete;
  SheriffLink& operator=(const SheriffLink&) = delete;

  // Asks who is there and listens for as long as a deputy needs to answer. From
  // then on orders are sent.
  void Adopt();
  // Handles what comes for so long, s, and sends what is due. Throws
  // std::runtime_error where LCM stops working.
  void Look(double seconds);
  // Orders to all deputies, now.
  void Send();

  // Of command and text. Text of "" is the deputy's own.
  std::function<void(const std::string& id, const std::string& text)> on_output;
  // Another sheriff's orders were seen for the first time.
  std::function<void(const std::string& sheriff_id)> on_conflict;
  std::function<void()> on_change;

  SheriffState state;
  // Since when a process was last heard on STATUS, by the steady clock.
  [[nodiscard]] const std::map<std::string, Duration>& heard_status() const {
    return heard_status_;
  }
  [[nodiscard]] static Duration Now();

 private:
  void OnInfo(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void OnOrders(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void OnOutput(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void OnStatus(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::unique_ptr<lcm::LCM> lcm_;
  std::map<std::string, Duration> heard_status_;
  bool has_adopted_ = false;
  Duration next_orders_{};
};

}  // namespace waymark
