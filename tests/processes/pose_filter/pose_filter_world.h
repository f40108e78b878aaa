// pose_filter alone on a bus, and the drive that its tests feed it.
#pragma once

#include "processes/convert/odometry_convert.h"
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/support/odometry_scene.h"

#include <waymark/status_t.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace waymark {

inline OdometryScene Scene(double duration_s = 20) {
  OdometrySceneOptions options;
  options.drive.rate_hz = 20;
  options.drive.duration_s = duration_s;
  return MakeOdometryScene(options);
}

inline PoseFilterConfig Config() {
  PoseFilterConfig config;
  config.nominal = {1e-4, 1e-4, 0.27};
  config.nominal_sigma = {0.02, 0.02, 0.05};
  config.wheel_variance = 1e-5;
  config.base_variance = 1e-7;
  config.start_position = {0, 0};
  return config;
}

inline status_t StatusOf(const LocalBus& world) {
  return world.Status("pose_filter");
}

inline std::int64_t BadOf(const LocalBus& world, std::string_view channel) {
  for (const channel_status_t& c : StatusOf(world).channels) {
    if (c.channel == channel) return c.num_bad;
  }
  return -1;
}

// A world with the process in it.
struct World {
  explicit World(const PoseFilterConfig& config)
      : process(config, bus.AddProcess("pose_filter")) {}
  void Publish(const OdometryScene& scene, double fix_delay_s = 0) {
    for (const EncoderReading& reading : scene.readings) {
      bus.Publish(kEncoders, ToMessage(reading, 0, false));
    }
    for (const AbsoluteFix& fix : scene.fixes) {
      bus.PublishAt(fix.time + DurationFromSeconds(fix_delay_s),
                    kPositionFix,
                    ToMessage(fix));
    }
  }
  void Run() {
    bus.Run();
    process.Finish();
    bus.Run();
  }
  template <typename M>
  std::vector<M> Messages(std::string_view channel) const {
    return bus.Messages<M>(channel);
  }
  LocalBus bus;
  PoseFilterProcess process;
};

// All messages on a channel, as they were sent.
inline std::vector<std::vector<std::uint8_t>> Bytes(const World& world,
                                                    std::string_view channel) {
  std::vector<std::vector<std::uint8_t>> all;
  for (const RawMessage& raw : world.bus.recording()) {
    if (raw.channel == channel) all.push_back(raw.data);
  }
  return all;
}

}  // namespace waymark
