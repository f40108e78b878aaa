// Question and answer over LCM.
#pragma once

#include "processes/support/decode.h"

#include <lcm/lcm-cpp.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// Sends something until it is answered, and listens.
class Talk {
 public:
  using Steady = std::chrono::steady_clock;
  // What may have been lost, or come before its receiver, is sent again.
  static constexpr std::chrono::milliseconds kRepeat{500};

  // Throws InputError where the network cannot be used.
  Talk(const std::string& url, double timeout_s);

  template <typename M>
  void Listen(std::string_view channel, std::function<void(const M&)> handler) {
    handlers_.push_back([handler](std::span<const std::uint8_t> data) {
      if (const auto message = DecodeMessage<M>(data)) handler(*message);
    });
    lcm_->subscribe(std::string(channel), &Talk::OnMessage, this);
    channels_.emplace_back(channel);
  }

  template <typename M>
  void Send(std::string_view channel, const M& message) {
    lcm_->publish(std::string(channel), &message);
  }

  // Handles what comes for a moment.
  void Look();

  // Sends again and again until `is_answered`; false once the time has passed.
  template <typename M>
  bool SendUntil(std::string_view channel,
                 const M& message,
                 const std::function<bool()>& is_answered) {
    const auto end =
        Steady::now() + std::chrono::duration_cast<Steady::duration>(
                            std::chrono::duration<double>(timeout_s_));
    Steady::time_point next = Steady::now();
    while (!is_answered()) {
      if (Steady::now() >= end) return false;
      if (Steady::now() >= next) {
        Send(channel, message);
        next = Steady::now() + kRepeat;
      }
      Look();
    }
    return true;
  }

 private:
  void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  double timeout_s_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::vector<std::string> channels_;
  std::vector<std::function<void(std::span<const std::uint8_t>)>> handlers_;
};

}  // namespace waymark
