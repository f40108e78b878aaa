#include "processes/pose_filter/pose_filter_process.h"

#include "processes/convert/odometry_convert.h"
#include "processes/pose_filter/parameter_file.h"
#include "processes/support/channels.h"
#include "processes/support/input_error.h"
#include "processes/support/local_bus.h"
#include "tests/support/odometry_scene.h"

#include <waymark/bot_pose_t.hpp>
#include <waymark/pose_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace waymark {
namespace {

using testing::AllOf;
using testing::HasSubstr;

OdometryScene Scene(double duration_s = 20) {
  OdometrySceneOptions options;
  options.drive.rate_hz = 20;
  options.drive.duration_s = duration_s;
  return MakeOdometryScene(options);
}

PoseFilterConfig Config() {
  PoseFilterConfig config;
  config.nominal = {1e-4, 1e-4, 0.27};
  config.nominal_sigma = {0.02, 0.02, 0.05};
  config.wheel_variance = 1e-5;
  config.base_variance = 1e-7;
  config.start_position = {0, 0};
  return config;
}

status_t StatusOf(const LocalBus& world) {
  return world.Status("pose_filter");
}

std::int64_t BadOf(const LocalBus& world, std::string_view channel) {
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

template <typename M>
std::vector<std::vector<std::uint8_t>> Bytes(const World& world,
                                             std::string_view channel) {
  std::vector<std::vector<std::uint8_t>> all;
  for (const RawMessage& raw : world.bus.recording()) {
    if (raw.channel == channel) all.push_back(raw.data);
  }
  return all;
}

TEST(PoseFilterProcess, PublishesEverythingPerReading) {
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene);
  world.Run();
  const auto poses = world.Messages<pose_t>(kPose);
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(poses.size(), scene.readings.size());
  ASSERT_EQ(settled.size(), scene.readings.size());
  EXPECT_EQ(world.Messages<pose_t>(kOdometry).size(), scene.readings.size());
  EXPECT_EQ(world.Messages<bot_pose_t>(kPoseBot).size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].utime, Microseconds(scene.readings[i].time));
    EXPECT_EQ(settled[i].utime, poses[i].utime);
    EXPECT_EQ(poses[i].seq, static_cast<int>(i));
    ASSERT_TRUE(poses[i].is_known) << poses[i].reason;
    EXPECT_LT(std::hypot(settled[i].pose_W[0] - scene.truth[i].x,
                         settled[i].pose_W[1] - scene.truth[i].y),
              0.1);
  }
  EXPECT_EQ(settled.back().num_accepted, static_cast<int>(scene.fixes.size()));
  // Once a second of the settled time.
  const auto parameters =
      world.Messages<odometry_parameters_t>(kOdometryParameters);
  ASSERT_EQ(parameters.size(), 21u);
  EXPECT_EQ(parameters.back().source, "online");
  EXPECT_GT(parameters.back().observability[2], 0.1);
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
  EXPECT_EQ(StatusOf(world.bus).fault, "");
}

TEST(PoseFilterProcess, SettledBytesDoNotDependOnArrival) {
  const OdometryScene scene = Scene();
  World in_order(Config());
  in_order.Publish(scene);
  in_order.Run();
  World late(Config());
  late.Publish(scene, 1.9);
  late.Run();
  EXPECT_EQ(Bytes<pose_t>(in_order, kPoseSettled),
            Bytes<pose_t>(late, kPoseSettled));
  EXPECT_EQ(Bytes<odometry_parameters_t>(in_order, kOdometryParameters),
            Bytes<odometry_parameters_t>(late, kOdometryParameters));
  EXPECT_NE(Bytes<pose_t>(in_order, kPose), Bytes<pose_t>(late, kPose));
}

TEST(PoseFilterProcess, TooLateIsCountedAndNothingElseIsLost) {
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene, 3.0);
  world.Run();
  EXPECT_GT(BadOf(world.bus, kPositionFix), 30);
  EXPECT_EQ(world.Messages<pose_t>(kPoseSettled).size(), scene.readings.size());
}

TEST(PoseFilterProcess, ParametersAndStartFromTheLog) {
  const OdometryScene scene = Scene();
  PoseFilterConfig config;
  World world(config);
  OdometryParameters nominal;
  nominal.time = scene.readings[0].time;
  nominal.source = "nominal";
  nominal.parameters = {1e-4, 1e-4, 0.27};
  world.bus.Publish(kOdometryParameters, ToMessage(nominal, 0));
  InitialPose start;
  start.time = scene.readings[0].time;
  start.source = "log";
  world.bus.Publish(kInitialPose, ToMessage(start));
  world.Publish(scene);
  world.Run();
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(settled.size(), scene.readings.size());
  for (const pose_t& pose : settled) EXPECT_TRUE(pose.is_known) << pose.reason;
}

