#include "processes/video/video_process.h"

#include "processes/convert/camera_convert.h"
#include "processes/support/channels.h"

#include <spdlog/spdlog.h>

namespace waymark {
namespace {

// How often the newest image is looked for: what it waits at most.
constexpr Duration kPollPeriod{5'000};
constexpr Duration kInfoPeriod{1'000'000};

std::string SizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height) + " px";
}

}  // namespace

VideoProcess::VideoProcess(const Config& config, Bus* bus)
    : config_(config),
      bus_(bus),
      image_channel_(std::string(kImagePrefix) + config.camera),
      info_channel_(std::string(kCameraInfoPrefix) + config.camera),
      encoder_(config.encoder) {
  if (!config.calibration.empty()) {
    camera_ = LoadCameraFile(config.calibration);
    bus->Advertise<camera_info_t>(info_channel_);
    bus->Every(kInfoPeriod, [this](Time now) { PublishCamera(now); });
  }
  bus->Advertise<image_t>(image_channel_);
  bus->Every(kPollPeriod, [this](Time now) { OnTimer(now); });
  source_ = OpenFrameSource(config.source, [bus, config] {
    return bus->now() - DurationFromSeconds(config.latency_s);
  });
}

void VideoProcess::OnTimer(Time now) {
  const std::optional<Frame> frame = source_->Take(now);
  for (const std::string& line : source_->TakeWarnings()) {
    spdlog::warn("{}; skipped", line);
  }
  if (frame) Publish(*frame);
  const std::string fault = source_->Fault();
  bus_->SetFault(fault.empty() ? image_fault_ : fault);
  if (source_->has_ended() && !has_told_end_) {
    has_told_end_ = true;
    spdlog::info("{}: at its end after {} images, {} missed",
                 config_.source.source,
                 image_seq_,
                 source_->num_missed());
  }
}

bool VideoProcess::FitsCalibration(const Frame& frame) {
  if (!camera_ || (frame.image.cols == camera_->size.width &&
                   frame.image.rows == camera_->size.height)) {
    return true;
  }
  image_fault_ = config_.calibration + ": is for " +
                 SizeText(camera_->size.width, camera_->size.height) +
                 ", the images have " +
                 SizeText(frame.image.cols, frame.image.rows);
  return false;
}

void VideoProcess::Publish(const Frame& frame) {
  image_fault_.clear();
  fits_ = FitsCalibration(frame);
  if (image_seq_ == 0 && camera_) PublishCamera(frame.time);
  std::string reason;
  const auto message = encoder_.Encode(
      frame.image, {frame.time, image_seq_, std::nullopt}, &reason);
  if (message) {
    ++image_seq_;
    bus_->Publish(image_channel_, *message);
  } else {
    image_fault_ = reason;
    if (reason != last_refusal_) spdlog::warn("{}; not sent", reason);
    last_refusal_ = reason;
  }
}

void VideoProcess::PublishCamera(Time now) {
  if (!fits_) return;
  bus_->Publish(info_channel_,
                ToMessage(*camera_, config_.camera, now, info_seq_++));
}

}  // namespace waymark
