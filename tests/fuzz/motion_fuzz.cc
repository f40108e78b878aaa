// collision_guard, path_follower and tour_driver together on hostile messages:
// no exception; what is allowed is finite, within the limits, and nothing while
// STOP holds. The first byte chooses the configuration.
#include "processes/collision_guard/collision_guard_process.h"
#include "processes/path_follower/path_follower_process.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "processes/tour_driver/tour_driver_process.h"
#include "tests/fuzz/message_stream.h"

#include <waymark/stop_t.hpp>
#include <waymark/task_status_t.hpp>
#include <waymark/velocity_t.hpp>

#include <spdlog/spdlog.h>

#include <cmath>

namespace waymark::fuzz {
namespace {

void CheckCommand(const velocity_t& command,
                  bool is_stopped,
                  const VelocityGuardOptions& options) {
  // Rounding of a velocity that was scaled down to its limit.
  constexpr double kRounding = 1e-9;
  Expect(std::abs(command.forward) <= options.max_speed + kRounding,
         "allowed speed within the limit");
  Expect(std::abs(command.turn_rate) <= options.max_turn_rate + kRounding,
         "allowed turn rate within the limit");
  Expect(!is_stopped || (command.forward == 0.0 && command.turn_rate == 0.0),
         "nothing moves while STOP holds");
}

void CheckStatus(const task_status_t& status) {
  Expect(std::isfinite(status.distance_left) && status.distance_left >= 0.0,
         "distance left");
  Expect(status.num_reached >= 0 && status.num_reached <= status.num_waypoints,
         "no more reached than there are");
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  spdlog::set_level(spdlog::level::off);  // It warns of every bad message.
  CollisionGuardConfig config;
  if ((data[0] & 1) != 0) config.guard.ranges = RangeUse::kNone;
  if ((data[0] & 2) != 0) config.guard.beam_width = 0.3;
  LocalBus world;
  CollisionGuardProcess guard(config, world.AddProcess("collision_guard"));
  PathFollowerProcess path({}, world.AddProcess("path_follower"));
  TourDriverProcess tour({}, world.AddProcess("tour_driver"));
  PublishStream(
      data.subspan(1),
      [](const StreamMessage& message) {
        return message.channel == kMotionCommand ||
               message.channel == kTaskStatus;
      },
      &world);
  world.Run();
  bool is_stopped = false;
  for (const RawMessage& raw : world.recording()) {
    if (raw.channel == kStop) {
      const auto stop = DecodeMessage<stop_t>(raw.data);
      if (!stop) continue;
      // To let go it needs a time that makes sense.
      const bool is_timed = stop->utime > 0 && stop->utime <= (1ll << 60);
      if (stop->is_stopped != 0 || is_timed) is_stopped = stop->is_stopped != 0;
    } else if (raw.channel == kMotionCommand) {
      const auto command = DecodeMessage<velocity_t>(raw.data);
      Expect(command.has_value(), "it publishes what decodes");
      CheckCommand(*command, is_stopped, config.guard);
    } else if (raw.channel == kTaskStatus) {
      const auto status = DecodeMessage<task_status_t>(raw.data);
      Expect(status.has_value(), "it publishes what decodes");
      CheckStatus(*status);
    }
  }
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const char first : {'\0', '\1', '\2'}) {
    seeds.push_back(std::string(1, first) + MotionStreamSeed());
  }
  return seeds;
}

}  // namespace waymark::fuzz
