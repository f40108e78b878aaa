#include "processes/wheels/wheels_process.h"

#include "processes/convert/motion_convert.h"
#include "processes/support/channels.h"

#include <waymark/base_status_t.hpp>
#include <waymark/encoders_t.hpp>

#include <spdlog/spdlog.h>

#include <optional>
#include <string>
#include <utility>

namespace waymark {
namespace {

constexpr Duration kBasePeriod{100'000};

}  // namespace

WheelsProcess::WheelsProcess(const Config& config, Bus* bus)
    : bus_(bus), base_(config.create) {
  bus->Advertise<encoders_t>(kEncoders);
  bus->Advertise<base_status_t>(kBase);
  bus->Subscribe<velocity_t>(
      kMotionCommand, Keep::Latest(), [this](const velocity_t& m, Time) {
        OnCommand(m);
      });
  bus->Every(DurationFromSeconds(config.period_s),
             [this](Time now) { OnTimer(now); });
}

void WheelsProcess::OnCommand(const velocity_t& message) {
  std::string reason;
  if (!CheckVelocity(message, &reason)) {
    bus_->ReportBad(kMotionCommand, Bad::kContent, reason);
    return;
  }
  base_.Command(bus_->now(), message.forward, message.turn_rate);
}

void WheelsProcess::OnTimer(Time now) {
  const std::optional<CreateReading> reading = base_.Poll(now);
  bus_->SetFault(base_.Fault());
  if (reading) Publish(now, *reading);
  WarnOfSkippedBytes();
}

void WheelsProcess::Publish(Time now, const CreateReading& reading) {
  const CreateSensors& sensors = reading.sensors;
  encoders_t encoders;
  encoders.utime = Microseconds(now);
  encoders.seq = encoders_seq_++;
  encoders.left_ticks = sensors.left_ticks;
  encoders.right_ticks = sensors.right_ticks;
  encoders.counter_bits = 16;
  bus_->Publish(kEncoders, encoders);

  was_bumped_left_ |= sensors.is_bumper_left;
  was_bumped_right_ |= sensors.is_bumper_right;
  if (base_seq_ > 0 && now - base_published_ < kBasePeriod) return;
  base_published_ = now;
  const DifferentialBase& base = base_.session().base();
  base_status_t status;
  status.utime = Microseconds(now);
  status.seq = base_seq_++;
  status.is_bumper_left = std::exchange(was_bumped_left_, false);
  status.is_bumper_right = std::exchange(was_bumped_right_, false);
  status.is_command_current = base.is_command_current();
  status.num_contacts = static_cast<std::int32_t>(base.num_contacts());
  status.num_timeouts = static_cast<std::int32_t>(base.num_timeouts());
  status.has_battery = reading.battery.has_value();
  status.battery = reading.battery.value_or(0.0);
  bus_->Publish(kBase, status);
}

void WheelsProcess::WarnOfSkippedBytes() {
  const std::int64_t num = base_.session().parser().num_skipped();
  if (num < next_warning_) return;
  while (next_warning_ <= num) next_warning_ *= 10;
  spdlog::warn("{} bytes from the robot made no sense so far", num);
}

}  // namespace waymark