TEST(PoseFilterProcess, SaysWhyThereIsNoPose) {
  const OdometryScene scene = Scene(4);
  {
    World world(PoseFilterConfig{});
    world.Publish(scene);
    world.Run();
    for (const pose_t& pose : world.Messages<pose_t>(kPose)) {
      EXPECT_FALSE(pose.is_known);
      EXPECT_THAT(pose.reason, HasSubstr("no wheel parameters"));
      EXPECT_EQ(pose.pose_W[0], 0);
    }
    EXPECT_TRUE(world.Messages<bot_pose_t>(kPoseBot).empty());
  }
  World world(Config());
  world.bus.Publish(kPositionFix, ToMessage(scene.fixes[0]));
  world.bus.Run();
  ASSERT_EQ(world.Messages<pose_t>(kPose).size(), 1u);
  EXPECT_THAT(world.Messages<pose_t>(kPose)[0].reason,
              HasSubstr("no encoder readings"));
}

TEST(PoseFilterProcess, BadMessagesAreCountedAndTheRestIsFused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const OdometryScene scene = Scene();
  World world(Config());
  world.Publish(scene);
  position_fix_t fix = ToMessage(scene.fixes[3]);
  fix.seq = 1000;
  fix.x = nan;
  world.bus.Publish(kPositionFix, fix);
  fix = ToMessage(scene.fixes[3]);
  fix.seq = 1001;
  fix.covariance[0] = -1;
  world.bus.Publish(kPositionFix, fix);
  encoders_t encoders = ToMessage(scene.readings[50], 0, false);
  encoders.seq = 1002;
  encoders.counter_bits = 3;
  world.bus.Publish(kEncoders, encoders);
  initial_pose_t start{};
  start.utime = encoders.utime;
  start.pose_W[2] = nan;
  world.bus.Publish(kInitialPose, start);
  odometry_parameters_t parameters{};
  parameters.utime = encoders.utime;
  parameters.source = "nominal";
  parameters.is_known = 1;
  world.bus.Publish(kOdometryParameters, parameters);
  // Time going backwards, by an hour, once.
  encoders = ToMessage(scene.readings[60], 0, false);
  encoders.utime -= 3'600'000'000;
  world.bus.PublishAt(scene.readings[60].time, kEncoders, encoders);
  // Another type, and half a message.
  const pose_t other{};
  world.bus.PublishAt(scene.readings[70].time, kEncoders, other);
  world.bus.PublishBytesAt(
      scene.readings[71].time, kPositionFix, {1, 2, 3, 4, 5});
  world.Run();
  EXPECT_EQ(BadOf(world.bus, kPositionFix), 3);
  EXPECT_EQ(BadOf(world.bus, kEncoders), 3);
  EXPECT_EQ(BadOf(world.bus, kInitialPose), 1);
  EXPECT_EQ(BadOf(world.bus, kOdometryParameters), 1);
  const auto settled = world.Messages<pose_t>(kPoseSettled);
  ASSERT_EQ(settled.size(), scene.readings.size());
  EXPECT_EQ(settled.back().num_accepted, static_cast<int>(scene.fixes.size()));
  EXPECT_TRUE(settled.back().is_known);
}

TEST(PoseFilterProcess, EncoderJumpIsAFaultWhileItLasts) {
  OdometryScene scene = Scene();
  scene.readings[100].left += 50'000'000;
  World world(Config());
  world.Publish(scene);
  std::string fault_then;
  world.bus.CallAt(scene.readings[100].time + Duration(1000),
                   [&] { fault_then = StatusOf(world.bus).fault; });
  world.Run();
  EXPECT_THAT(fault_then, HasSubstr("encoder jump: left wheel"));
  EXPECT_EQ(StatusOf(world.bus).fault, "");
  EXPECT_EQ(BadOf(world.bus, kEncoders), 1);
  const auto poses = world.Messages<pose_t>(kPose);
  EXPECT_FALSE(poses[100].is_known);
  EXPECT_THAT(poses[100].reason, HasSubstr("encoder jump"));
  EXPECT_TRUE(poses[101].is_known);
}

