#include "processes/pose_filter/pose_filter_process.h"

#include "estimation/base/input_error.h"
#include "processes/convert/odometry_convert.h"
#include "processes/convert/odometry_inputs.h"
#include "processes/pose_filter/parameter_file.h"
#include "processes/support/channels.h"

#include <cstdio>
#include <utility>

namespace waymark {
namespace {

// A crash loses at most this much of what was learned.
constexpr double kSavePeriodS = 30.0;

DelayedFusionOptions OptionsOf(const PoseFilterConfig& config) {
  DelayedFusionOptions options = config.Options();
  if (!config.parameters_file.empty()) {
    options.filter.learned = LoadParameterFile(config.parameters_file);
  }
  return options;
}

}  // namespace

PoseFilterProcess::PoseFilterProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      fusion_(OptionsOf(config)),
      saver_(config.parameters_file, bus->is_offline()) {
  for (const auto channel : {kPose, kPoseSettled, kOdometry}) {
    bus->Advertise<pose_t>(channel);
  }
  bus->Advertise<bot_pose_t>(kPoseBot);
  bus->Advertise<odometry_parameters_t>(kOdometryParameters, "online");
  SubscribeOdometryInputs(
      bus,
      {.on_reading = [this](const EncoderReading& raw,
                            int bits) { OnReading(raw, bits); },
       .on_fix = [this](const AbsoluteFix& fix,
                        std::string_view channel) { OnFix(fix, channel); },
       .on_motion = [this](const RelativeMotion& m) { OnMotion(m); },
       .on_initial_pose =
           [this](const InitialPose& pose) {
             Report(kInitialPose, fusion_.AddInitialPose(pose), pose.time);
           },
       .on_parameters =
           [this](const OdometryParameters& p) { OnParameters(p); }});
}

void PoseFilterProcess::OnReading(const EncoderReading& raw, int counter_bits) {
  Report(kEncoders, fusion_.AddReading(raw, counter_bits), raw.time);
  if (fusion_.newest_time() == raw.time) PublishNewest();
  PublishSettled();
}

void PoseFilterProcess::OnFix(const AbsoluteFix& fix,
                              std::string_view channel) {
  Report(channel, fusion_.AddFix(fix), fix.time);
  const auto newest = fusion_.newest_time();
  const Duration window = DurationFromSeconds(config_.window_s);
  if (!newest) {
    PublishUnknown(fix.time, "no encoder readings yet");
  } else if (fix.time - *newest > window) {
    PublishUnknown(fix.time, "no encoder readings for longer than the window");
  }
}

void PoseFilterProcess::OnMotion(const RelativeMotion& motion) {
  const Arrival arrival = fusion_.AddMotion(motion);
  // What makes it late is its start.
  Report(kRelativeMotion,
         arrival,
         arrival == Arrival::kLate ? motion.from : motion.time);
}

void PoseFilterProcess::OnParameters(const OdometryParameters& parameters) {
  // What this process published itself comes back to it.
  if (parameters.source == "online") return;
  Report(
      kOdometryParameters, fusion_.AddParameters(parameters), parameters.time);
}

void PoseFilterProcess::Report(std::string_view channel,
                               Arrival arrival,
                               Time time) {
  const char* why = nullptr;
  switch (arrival) {
    case Arrival::kTaken:
      return;
    case Arrival::kDuplicate:
      why = "sent twice: same time, source and sequence";
      break;
    case Arrival::kLate:
      why = "arrived later than the window";
      break;
    case Arrival::kAhead:
      why = "far ahead of all others; waits for a second one";
      break;
    case Arrival::kFull:
      why = "too many wait for encoder readings";
      break;
    case Arrival::kRestarted:
      why = "time went back: started anew";
      break;
  }
  bus_->ReportBad(channel,
                  Bad::kContent,
                  "utime " + std::to_string(Microseconds(time)) + " " + why);
}

void PoseFilterProcess::PublishNewest() {
  const OdometryFilter& filter = fusion_.newest();
  const PoseEstimate pose = filter.estimate();
  bus_->Publish(kPose, ToMessage(pose, pose_seq_++));
  if (pose.is_known) bus_->Publish(kPoseBot, ToBotMessage(pose));
  bus_->Publish(kOdometry, ToMessage(filter.odometry(), odometry_seq_++));
  const std::string fault = filter.fault();
  bus_->SetFault(fault.empty() ? saver_.fault() : fault);
}

void PoseFilterProcess::PublishUnknown(Time time, std::string reason) {
  PoseEstimate pose;
  pose.time = time;
  pose.reason = std::move(reason);
  bus_->Publish(kPose, ToMessage(pose, pose_seq_++));
}

void PoseFilterProcess::PublishSettled() {
  for (const Settled& settled : fusion_.TakeSettled()) {
    bus_->Publish(kPoseSettled, ToMessage(settled.pose, settled_seq_++));
    if (settled.counts.num_refused_readings > num_refused_) {
      bus_->ReportBad(kEncoders,
                      Bad::kContent,
                      settled.pose.is_known
                          ? "a second reading of the same time"
                          : settled.pose.reason);
    }
    num_refused_ = settled.counts.num_refused_readings;
    if (settled.counts.num_crowded > num_crowded_) {
      bus_->ReportBad(kRelativeMotion,
                      Bad::kContent,
                      "more motions at once than motion.max_at_once, or more "
                      "sensors than motion.max_sensors");
    }
    num_crowded_ = settled.counts.num_crowded;
    PublishParameters(settled);
  }
}

void PoseFilterProcess::PublishParameters(const Settled& settled) {
  if (config_.use == ParameterUse::kBatch) return;
  const OdometryParameters& parameters = settled.parameters;
  const Time now = settled.pose.time;
  const auto due = [now](const std::optional<Time>& last, double period_s) {
    return !last || now < *last || now - *last >= DurationFromSeconds(period_s);
  };
  // A change between 'none' and an answer does not wait.
  if (parameters.is_known != has_parameters_ ||
      due(parameters_time_, config_.parameters_period_s)) {
    parameters_time_ = now;
    has_parameters_ = parameters.is_known;
    bus_->Publish(kOdometryParameters,
                  ToMessage(parameters, parameters_seq_++));
  }
  if (!parameters.is_known) return;
  learned_ = parameters;
  if (!save_time_) save_time_ = now;
  if (due(save_time_, kSavePeriodS)) {
    save_time_ = now;
    Save();
  }
}

void PoseFilterProcess::Save() {
  // What no measurement has shaped is no news.
  if (config_.parameters_file.empty() || !learned_ ||
      learned_->num_measurements == 0) {
    return;
  }
  // Where that fails driving goes on; STATUS says so.
  saver_.Save(TextOfParameters(*learned_));
}

void PoseFilterProcess::Finish() {
  fusion_.Finish();
  PublishSettled();
  Save();
  saver_.Flush();
  const std::string fault = saver_.fault();
  if (!fault.empty()) throw InputError(fault);
}

}  // namespace waymark
