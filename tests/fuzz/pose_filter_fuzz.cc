// pose_filter on hostile messages: no exception, and every pose that it
// publishes is finite. The first byte chooses the configuration.
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/support/channels.h"
#include "processes/support/local_bus.h"
#include "tests/fuzz/message_stream.h"

#include <waymark/pose_t.hpp>

#include <spdlog/spdlog.h>

#include <cmath>

namespace waymark::fuzz {
namespace {

bool IsOutput(std::string_view channel) {
  return channel == kPose || channel == kPoseSettled || channel == kOdometry;
}

void CheckPose(const pose_t& pose, const std::string& channel) {
  Expect((pose.is_known != 0) == pose.reason.empty(), "a reason or a pose");
  for (const double value : pose.pose_W) {
    Expect(std::isfinite(value), "finite pose on " + channel);
  }
  for (const double value : pose.covariance) {
    Expect(std::isfinite(value), "finite covariance on " + channel);
  }
  for (const int i : {0, 4, 8}) {
    Expect(pose.covariance[i] >= 0.0, "variance not negative");
  }
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  spdlog::set_level(spdlog::level::off);  // It warns of every bad message.
  PoseFilterConfig config;
  if ((data[0] & 1) != 0) config.nominal = {1e-4, 1e-4, 0.3};
  if ((data[0] & 2) != 0) config.start_position = {0.0, 0.0};
  if ((data[0] & 4) != 0) config.use = ParameterUse::kBatch;
  LocalBus world;
  PoseFilterProcess process(config, world.AddProcess("pose_filter"));
  const auto is_output = [](const StreamMessage& message) {
    return IsOutput(message.channel);
  };
  PublishStream(data.subspan(1), is_output, &world);
  world.Run();
  process.Finish();
  world.Run();
  for (const RawMessage& raw : world.recording()) {
    if (!IsOutput(raw.channel)) continue;
    const auto pose = DecodeMessage<pose_t>(raw.data);
    Expect(pose.has_value(), "it publishes what decodes");
    CheckPose(*pose, raw.channel);
  }
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const std::string& stream : StreamSeeds()) {
    seeds.push_back(std::string(1, '\0') + stream);
    seeds.push_back("\x03" + stream);
    seeds.push_back("\x04" + stream);
  }
  return seeds;
}

}  // namespace waymark::fuzz
