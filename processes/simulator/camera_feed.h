// A simulated camera's images on their way, from exposure to bus.
#pragma once

#include "drivers/simulator/renderer.h"
#include "drivers/simulator/simulation.h"
#include "estimation/base/time.h"
#include "processes/simulator/camera_rig.h"
#include "processes/simulator/simulator_config.h"
#include "processes/support/bus.h"

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

class CameraFeed {
 public:
  // `renderer` and `bus` outlive this. Live, an image is drawn in a thread of
  // its own while wheels and sonar go on, and an exposure that ends while the
  // last one is being drawn is left out; otherwise when it arrives, and
  // whatever that takes. Throws InputError as CameraRig does.
  CameraFeed(const SimulatedCameraConfig& config,
             const Renderer* renderer,
             std::uint64_t seed,
             Bus* bus,
             bool is_live);

  void Expose(const CameraEvent& event);
  // Those that have arrived and are drawn.
  void PublishImages(Time simulated);
  void PublishInfo(Time simulated, std::int64_t seq);

  [[nodiscard]] SimulatedCamera timing() const { return rig_->timing(); }
  [[nodiscard]] const std::string& image_channel() const {
    return rig_->image_channel();
  }
  [[nodiscard]] std::int64_t num_sent() const { return num_sent_; }
  [[nodiscard]] std::int64_t num_missed() const { return num_missed_; }
  // That exposures were left out after `since`, on the bus's clock; why the
  // last image could not be sent.
  [[nodiscard]] std::vector<std::string> Faults(Time since) const;

 private:
  struct Pending {
    Time arrival;  // Of the image, in simulated time.
    std::future<CameraRig::Shot> shot;
  };

  std::unique_ptr<CameraRig> rig_;  // Stays where it is: threads use it.
  Bus* bus_;
  bool is_live_;
  std::deque<Pending> pending_;
  std::int64_t num_sent_ = 0;
  std::int64_t num_missed_ = 0;
  std::optional<Time> missed_time_;  // The last one.
  std::string fault_;
};

}  // namespace waymark