TEST(PoseFilterProcess, SixteenBitCountersWrap) {
  const OdometryScene scene = Scene();
  World plain(Config());
  plain.Publish(scene);
  plain.Run();
  World wrapped(Config());
  for (EncoderReading reading : scene.readings) {
    reading.right &= 0xffff;
    reading.left &= 0xffff;
    wrapped.bus.Publish(kEncoders, ToMessage(reading, 16, false));
  }
  for (const AbsoluteFix& fix : scene.fixes) {
    wrapped.bus.Publish(kPositionFix, ToMessage(fix));
  }
  wrapped.Run();
  EXPECT_GT(scene.readings.back().right, 65536);
  EXPECT_EQ(Bytes<pose_t>(plain, kPoseSettled),
            Bytes<pose_t>(wrapped, kPoseSettled));
}

TEST(PoseFilterProcess, BatchParametersTakeEffectOneWindowLater) {
  const OdometryScene scene = Scene();
  PoseFilterConfig config = Config();
  config.use = ParameterUse::kBatch;
  OdometryParameters batch;
  batch.time = scene.readings[100].time;
  batch.source = "batch";
  batch.parameters = {1.02e-4, 1.02e-4, 0.27};
  batch.covariance = Eigen::Vector3d(1e-14, 1e-14, 1e-8).asDiagonal();
  std::vector<std::vector<std::uint8_t>> first;
  for (const double delay_s : {0.1, 1.7}) {
    World world(config);
    world.Publish(scene);
    world.bus.PublishAt(batch.time + DurationFromSeconds(delay_s),
                        kOdometryParameters,
                        ToMessage(batch, 0));
    world.Run();
    // Speed by the parameters in force: two seconds are forty readings.
    const auto settled = world.Messages<pose_t>(kPoseSettled);
    EXPECT_NEAR(settled[139].velocity_R[0], 0.4, 0.003);
    EXPECT_NEAR(settled[142].velocity_R[0], 0.408, 0.003);
    if (first.empty()) first = Bytes<pose_t>(world, kPoseSettled);
    EXPECT_EQ(Bytes<pose_t>(world, kPoseSettled), first);
    // Nothing is estimated online, so nothing is said.
    EXPECT_EQ(world.Messages<odometry_parameters_t>(kOdometryParameters).size(),
              1u);
  }
}

// Wheels that are 4 % off, and no fix at all.
TEST(PoseFilterProcess, RelativeMotionsTeachTheWheels) {
  const OdometryScene scene = Scene(60);
  PoseFilterConfig config = Config();
  config.nominal = {1.04e-4, 1e-4, 0.26};
  const Pose2 X_RS{0.1, 0.0, 0.5};
  std::vector<relative_motion_t> motions;
  for (std::size_t i = 8; i < scene.readings.size(); i += 8) {
    RelativeMotion motion;
    motion.source = "scan";
    motion.seq = static_cast<std::int64_t>(motions.size());
    motion.from = scene.readings[i - 8].time;
    motion.time = scene.readings[i].time;
    motion.X_RS = X_RS;
    motion.X_S0S1 = Between(scene.truth[i - 8] * X_RS, scene.truth[i] * X_RS);
    motion.covariance = Eigen::Vector3d(1e-6, 1e-6, 4e-6).asDiagonal();
    motions.push_back(ToMessage(motion));
  }
  std::vector<std::vector<std::uint8_t>> first;
  for (const double delay_s : {0.0, 1.5}) {
    World world(config);
    for (const EncoderReading& reading : scene.readings) {
      world.bus.Publish(kEncoders, ToMessage(reading, 0, false));
    }
    for (const relative_motion_t& motion : motions) {
      world.bus.PublishAt(
          TimeFromMicroseconds(motion.utime) + DurationFromSeconds(delay_s),
          kRelativeMotion,
          motion);
    }
    // Too long for the window, and no motion at all.
    relative_motion_t bad = motions[100];
    bad.seq = 1000;
    bad.utime_from = bad.utime - 2'100'000;
    world.bus.Publish(kRelativeMotion, bad);
    bad.utime_from = bad.utime;
    world.bus.Publish(kRelativeMotion, bad);
    world.Run();
    EXPECT_EQ(BadOf(world.bus, kRelativeMotion), 2);
    const auto settled = world.Messages<pose_t>(kPoseSettled);
    EXPECT_EQ(settled.back().num_accepted, static_cast<int>(motions.size()));
    EXPECT_LT(std::hypot(settled.back().pose_W[0] - scene.truth.back().x,
                         settled.back().pose_W[1] - scene.truth.back().y),
              0.3);
    const auto learned =
        world.Messages<odometry_parameters_t>(kOdometryParameters).back();
    EXPECT_NEAR(learned.k_right, 1e-4, 4.0 * std::sqrt(learned.covariance[0]));
    EXPECT_NEAR(
        learned.wheel_base, 0.27, 4.0 * std::sqrt(learned.covariance[8]));
    EXPECT_GT(learned.observability[0], 0.8);
    if (first.empty()) first = Bytes<pose_t>(world, kPoseSettled);
    EXPECT_EQ(Bytes<pose_t>(world, kPoseSettled), first);
  }
}

