#include "processes/batch_refiner/batch_refiner_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace waymark {

OdometryParameters ParametersFromResult(const BatchResult& result) {
  OdometryParameters values;
  values.time = result.newest;
  values.source = "batch";
  values.parameters = result.parameters;
  values.covariance = result.covariance;
  values.observability = result.observability;
  values.num_measurements = result.num_measurements;
  const BatchSensor* most = nullptr;
  for (const BatchSensor& sensor : result.sensors) {
    const bool is_estimated = std::find(sensor.is_estimated.begin(),
                                        sensor.is_estimated.end(),
                                        true) != sensor.is_estimated.end();
    if (is_estimated &&
        (most == nullptr || sensor.num_measurements > most->num_measurements)) {
      most = &sensor;
    }
  }
  if (most != nullptr) {
    values.sensor = SensorCalibration{
        most->source, most->X_RS, most->time_offset_s, most->covariance};
  }
  return values;
}

BatchRefinerProcess::BatchRefinerProcess(const Config& config, Bus* bus)
    : config_(config), bus_(bus), window_(config.window) {
  if (!config.nominal.empty()) {
    SetNominal({config.nominal[0], config.nominal[1], config.nominal[2]});
  }
  bus->Advertise<odometry_parameters_t>(kOdometryParameters, "batch");
  bus->Subscribe<encoders_t>(
      kEncoders, Keep::All(), [this](const encoders_t& m, Time) {
        OnEncoders(m);
      });
  bus->Subscribe<position_fix_t>(
      kPositionFix, Keep::All(), [this](const position_fix_t& m, Time) {
        OnFix(m);
      });
  bus->Subscribe<relative_motion_t>(
      kRelativeMotion, Keep::All(), [this](const relative_motion_t& m, Time) {
        OnMotion(m);
      });
  bus->Subscribe<odometry_parameters_t>(
      kOdometryParameters,
      Keep::All(),
      [this](const odometry_parameters_t& m, Time) { OnParameters(m); });
}

void BatchRefinerProcess::SetNominal(const WheelParameters& nominal) {
  nominal_ = nominal;
  counter_.set_max_tick_rate(config_.max_wheel_speed /
                             std::min(nominal.k_right, nominal.k_left));
}

void BatchRefinerProcess::StartAnew(std::string_view why) {
  bus_->ReportBad(kEncoders, Bad::kContent, why);
  window_.Clear();
  solved_.reset();
}

void BatchRefinerProcess::OnEncoders(const encoders_t& message) {
  std::string reason;
  const auto raw = EncoderReadingFromMessage(message, &reason);
  if (!raw) {
    bus_->ReportBad(kEncoders, Bad::kContent, reason);
    return;
  }
  const auto newest = window_.newest();
  const Duration window = DurationFromSeconds(config_.window.window_s);
  if (newest && raw->time < *newest - window) {
    StartAnew("time went back by more than the window: started anew");
    counter_ = EncoderCounter();
    if (nominal_) SetNominal(*nominal_);
  }
  const EncoderStep step = counter_.Add(*raw, message.counter_bits);
  if (!step.is_accepted) {
    bus_->ReportBad(kEncoders, Bad::kContent, step.reason);
    return;
  }
  if (step.unknown_s > 0.0) {
    StartAnew("the count was lost: started anew");
  }
  total_.time = raw->time;
  total_.seq = raw->seq;
  total_.right += std::llround(step.ticks.right);
  total_.left += std::llround(step.ticks.left);
  window_.Add(total_);
  if (!solved_) solved_ = raw->time;
  if (raw->time - *solved_ >= DurationFromSeconds(config_.period_s)) Solve();
}

void BatchRefinerProcess::OnFix(const position_fix_t& message) {
  std::string reason;
  if (const auto fix = AbsoluteFixFromMessage(message, &reason)) {
    window_.Add(*fix);
  } else {
    bus_->ReportBad(kPositionFix, Bad::kContent, reason);
  }
}

void BatchRefinerProcess::OnMotion(const relative_motion_t& message) {
  std::string reason;
  if (const auto motion = RelativeMotionFromMessage(message, &reason)) {
    window_.Add(*motion);
  } else {
    bus_->ReportBad(kRelativeMotion, Bad::kContent, reason);
  }
}

void BatchRefinerProcess::OnParameters(const odometry_parameters_t& message) {
  // Configured ones win; online and batch estimates are no prior.
  if (message.source != "nominal" || !config_.nominal.empty()) return;
  std::string reason;
  if (const auto values = OdometryParametersFromMessage(message, &reason)) {
    SetNominal(values->parameters);
  } else {
    bus_->ReportBad(kOdometryParameters, Bad::kContent, reason);
  }
}

void BatchRefinerProcess::Solve() {
  solved_ = window_.newest();
  if (!nominal_) return;
  const BatchLog& log = window_.Log();
  const BatchResult result =
      RefineBatch({&log, 1}, config_.solver.Options(*nominal_));
  if (!HasAnswer(result.status)) return;
  bus_->Publish(kOdometryParameters,
                ToMessage(ParametersFromResult(result), seq_++));
}

void BatchRefinerProcess::Finish() {
  const auto newest = window_.newest();
  if (newest && solved_ && *newest > *solved_) Solve();
}

}  // namespace waymark
