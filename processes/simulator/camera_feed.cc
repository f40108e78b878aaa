#include "processes/simulator/camera_feed.h"

#include <waymark/camera_info_t.hpp>
#include <waymark/image_t.hpp>

#include <spdlog/fmt/fmt.h>

#include <chrono>

namespace waymark {

CameraFeed::CameraFeed(const SimulatedCameraConfig& config,
                       const Renderer* renderer,
                       std::uint64_t seed,
                       Bus* bus,
                       bool is_live)
    : rig_(std::make_unique<CameraRig>(config, renderer, seed)),
      bus_(bus),
      is_live_(is_live) {
  bus->Advertise<image_t>(rig_->image_channel());
  bus->Advertise<camera_info_t>(rig_->info_channel());
}

void CameraFeed::Expose(const CameraEvent& event) {
  if (is_live_ && !pending_.empty() &&
      pending_.back().shot.wait_for(std::chrono::seconds(0)) !=
          std::future_status::ready) {
    ++num_missed_;
    missed_time_ = bus_->now();
    return;
  }
  pending_.push_back(
      {event.frame.arrival,
       std::async(is_live_ ? std::launch::async : std::launch::deferred,
                  [rig = rig_.get(), event] { return rig->Expose(event); })});
}

void CameraFeed::PublishImages(Time simulated) {
  while (!pending_.empty()) {
    Pending& next = pending_.front();
    if (next.arrival > simulated || next.shot.wait_for(std::chrono::seconds(
                                        0)) == std::future_status::timeout) {
      break;
    }
    const CameraRig::Shot shot = next.shot.get();
    pending_.pop_front();
    fault_ = shot.reason;
    if (!shot.image) continue;
    ++num_sent_;
    bus_->Publish(rig_->image_channel(), *shot.image);
  }
}

void CameraFeed::PublishInfo(Time simulated, std::int64_t seq) {
  bus_->Publish(rig_->info_channel(), rig_->Info(simulated, seq));
}

std::vector<std::string> CameraFeed::Faults(Time since) const {
  std::vector<std::string> faults;
  if (missed_time_ && *missed_time_ > since) {
    faults.push_back(
        fmt::format("{}: {} images not drawn: this machine is too slow for "
                    "their rate",
                    rig_->image_channel(),
                    num_missed_));
  }
  if (!fault_.empty()) faults.push_back(fault_);
  return faults;
}

}  // namespace waymark