// What batch_refiner says while it has no answer yet.
TEST(PoseFilterProcess, BatchThatHasNoAnswerIsNotAdopted) {
  const OdometryScene scene = Scene();
  PoseFilterConfig config = Config();
  config.use = ParameterUse::kBatch;
  OdometryParameters none;
  none.time = scene.readings[100].time;
  none.source = "batch";
  none.is_known = false;
  none.reason = "the wheels travelled 0 m, less than 0.2 m";
  none.parameters = {2e-4, 2e-4, 0.27};
  none.covariance = Eigen::Vector3d(1e-14, 1e-14, 1e-8).asDiagonal();
  World plain(config);
  plain.Publish(scene);
  plain.Run();
  World world(config);
  world.Publish(scene);
  world.bus.Publish(kOdometryParameters, ToMessage(none, 0));
  world.Run();
  EXPECT_EQ(Bytes<pose_t>(world, kPoseSettled),
            Bytes<pose_t>(plain, kPoseSettled));
  EXPECT_EQ(StatusOf(world.bus).num_bad, 0);
}

TEST(PoseFilterProcess, SaysWhyThereAreNoParametersUntilThereAre) {
  const OdometryScene scene = Scene();
  World world(PoseFilterConfig{});
  world.Publish(scene);
  OdometryParameters nominal;
  nominal.time = scene.readings[50].time;
  nominal.source = "nominal";
  nominal.parameters = {1e-4, 1e-4, 0.27};
  world.bus.Publish(kOdometryParameters, ToMessage(nominal, 0));
  world.Run();
  std::vector<odometry_parameters_t> online;
  for (const auto& m :
       world.Messages<odometry_parameters_t>(kOdometryParameters)) {
    if (m.source == "online") online.push_back(m);
  }
  // At 0, 1 and 2 s, and at once when they are there: at 2.5 s.
  ASSERT_GT(online.size(), 4u);
  for (std::size_t i = 0; i < online.size(); ++i) {
    EXPECT_EQ(online[i].seq, static_cast<int>(i));
    EXPECT_EQ(online[i].is_known, i < 3 ? 0 : 1);
    EXPECT_EQ(
        online[i].reason,
        i < 3 ? "no wheel parameters: none configured, none received" : "");
  }
  EXPECT_EQ(online[0].wheel_base, 0.0);
  EXPECT_EQ(online[3].utime, Microseconds(nominal.time));
  EXPECT_EQ(online[3].wheel_base, 0.27);
}

