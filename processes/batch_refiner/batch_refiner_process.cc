#include "processes/batch_refiner/batch_refiner_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/convert/odometry_inputs.h"
#include "processes/support/channels.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace waymark {

OdometryParameters ParametersFromResult(const BatchResult& result) {
  OdometryParameters values;
  values.time = result.newest;
  values.source = "batch";
  values.is_known = HasAnswer(result.status);
  values.reason = result.reason;
  values.parameters = result.parameters;
  values.covariance = result.covariance;
  values.observability = result.observability;
  values.num_measurements = result.num_measurements;
  if (!values.is_known) return values;
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
  SubscribeOdometryInputs(
      bus,
      {.on_reading = [this](const EncoderReading& raw,
                            int bits) { OnReading(raw, bits); },
       .on_fix = [this](const AbsoluteFix& fix,
                        std::string_view) { window_.Add(fix); },
       .on_motion = [this](const RelativeMotion& m) { window_.Add(m); },
       .on_initial_pose = {},
       .on_parameters =
           [this](const OdometryParameters& p) { OnParameters(p); }});
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

void BatchRefinerProcess::OnReading(const EncoderReading& raw,
                                    int counter_bits) {
  const auto is_far = [this](Time a, Time b) {
    return std::max(a, b) - std::min(a, b) >
           DurationFromSeconds(config_.window.window_s);
  };
  const auto newest = window_.newest();
  const std::optional<Reading> far = std::exchange(far_, std::nullopt);
  const bool is_alone = !far || is_far(raw.time, far->raw.time);
  if (far && is_alone) {
    bus_->ReportBad(kEncoders,
                    Bad::kContent,
                    "utime " + std::to_string(Microseconds(far->raw.time)) +
                        " alone, far from all others");
  }
  if (newest && is_far(raw.time, *newest)) {
    if (is_alone) {
      far_ = Reading{raw, counter_bits};
      return;
    }
    StartAnew("time jumped by more than the window: started anew");
    counter_ = EncoderCounter();
    if (nominal_) SetNominal(*nominal_);
    Take(far->raw, far->counter_bits);
  }
  Take(raw, counter_bits);
}

void BatchRefinerProcess::Take(const EncoderReading& raw, int counter_bits) {
  const EncoderStep step = counter_.Add(raw, counter_bits);
  if (!step.is_accepted) {
    bus_->ReportBad(kEncoders, Bad::kContent, step.reason);
    return;
  }
  if (step.unknown_s > 0.0) {
    StartAnew("the count was lost: started anew");
  }
  total_.time = raw.time;
  total_.seq = raw.seq;
  total_.right += std::llround(step.ticks.right);
  total_.left += std::llround(step.ticks.left);
  window_.Add(total_);
  if (!solved_) solved_ = raw.time;
  if (raw.time - *solved_ >= DurationFromSeconds(config_.period_s)) Solve();
}

void BatchRefinerProcess::OnParameters(const OdometryParameters& parameters) {
  // Configured ones win; online and batch estimates are no prior.
  if (parameters.source != "nominal" || !config_.nominal.empty()) return;
  SetNominal(parameters.parameters);
}

void BatchRefinerProcess::Solve() {
  solved_ = window_.newest();
  OdometryParameters values;
  if (nominal_) {
    const BatchLog& log = window_.Log();
    values = ParametersFromResult(
        RefineBatch({&log, 1}, config_.solver.Options(*nominal_)));
  } else {
    values.source = "batch";
    values.is_known = false;
    values.reason =
        "no nominal wheel parameters: none configured, none received";
  }
  // An answer is as old as what it rests on; 'none' rests on all there is.
  if (!values.is_known) values.time = *solved_;
  bus_->Publish(kOdometryParameters, ToMessage(values, seq_++));
}

void BatchRefinerProcess::Finish() {
  const auto newest = window_.newest();
  if (newest && solved_ && *newest > *solved_) Solve();
}

}  // namespace waymark
