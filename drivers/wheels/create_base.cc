#include "drivers/wheels/create_base.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void CreateBaseOptions::Check() const {
  session.Check();
  if (device.empty()) throw std::invalid_argument("device is missing");
  (void)SerialPort(device, baud);
  if (!(reopen_s > 0.0) || !std::isfinite(reopen_s)) {
    throw std::invalid_argument("reopen_s must be positive");
  }
  constexpr double kMaxSeconds = 3600.0;
  if (!(watchdog_s >= 0.1) || !(watchdog_s <= kMaxSeconds)) {
    throw std::invalid_argument("watchdog_s must be in [0.1, 3600]");
  }
}

CreateBase::CreateBase(const CreateBaseOptions& options)
    : options_(options),
      port_(options.device, options.baud),
      session_(options.session) {
  options_.Check();
}

void CreateBase::Open(Time now) {
  watchdog_.reset();
  if (tried_ && now - *tried_ < DurationFromSeconds(options_.reopen_s)) return;
  tried_ = now;
  if (!port_.Open()) return;
  watchdog_ =
      std::make_unique<Watchdog>(port_.fd(), EncodeStop(), options_.watchdog_s);
  session_.Open(now);
}

void CreateBase::Exchange(Time now) {
  // What the robot has said comes first: it may have stopped itself.
  const std::optional<Bytes> bytes = port_.Read();
  if (!bytes) return;
  session_.Receive(now, *bytes);
  const Bytes answer = session_.Send(now);
  if (!answer.empty()) port_.Write(answer);
}

void CreateBase::Command(Time now, double forward, double turn_rate) {
  session_.Command(now, forward, turn_rate);
  Exchange(now);
}

std::optional<CreateReading> CreateBase::Poll(Time now) {
  if (!port_.is_open()) Open(now);
  if (watchdog_) watchdog_->Beat();
  Exchange(now);
  return session_.TakeReading();
}

void CreateBase::Stop() {
  if (port_.is_open()) port_.Write(EncodeStreamPause());
  watchdog_.reset();
  port_.Close();
}

std::string CreateBase::Fault() const {
  if (!port_.is_open()) {
    return port_.error().empty() ? options_.device + ": not opened yet"
                                 : port_.error();
  }
  const std::string fault = session_.Fault();
  return fault.empty() ? fault : options_.device + ": " + fault;
}

}  // namespace waymark
