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
}

CreateBase::CreateBase(const CreateBaseOptions& options)
    : options_(options),
      port_(options.device, options.baud),
      session_(options.session) {
  options_.Check();
}

void CreateBase::Open(Time now) {
  last_words_.reset();
  if (tried_ && now - *tried_ < DurationFromSeconds(options_.reopen_s)) return;
  tried_ = now;
  if (!port_.Open()) return;
  last_words_ = std::make_unique<LastWords>(port_.fd(), EncodeStop());
  session_.Open(now);
}

void CreateBase::Send(Time now) {
  const Bytes bytes = session_.Send(now);
  if (!bytes.empty()) port_.Write(bytes);
}

void CreateBase::Command(Time now, double forward, double turn_rate) {
  session_.Command(now, forward, turn_rate);
  if (port_.is_open()) Send(now);
}

std::optional<CreateReading> CreateBase::Poll(Time now) {
  if (!port_.is_open()) Open(now);
  const std::optional<Bytes> bytes = port_.Read();
  if (!bytes) return std::nullopt;
  session_.Receive(now, *bytes);
  Send(now);
  return session_.TakeReading();
}

void CreateBase::Stop() {
  if (port_.is_open()) port_.Write(EncodeStreamPause());
  last_words_.reset();
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
