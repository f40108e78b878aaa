#include "processes/pose_filter/pose_filter_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/pose_filter/parameter_file.h"
#include "processes/support/channels.h"
#include "processes/support/input_error.h"

#include <cstdio>
#include <utility>

namespace waymark {
namespace {

// A crash loses at most this much of what was learned.
constexpr double kSavePeriod_s = 30.0;

DelayedFusionOptions OptionsOf(const PoseFilterConfig& config) {
  DelayedFusionOptions options = config.Options();
  if (!config.parameters_file.empty()) {
    options.filter.learned = LoadParameterFile(config.parameters_file);
  }
  return options;
}

}  // namespace

PoseFilterProcess::PoseFilterProcess(const Config& config, Bus* bus)
    : config_(config), bus_(bus), fusion_(OptionsOf(config)) {
  for (const auto channel : {kPose, kPoseSettled, kOdometry}) {
    bus->Advertise<pose_t>(channel);
  }
  bus->Advertise<bot_pose_t>(kPoseBot);
  bus->Advertise<odometry_parameters_t>(kOdometryParameters, "online");
  bus->Subscribe<encoders_t>(
      kEncoders, Keep::All(), [this](const encoders_t& m, Time) {
        OnEncoders(m);
      });
  bus->Subscribe<position_fix_t>(
      kPositionFix, Keep::All(), [this](const position_fix_t& m, Time) {
        OnFix(m);
      });
  bus->Subscribe<initial_pose_t>(
      kInitialPose, Keep::All(), [this](const initial_pose_t& m, Time) {
        OnInitialPose(m);
      });
  bus->Subscribe<odometry_parameters_t>(
      kOdometryParameters,
      Keep::All(),
      [this](const odometry_parameters_t& m, Time) { OnParameters(m); });
}

void PoseFilterProcess::OnEncoders(const encoders_t& message) {
  std::string reason;
  const auto reading = EncoderReadingFromMessage(message, &reason);
  if (!reading) {
    bus_->ReportBad(kEncoders, Bad::kContent, reason);
    return;
  }
  const Arrival arrival = fusion_.AddReading(*reading, message.counter_bits);
  Report(kEncoders, arrival, reading->time);
  if (fusion_.newest_time() == reading->time) PublishNewest();
  PublishSettled();
}

void PoseFilterProcess::OnFix(const position_fix_t& message) {
  std::string reason;
  const auto fix = AbsoluteFixFromMessage(message, &reason);
  if (!fix) {
    bus_->ReportBad(kPositionFix, Bad::kContent, reason);
    return;
  }
  Report(kPositionFix, fusion_.AddFix(*fix), fix->time);
  const auto newest = fusion_.newest_time();
  const Duration window = DurationFromSeconds(config_.window_s);
  if (!newest) {
    PublishUnknown(fix->time, "no encoder readings yet");
  } else if (fix->time - *newest > window) {
    PublishUnknown(fix->time, "no encoder readings for longer than the window");
  }
}

void PoseFilterProcess::OnInitialPose(const initial_pose_t& message) {
  std::string reason;
  const auto pose = InitialPoseFromMessage(message, &reason);
  if (!pose) {
    bus_->ReportBad(kInitialPose, Bad::kContent, reason);
    return;
  }
  Report(kInitialPose, fusion_.AddInitialPose(*pose), pose->time);
}

void PoseFilterProcess::OnParameters(const odometry_parameters_t& message) {
  // What this process published itself comes back to it.
  if (message.source == "online") return;
  std::string reason;
  const auto parameters = OdometryParametersFromMessage(message, &reason);
  if (!parameters) {
    bus_->ReportBad(kOdometryParameters, Bad::kContent, reason);
    return;
  }
  Report(kOdometryParameters,
         fusion_.AddParameters(*parameters),
         parameters->time);
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
  bus_->SetFault(fault.empty() ? save_fault_ : fault);
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
    PublishParameters(settled);
  }
}

void PoseFilterProcess::PublishParameters(const Settled& settled) {
  if (!settled.parameters || config_.use == ParameterUse::kBatch) return;
  learned_ = settled.parameters;
  const Time now = settled.pose.time;
  const auto due = [now](const std::optional<Time>& last, double period_s) {
    return !last || now < *last || now - *last >= DurationFromSeconds(period_s);
  };
  if (due(parameters_time_, config_.parameters_period_s)) {
    parameters_time_ = now;
    bus_->Publish(kOdometryParameters,
                  ToMessage(*settled.parameters, parameters_seq_++));
  }
  if (!save_time_) save_time_ = now;
  if (due(save_time_, kSavePeriod_s)) {
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
  try {
    SaveParameterFile(config_.parameters_file, *learned_);
    save_fault_.clear();
  } catch (const InputError& error) {
    // Driving goes on; STATUS says so.
    save_fault_ = error.what();
  }
}

void PoseFilterProcess::Finish() {
  fusion_.Finish();
  PublishSettled();
  Save();
  if (!save_fault_.empty()) throw InputError(save_fault_);
}

}  // namespace waymark