class ParameterFileTest : public testing::Test {
 protected:
  ParameterFileTest()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("pose_filter_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ParameterFileTest() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string Path() const { return folder_ / "wheels.yaml"; }
  void Write(const std::string& text) const { std::ofstream(Path()) << text; }
  [[nodiscard]] std::string Read() const {
    std::ifstream file(Path());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::string ErrorOf(PoseFilterConfig config) const {
    try {
      LocalBus bus;
      const PoseFilterProcess process(config, bus.AddProcess("pose_filter"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path folder_;
};

TEST_F(ParameterFileTest, LearnedParametersAreReloaded) {
  PoseFilterConfig config = Config();
  config.parameters_file = Path();
  // Wheels 2 % off.
  config.nominal = {1.02e-4, 1e-4, 0.27};
  const OdometryScene scene = Scene(60);
  World first(config);
  first.Publish(scene);
  first.Run();
  const auto learned =
      first.Messages<odometry_parameters_t>(kOdometryParameters).back();
  const std::string saved = Read();
  EXPECT_THAT(saved, HasSubstr("k_right"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);

  World second(config);
  second.Publish(scene);
  second.Run();
  const auto started =
      second.Messages<odometry_parameters_t>(kOdometryParameters).front();
  EXPECT_NEAR(started.k_right, learned.k_right, 1e-8);
  EXPECT_LT(std::abs(started.k_right - 1e-4), 0.3e-6);
  // Dead reckoning stays nominal.
  EXPECT_EQ(Bytes<pose_t>(first, kOdometry), Bytes<pose_t>(second, kOdometry));
}

TEST_F(ParameterFileTest, CorruptFileIsOneClearLine) {
  PoseFilterConfig config = Config();
  config.parameters_file = Path();
  const auto expect = [&](const std::string& text, const char* part) {
    Write(text);
    const std::string error = ErrorOf(config);
    EXPECT_THAT(error, AllOf(HasSubstr(Path()), HasSubstr(part))) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  };
  expect("", "");
  expect("k_right: [", "");
  expect("k_right: -3\n", "k_right");
  expect("k_rihgt: 3\n", "k_rihgt");
  const std::string good =
      "utime: 5\nk_right: 1e-4\nk_left: 1e-4\nwheel_base: 0.3\n"
      "num_measurements: 3\ncovariance: ";
  Write(good + "[1e-12, 0, 0, 0, 1e-12, 0, 0, 0, 1e-6]\n");
  EXPECT_EQ(ErrorOf(config), "");
  expect(good + "[1e-12, 0, 0]\n", "covariance");
  expect(good + "[-1, 0, 0, 0, 1e-12, 0, 0, 0, 1e-6]\n", "variance -1");
  expect(good + "[1, 2, 0, 0, 1, 0, 0, 0, 1]\n", "symmetric");
  // No file is no error: the first run.
  std::filesystem::remove(Path());
  EXPECT_EQ(ErrorOf(config), "");
}

TEST_F(ParameterFileTest, MissingFolderIsRefusedAtTheStart) {
  PoseFilterConfig config = Config();
  config.parameters_file = folder_ / "absent" / "wheels.yaml";
  EXPECT_THAT(ErrorOf(config),
              AllOf(HasSubstr("absent/wheels.yaml: cannot be written: "),
                    HasSubstr("No such file or directory")));
}

TEST_F(ParameterFileTest, PlaceThatVanishesIsReportedAndDrivingGoesOn) {
  PoseFilterConfig config = Config();
  config.parameters_file = folder_ / "absent" / "wheels.yaml";
  std::filesystem::create_directory(folder_ / "absent");
  const OdometryScene scene = Scene(60);
  World world(config);
  std::filesystem::remove(folder_ / "absent");
  world.Publish(scene);
  world.bus.Run();
  EXPECT_THAT(StatusOf(world.bus).fault, HasSubstr("absent/wheels.yaml"));
  EXPECT_TRUE(world.Messages<pose_t>(kPose).back().is_known);
  EXPECT_THROW(world.process.Finish(), InputError);
}

// A device that is always full: the old file survives.
TEST_F(ParameterFileTest, FullDiskLeavesTheOldFile) {
  std::filesystem::create_symlink("/dev/full", Path() + ".new");
  Write("old");
  OdometryParameters parameters;
  parameters.time = TimeFromMicroseconds(4);
  parameters.parameters = {1e-4, 1e-4, 0.3};
  EXPECT_THROW(SaveParameterFile(Path(), parameters), InputError);
  EXPECT_EQ(Read(), "old");
}

TEST(PoseFilterConfig, RefusesWhatCannotWork) {
  const auto refused = [](auto spoil) -> std::string {
    PoseFilterConfig config;
    spoil(&config);
    try {
      config.Check();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused([](auto*) {}), "");
  EXPECT_THAT(refused([](auto* c) {
                c->nominal = {1, -1, 1};
              }),
              HasSubstr("wheels.nominal"));
  EXPECT_THAT(refused([](auto* c) {
                c->nominal_sigma = {1, 0, 1};
              }),
              HasSubstr("wheels.nominal_sigma"));
  EXPECT_THAT(refused([](auto* c) { c->gate.prior_regular = 0.9; }),
              HasSubstr("gate.prior_regular"));
  EXPECT_THAT(refused([](auto* c) { c->walk_per_sqrt_metre[1] = -1; }),
              HasSubstr("walk"));
  EXPECT_THAT(refused([](auto* c) { c->alignment.max_fixes = 4; }),
              HasSubstr("alignment.max_fixes"));
}

}  // namespace
}  // namespace waymark
