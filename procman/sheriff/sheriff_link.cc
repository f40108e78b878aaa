#include "procman/sheriff/sheriff_link.h"

#include "estimation/base/input_error.h"
#include "processes/support/channels.h"
#include "processes/support/decode.h"
#include "processes/support/lcm_url.h"
#include "procman/deputy/deputy_messages.h"

#include <waymark/status_t.hpp>

#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr char kInfo[] = "PM_INFO";
constexpr char kOrders[] = "PM_ORDERS";
constexpr char kOutput[] = "PM_OUTPUT";
constexpr char kDiscover[] = "PM_DISCOVER";

constexpr Duration kOrdersPeriod = seconds(1);
// Another sheriff orders once a second.
constexpr double kAdoptS = 1.3;
// Deputies answer at once when they are asked: enough where no orders are
// given.
constexpr double kAnswerS = 0.4;

Time Wall() {
  return Time(std::chrono::duration_cast<Duration>(
      std::chrono::system_clock::now().time_since_epoch()));
}

// As stock sheriffs call themselves.
std::string SheriffId() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return std::string(host.data()) + ":" + std::to_string(getpid()) + ":" +
         std::to_string(Microseconds(Wall()));
}

template <typename M>
std::optional<M> MessageOf(const lcm::ReceiveBuffer* buffer) {
  return DecodeMessage<M>(
      {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
}

// What is no time becomes one.
double StopTime(float asked_s) {
  constexpr float kLongest = 86400.0f;
  return asked_s > 0.0f ? static_cast<double>(std::min(asked_s, kLongest))
                        : 0.0;
}

DeputyReport ToReport(const procman_lcm::deputy_info_t& message) {
  DeputyReport report;
  report.utime = TimeFromMicroseconds(message.utime);
  report.deputy_id = message.deputy_id;
  report.cpu_load = static_cast<double>(message.cpu_load);
  report.memory_total_bytes = message.phys_mem_total_bytes;
  report.memory_free_bytes = message.phys_mem_free_bytes;
  for (const procman_lcm::cmd_status_t& status : message.cmds) {
    CommandReport command;
    command.spec = {status.cmd.command_id,
                    status.cmd.exec_str,
                    status.cmd.group,
                    status.cmd.auto_respawn != 0,
                    status.cmd.stop_signal,
                    StopTime(status.cmd.stop_time_allowed)};
    command.pid = status.pid;
    command.actual_runid = status.actual_runid;
    command.exit_code = status.exit_code;
    command.cpu_share = static_cast<double>(status.cpu_usage);
    command.resident_bytes = status.mem_rss_bytes;
    report.commands.push_back(std::move(command));
  }
  return report;
}

}  // namespace

Duration SheriffLink::Now() {
  return std::chrono::duration_cast<Duration>(
      std::chrono::steady_clock::now().time_since_epoch());
}

SheriffLink::SheriffLink(const SheriffLinkOptions& options)
    : state(SheriffId(), options.is_observer) {
  const std::string url = WithGrantedBuffer(LcmUrl(options.lcm_url));
  CheckLcmReachable(url);
  lcm_ = std::make_unique<lcm::LCM>(url);
  if (!lcm_->good()) throw InputError("LCM cannot be created with " + url);
  lcm_->subscribe(kInfo, &SheriffLink::OnInfo, this);
  lcm_->subscribe(kOrders, &SheriffLink::OnOrders, this);
  lcm_->subscribe(kOutput, &SheriffLink::OnOutput, this);
  lcm_->subscribe(std::string(kStatus), &SheriffLink::OnStatus, this);
}

void SheriffLink::OnInfo(const lcm::ReceiveBuffer* buffer, const std::string&) {
  const auto message = MessageOf<procman_lcm::deputy_info_t>(buffer);
  if (!message) return;
  if (state.OnReport(ToReport(*message), Wall(), Now()) && on_change) {
    on_change();
  }
}

void SheriffLink::OnOrders(const lcm::ReceiveBuffer* buffer,
                           const std::string&) {
  const auto message = MessageOf<procman_lcm::orders_t>(buffer);
  if (message && state.OnOrders(ToOrders(*message)) && on_conflict) {
    on_conflict(message->sheriff_id);
  }
}

void SheriffLink::OnOutput(const lcm::ReceiveBuffer* buffer,
                           const std::string&) {
  const auto message = MessageOf<procman_lcm::output_t>(buffer);
  if (!message || !on_output) return;
  for (std::size_t i = 0; i < message->text.size(); ++i) {
    on_output(message->command_ids[i], message->text[i]);
  }
}

void SheriffLink::OnStatus(const lcm::ReceiveBuffer* buffer,
                           const std::string&) {
  const auto message = MessageOf<status_t>(buffer);
  if (message) heard_status_[message->process] = Now();
}

void SheriffLink::Adopt() {
  procman_lcm::discovery_t discovery;
  discovery.utime = Microseconds(Wall());
  discovery.transmitter_id = state.id();
  discovery.nonce = 0;
  lcm_->publish(kDiscover, &discovery);
  Look(state.is_observer() ? kAnswerS : kAdoptS);
  has_adopted_ = true;
}

void SheriffLink::Send() {
  for (const DeputyOrders& orders : state.Orders(Wall())) {
    const procman_lcm::orders_t message = FromOrders(orders);
    lcm_->publish(kOrders, &message);
  }
  next_orders_ = Now() + kOrdersPeriod;
}

void SheriffLink::Look(double duration_s) {
  const Duration end = Now() + DurationFromSeconds(duration_s);
  while (true) {
    if (has_adopted_ && Now() >= next_orders_) Send();
    Duration until = end;
    if (has_adopted_) until = std::min(until, next_orders_);
    const auto wait =
        std::chrono::ceil<milliseconds>(std::max(Duration(0), until - Now()));
    if (lcm_->handleTimeout(static_cast<int>(wait.count())) < 0) {
      throw std::runtime_error("LCM stopped working");
    }
    if (Now() >= end) return;
  }
}

}  // namespace waymark
