#include "tests/fuzz/message_stream.h"

#include "processes/support/channels.h"
#include "processes/support/log_file.h"

#include <waymark/base_status_t.hpp>
#include <waymark/config_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/initial_pose_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/position_fix_t.hpp>
#include <waymark/relative_motion_t.hpp>
#include <waymark/status_t.hpp>
#include <waymark/stop_t.hpp>
#include <waymark/task_t.hpp>
#include <waymark/truth_t.hpp>
#include <waymark/velocity_t.hpp>

#include <algorithm>
#include <array>

namespace waymark::fuzz {
namespace {

constexpr std::size_t kMaxMessages = 300;
constexpr std::int64_t kStart = 1'000'000'000;  // us, as in the seeds.
constexpr std::int64_t kPeriod = 1000;          // us.

struct Channel {
  std::string_view name;
  std::int64_t fingerprint;
};

const std::array<Channel, 17>& Channels() {
  static const std::array<Channel, 17> kChannels = {{
      {kEncoders, encoders_t::getHash()},
      {kPositionFix, position_fix_t::getHash()},
      {kRelativeMotion, relative_motion_t::getHash()},
      {kInitialPose, initial_pose_t::getHash()},
      {kOdometryParameters, odometry_parameters_t::getHash()},
      {kTruth, truth_t::getHash()},
      {kOdometry, pose_t::getHash()},
      {kPose, pose_t::getHash()},
      {kPoseSettled, pose_t::getHash()},
      {kStatus, status_t::getHash()},
      {kConfig, config_t::getHash()},
      {kRanges, planar_lidar_t::getHash()},
      {kTask, task_t::getHash()},
      {kMotionRequest, velocity_t::getHash()},
      {kMotionCommand, velocity_t::getHash()},
      {kStop, stop_t::getHash()},
      {kBase, base_status_t::getHash()},
  }};
  return kChannels;
}

std::vector<StreamMessage> ReadStream(Bytes data) {
  std::vector<StreamMessage> messages;
  while (data.size() >= 3 && messages.size() < kMaxMessages) {
    const Channel& channel = Channels()[data[0] % Channels().size()];
    const std::size_t stated = static_cast<std::size_t>(data[1]) << 8 | data[2];
    const std::size_t size = std::min(stated, data.size() - 3);
    messages.push_back(
        {channel.name,
         WithFingerprint(static_cast<std::uint64_t>(channel.fingerprint),
                         data.subspan(3, size))});
    data = data.subspan(3 + size);
  }
  return messages;
}

template <typename M>
void Add(std::string_view channel, const M& message, std::string* stream) {
  std::vector<std::uint8_t> data(
      static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(data.data(), 0, static_cast<int>(data.size()));
  const auto& channels = Channels();
  const auto index =
      std::find_if(channels.begin(),
                   channels.end(),
                   [&](const Channel& c) { return c.name == channel; }) -
      channels.begin();
  const std::size_t size = data.size() - 8;
  stream->push_back(static_cast<char>(index));
  stream->push_back(static_cast<char>(size >> 8));
  stream->push_back(static_cast<char>(size));
  stream->append(data.begin() + 8, data.end());
}

void AddParameters(std::string* stream) {
  odometry_parameters_t parameters;
  parameters.utime = kStart;
  parameters.source = "nominal";
  parameters.is_known = 1;
  parameters.k_right = parameters.k_left = 1e-4;
  parameters.wheel_base = 0.3;
  parameters.covariance[0] = parameters.covariance[4] = 1e-12;
  parameters.covariance[8] = 1e-5;
  Add(kOdometryParameters, parameters, stream);
}

void AddStart(std::string* stream) {
  initial_pose_t start;
  start.utime = kStart;
  start.source = "recording";
  start.covariance[0] = start.covariance[4] = start.covariance[8] = 1e-4;
  Add(kInitialPose, start, stream);
}

void AddStep(int step, std::string* stream) {
  const std::int64_t utime = kStart + 100'000 * step;
  const double x = 0.05 * step;
  encoders_t encoders;
  encoders.utime = utime;
  encoders.seq = step;
  encoders.left_ticks = encoders.right_ticks = 500 * step;
  Add(kEncoders, encoders, stream);
  truth_t truth;
  truth.utime = utime;
  truth.seq = step;
  truth.source = "simulator";
  truth.has_heading = 1;
  truth.x = x;
  Add(kTruth, truth, stream);
  pose_t pose;
  pose.utime = utime;
  pose.seq = step;
  pose.is_known = 1;
  pose.pose_W[0] = x;
  pose.covariance[0] = pose.covariance[4] = pose.covariance[8] = 0.01;
  Add(step % 2 == 0 ? kPose : kPoseSettled, pose, stream);
  if (step % 3 != 0) return;
  position_fix_t fix;
  fix.utime = utime;
  fix.source = "reference, every 3rd";
  fix.has_x = fix.has_y = 1;
  fix.x = x;
  fix.covariance[0] = fix.covariance[4] = 0.01;
  Add(kPositionFix, fix, stream);
  relative_motion_t motion;
  motion.utime_from = utime - 100'000;
  motion.utime = utime;
  motion.source = "laser";
  motion.motion[0] = 0.05;
  motion.covariance[0] = motion.covariance[4] = motion.covariance[8] = 1e-4;
  Add(kRelativeMotion, motion, stream);
}

}  // namespace

void PublishStream(Bytes data,
                   const std::function<bool(const StreamMessage&)>& is_output,
                   LocalBus* world) {
  std::int64_t arrival = kStart;
  for (StreamMessage& message : ReadStream(data)) {
    if (is_output(message)) continue;
    arrival += kPeriod;
    world->PublishBytesAt(TimeFromMicroseconds(arrival),
                          message.channel,
                          std::move(message.data));
  }
}

std::int64_t WriteStreamLog(Bytes data, const std::string& path) {
  LogWriter writer(path, IfExists::kReplace);
  std::int64_t utime = kStart;
  for (const StreamMessage& message : ReadStream(data)) {
    writer.Write(TimeFromMicroseconds(utime), message.channel, message.data);
    utime += kPeriod;
  }
  writer.Close();
  return writer.num_events();
}

std::vector<std::string> StreamSeeds() {
  std::string ticks;
  AddParameters(&ticks);
  for (int step = 0; step < 4; ++step) AddStep(step, &ticks);
  std::string drive;
  AddParameters(&drive);
  AddStart(&drive);
  for (int step = 0; step < 12; ++step) AddStep(step, &drive);
  status_t status;
  status.process = "pose_filter";
  status.num_channels = 1;
  status.channels.resize(1);
  status.channels[0].channel = kEncoders;
  Add(kStatus, status, &drive);
  config_t config;
  config.process = "pose_filter";
  config.yaml = "window_s: 2";
  Add(kConfig, config, &drive);
  return {ticks, drive};
}

std::string MotionStreamSeed() {
  std::string stream;
  task_t task;
  task.utime = kStart;
  task.source = "person";
  task.kind = "waypoints";
  task.num_waypoints = 2;
  task.waypoints.resize(2);
  task.waypoints[0].x = 0.3;
  task.waypoints[1].x = 0.3;
  task.waypoints[1].y = 0.2;
  task.waypoints[1].has_heading = 1;
  Add(kTask, task, &stream);
  for (int step = 1; step < 12; ++step) {
    planar_lidar_t ranges;
    ranges.utime = kStart + 100'000 * step;
    ranges.nranges = 8;
    ranges.ranges.assign(8, 1.0f);
    ranges.nintensities = 0;
    ranges.radstep = 0.785f;
    Add(kRanges, ranges, &stream);
    pose_t pose;
    pose.utime = ranges.utime;
    pose.is_known = 1;
    pose.pose_W[0] = 0.03 * step;
    Add(kPose, pose, &stream);
    velocity_t request;
    request.utime = ranges.utime + 1;
    request.source = "person";
    request.forward = 0.2;
    request.turn_rate = 0.1;
    Add(kMotionRequest, request, &stream);
    stop_t stop;
    stop.utime = ranges.utime + 2;
    stop.source = "person";
    stop.is_stopped = step == 5 ? 1 : 0;
    if (step == 5 || step == 7) Add(kStop, stop, &stream);
    base_status_t base;
    base.utime = ranges.utime + 3;
    base.is_bumper_left = step == 9 ? 1 : 0;
    Add(kBase, base, &stream);
  }
  return stream;
}

}  // namespace waymark::fuzz
