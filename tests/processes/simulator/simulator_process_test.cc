// The simulator as it runs freely, by the clock of the bus, and what it takes.
#include "estimation/base/input_error.h"
#include "processes/convert/camera_convert.h"
#include "processes/convert/image_convert.h"
#include "processes/support/process_class.h"
#include "tests/processes/simulator/simulator_test.h"

#include <waymark/base_status_t.hpp>
#include <waymark/camera_info_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

using SimulatorProcessTest = SimulatorTest;

std::string ErrorOf(const SimulatorConfig& config) {
  try {
    const SimulatorOnBus run(config);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST_F(SimulatorProcessTest, DrivesAsCommandedAndStopsWithoutCommands) {
  SimulatorOnBus run(config_);
  run.Drive(kStart + seconds(1), kStart + seconds(5), 0.3, 0.0);
  run.bus.RunUntil(kStart + seconds(8));

  const auto truths = run.bus.Messages<truth_t>(kTruth);
  // 50 Hz for 8 s, none before the first tick.
  ASSERT_EQ(truths.size(), 399u + 1u);
  EXPECT_EQ(truths.front().x, 1.0);
  EXPECT_EQ(truths.back().y, 2.0);
  // Commands from 1.0 to 4.9 s; half a second after the last it stands. At
  // 2 m/s^2 speeding up and braking take 0.15 s each, and lose half of that.
  constexpr double kWay = 0.3 * (4.4 - 0.15);
  EXPECT_NEAR(truths.back().x, 1.0 + kWay, 0.002);
  EXPECT_EQ(truths.back().x, truths[truths.size() - 50].x);

  const auto encoders = run.bus.Messages<encoders_t>(kEncoders);
  ASSERT_EQ(encoders.size(), truths.size());
  EXPECT_NEAR(
      static_cast<double>(encoders.back().left_ticks) * 1e-4, kWay, 0.002);
  EXPECT_EQ(encoders.back().left_ticks, encoders.back().right_ticks);

  const auto bases = run.bus.Messages<base_status_t>(kBase);
  EXPECT_EQ(bases.back().num_timeouts, 1);
  EXPECT_FALSE(bases.back().is_command_current);
  EXPECT_EQ(run.bus.Messages<planar_lidar_t>(kRanges).size(), 80u);
}

TEST_F(SimulatorProcessTest, TurnsLeftWhereAskedTo) {
  SimulatorOnBus run(config_);
  run.Drive(kStart + seconds(1), kStart + seconds(2), 0.0, 0.5);
  run.bus.RunUntil(kStart + seconds(4));
  EXPECT_GT(run.bus.Messages<truth_t>(kTruth).back().heading, 0.4);
}

TEST_F(SimulatorProcessTest, AWallStopsItAndIsCountedOnce) {
  SimulatorOnBus run(config_);
  run.Drive(kStart + seconds(1), kStart + seconds(15), 0.5, 0.0);
  run.bus.RunUntil(kStart + seconds(15));
  constexpr double kSkirting = 0.012;  // Thickness of the skirting board.
  EXPECT_NEAR(run.bus.Messages<truth_t>(kTruth).back().x,
              6.0 - kSkirting - config_.robot.radius,
              2e-4);
  const auto bases = run.bus.Messages<base_status_t>(kBase);
  EXPECT_EQ(bases.back().num_contacts, 1);
  EXPECT_TRUE(bases.back().is_bumper_left);
  EXPECT_TRUE(bases.back().is_bumper_right);
}

// Its camera does not pass through the top; what a planar sensor sees is the
// matter of whoever sets one.
TEST_F(SimulatorProcessTest, ATableStopsItAndIsSeen) {
  Write("table.yaml",
        "rooms: [{name: room, rectangle: [0, 0, 6, 4]}]\n"
        "furniture:\n"
        "  - {kind: table, at: [4, 2], size: [2, 3, 0.74]}\n"
        "starts: [[1, 2, 0]]\n");
  config_.world = Path("table.yaml");
  SimulatorConfig below = config_;
  below.start = {4.0, 2.3, 0.0};
  EXPECT_THAT(ErrorOf(below), HasSubstr("would touch something"));
  below.robot.height = 0.5;
  EXPECT_EQ(ErrorOf(below), "none");
  config_.ranges = RangeKind::kLidar;
  config_.range_noise = 0.0;
  const auto ahead = [&](double height) {
    config_.range_height = height;
    SimulatorOnBus run(config_);
    run.Drive(kStart, kStart + seconds(9), 0.4, 0.0);
    run.bus.RunUntil(kStart + seconds(9));
    EXPECT_EQ(run.bus.Messages<base_status_t>(kBase).back().num_contacts, 1);
    EXPECT_NEAR(run.bus.Messages<truth_t>(kTruth).back().x, 3.0 - 0.17, 0.001);
    const auto ranges = run.bus.Messages<planar_lidar_t>(kRanges);
    // From the start; the first one in whose middle nothing is lost.
    return std::min(ranges[0].ranges[180], ranges[1].ranges[180]);
  };
  EXPECT_NEAR(ahead(0.0), 2.0, 0.1);
  EXPECT_NEAR(ahead(0.3), 5.0, 0.1);  // Below the top, to the wall.
}

TEST_F(SimulatorProcessTest, CoveredLensSeesBlackOnThatPartOfTheWay) {
  config_.camera.name = "FRONT";
  config_.camera.timing.rate_hz = 10.0;
  config_.camera.covered_way = {0.2, 0.5};
  SimulatorOnBus run(config_);
  run.Drive(kStart, kStart + seconds(4), 0.25, 0.0);
  run.bus.RunUntil(kStart + seconds(4));
  // One letter an image: black or lit.
  std::string seen;
  std::string reason;
  for (const auto& message : run.bus.Messages<image_t>("IMAGE_FRONT")) {
    const auto image = ImageFromMessage(message, ImageColor::kGray, &reason);
    ASSERT_TRUE(image.has_value()) << reason;
    const bool is_black = cv::countNonZero(*image) == 0;
    if (seen.empty() || (seen.back() == 'b') != is_black) {
      seen += is_black ? 'b' : 'l';
    }
  }
  EXPECT_EQ(seen, "lbl");
}

TEST_F(SimulatorProcessTest, ImagesCarryTheirTimeAndArriveLater) {
  config_.camera.name = "FRONT";
  config_.camera.timing.rate_hz = 10.0;
  config_.camera.timing.latency_s = 0.08;
  config_.camera.has_head = true;
  SimulatorOnBus run(config_);
  run.bus.Publish(kPanTiltCommand, Look(kStart + seconds(1), 0.5, 0.0));
  run.bus.RunUntil(kStart + seconds(3));

  const auto images = run.bus.Messages<image_t>("IMAGE_FRONT");
  ASSERT_GE(images.size(), 28u);
  std::string reason;
  const auto tags = TagsFromMessage(images.back(), &reason);
  ASSERT_TRUE(tags.has_value()) << reason;
  ASSERT_TRUE(tags->head.has_value());
  EXPECT_NEAR(tags->head->pan, 0.5, 1e-9);
  const auto image = ImageFromMessage(images.back(), ImageColor::kBgr, &reason);
  ASSERT_TRUE(image.has_value()) << reason;
  EXPECT_EQ(image->size(), cv::Size(64, 48));
  EXPECT_GT(cv::mean(*image)[1], 30.0);
  for (const RawMessage& raw : run.bus.recording()) {
    if (raw.channel != "IMAGE_FRONT") continue;
    const auto sent = DecodeMessage<image_t>(raw.data);
    const double age =
        Seconds(raw.log_time - TimeFromMicroseconds(sent->utime));
    // Latency from the end of the exposure, and up to one tick of waiting.
    EXPECT_GE(age, 0.08);
    EXPECT_LE(age, 0.08 + 0.005 + 0.02);
  }
  const auto infos = run.bus.Messages<camera_info_t>("CAMERA_INFO_FRONT");
  ASSERT_EQ(infos.size(), 3u);
  const auto camera = CameraFromMessage(infos.back(), &reason);
  ASSERT_TRUE(camera.has_value()) << reason;
  EXPECT_EQ(camera->size.width, 64);
  EXPECT_TRUE(infos.back().is_pan_tilt);
}

TEST_F(SimulatorProcessTest, TwoCamerasEachWithItsOwnHead) {
  config_.camera.name = "FRONT";
  config_.camera.timing.rate_hz = 10.0;
  config_.camera.has_head = true;
  config_.second_camera = config_.camera;
  config_.second_camera.name = "BACK_2";
  config_.second_camera.timing.rate_hz = 5.0;
  config_.second_camera.head.max_pan = 0.2;
  SimulatorOnBus run(config_);
  for (const Time t : {kStart, kStart + milliseconds(500)}) {
    run.bus.Publish(kPanTiltCommand, Look(t, 0.5, 0.0));
  }
  run.bus.RunUntil(kStart + seconds(2));
  for (const auto& [name, pan, num_images] :
       {std::tuple("FRONT", 0.5, 17u), {"BACK_2", 0.2, 8u}}) {
    const auto images = run.bus.Messages<image_t>(std::string("IMAGE_") + name);
    ASSERT_GE(images.size(), num_images) << name;
    std::string reason;
    const auto tags = TagsFromMessage(images.back(), &reason);
    ASSERT_TRUE(tags && tags->head) << name << ": " << reason;
    EXPECT_NEAR(tags->head->pan, pan, 1e-9) << name;
    EXPECT_FALSE(
        run.bus.Messages<camera_info_t>(std::string("CAMERA_INFO_") + name)
            .empty());
  }
}

// How much neighbours differ along the rows, of all images while it turns.
TEST_F(SimulatorProcessTest, ImagesOfATurningRobotAreBlurredWhereAskedFor) {
  Write("box.yaml",
        "rooms:\n"
        "  - {name: room, rectangle: [0, 0, 6, 4], lamps: [1, 1]}\n"
        "furniture: [{kind: box, at: [3, 2.4], size: [0.4, 0.4, 1.5]}]\n"
        "starts: [[1, 2, 0]]\n");
  config_.world = Path("box.yaml");
  config_.camera.name = "FRONT";
  config_.camera.is_raw = true;
  config_.camera.timing.rate_hz = 5.0;
  config_.camera.timing.exposure_s = 0.1;
  config_.camera.sensor.full_well_electrons = 0.0;
  config_.camera.sensor.read_noise = 0.0;
  std::vector<double> sharpness;
  for (const int samples : {1, 12}) {
    config_.camera.blur_samples = samples;
    SimulatorOnBus run(config_);
    run.Drive(kStart, kStart + seconds(1), 0.0, 1.5);
    run.bus.RunUntil(kStart + seconds(1));
    double sum = 0.0;
    for (const auto& message : run.bus.Messages<image_t>("IMAGE_FRONT")) {
      std::string reason;
      const auto image = ImageFromMessage(message, ImageColor::kGray, &reason);
      ASSERT_TRUE(image.has_value()) << reason;
      // Steps count more than ramps of the same height.
      sum += std::pow(
          cv::norm(image->colRange(1, 64), image->colRange(0, 63), cv::NORM_L2),
          2.0);
    }
    sharpness.push_back(sum);
  }
  // 1.5 rad/s for 0.1 s at 50 px are 7 px.
  EXPECT_GT(sharpness[0], 0.0);
  EXPECT_LT(sharpness[1], 0.5 * sharpness[0]);
}

TEST_F(SimulatorProcessTest, SameSeedSameBytes) {
  config_.camera.name = "FRONT";
  config_.robot.wheel_variance = 1e-5;
  config_.camera.timing.jitter_s = 0.02;
  std::vector<std::vector<RawMessage>> recordings;
  for (const int seed : {7, 7, 8}) {
    config_.seed = seed;
    SimulatorOnBus run(config_);
    run.Drive(kStart + seconds(1), kStart + seconds(3), 0.3, 0.3);
    run.bus.RunUntil(kStart + seconds(3));
    recordings.push_back(run.bus.recording());
  }
  const auto bytes_of = [](const std::vector<RawMessage>& recording) {
    std::vector<std::vector<std::uint8_t>> bytes;
    for (const RawMessage& raw : recording) bytes.push_back(raw.data);
    return bytes;
  };
  EXPECT_TRUE(bytes_of(recordings[0]) == bytes_of(recordings[1]));
  EXPECT_FALSE(bytes_of(recordings[0]) == bytes_of(recordings[2]));
}

TEST_F(SimulatorProcessTest, GoesOnWhereItWasAndAtRest) {
  config_.state_file = Path("state.yaml");
  Pose2 X_WR;
  std::int64_t ticks = 0;
  {
    SimulatorOnBus run(config_);
    run.Drive(kStart + seconds(1), kStart + seconds(4), 0.3, 0.1);
    run.bus.RunUntil(kStart + milliseconds(3020));
    // Killed here: no Finish(). The last save is of 3.02 s.
    const truth_t last = run.bus.Messages<truth_t>(kTruth).back();
    X_WR = {last.x, last.y, last.heading};
    ticks = run.bus.Messages<encoders_t>(kEncoders).back().right_ticks;
  }
  SimulatorOnBus run(config_, kStart + seconds(10));
  run.bus.RunUntil(kStart + seconds(12));
  const auto truths = run.bus.Messages<truth_t>(kTruth);
  // The step under way may have been saved at its end: 5 ms at 0.3 m/s.
  EXPECT_NEAR(truths.front().x, X_WR.x, 0.0016);
  EXPECT_NEAR(truths.front().heading, X_WR.heading, 0.001);
  EXPECT_EQ(truths.front().x, truths.back().x);
  EXPECT_NEAR(static_cast<double>(
                  run.bus.Messages<encoders_t>(kEncoders).front().right_ticks),
              static_cast<double>(ticks),
              20.0);
  // In another world it starts where that begins.
  Write("other.yaml",
        "rooms:\n  - {name: room, rectangle: [0, 0, 6, 4]}\n"
        "starts: [[3, 3, 0]]\n");
  config_.world = Path("other.yaml");
  SimulatorOnBus other(config_);
  other.bus.RunUntil(kStart + seconds(1));
  EXPECT_EQ(other.bus.Messages<truth_t>(kTruth).front().x, 3.0);
}

// Whatever it was: an end would come again at each restart.
TEST_F(SimulatorProcessTest, WhereItCannotBeItBeginsAtTheStart) {
  config_.state_file = Path("state.yaml");
  const auto start_of = [&](const char* pose) {
    Write("state.yaml",
          fmt::format("world: {}\npose: {}\nright_ticks: 500\nutime: {}\n",
                      config_.world,
                      pose,
                      Microseconds(kStart + seconds(2))));
    SimulatorOnBus run(config_);
    run.bus.RunUntil(kStart + milliseconds(100));
    const truth_t truth = run.bus.Messages<truth_t>(kTruth).front();
    const encoders_t encoders = run.bus.Messages<encoders_t>(kEncoders).front();
    EXPECT_EQ(encoders.right_ticks, truth.x == 1.0 ? 0 : 500) << pose;
    EXPECT_GT(truth.utime, Microseconds(kStart + seconds(2)))
        << "time does not go back all the same";
    return std::pair(truth.x, truth.y);
  };
  EXPECT_EQ(start_of("[5, 3, 1]"), std::pair(5.0, 3.0));
  for (const char* pose :
       {"[0.1, 2, 0]", "[1, 50, 0]", "[1e300, 0, 0]", "[0, 0, -1e300]"}) {
    EXPECT_EQ(start_of(pose), std::pair(1.0, 2.0)) << pose;
  }
  Write("people.yaml",
        "base: room.yaml\n"
        "people:\n"
        "  - {motion: stand, at: [5, 3]}\n"
        "  - {motion: walk, path: [[3, 1], [5, 1]], start: 1}\n"
        "  - {motion: beside, bearing_deg: 0, clearance: 0.05}\n");
  config_.world = Path("people.yaml");
  const double touching = config_.robot.radius + 0.25;
  EXPECT_EQ(start_of("[5, 3.1, 1]"), std::pair(1.0, 2.0)) << "who stands";
  EXPECT_EQ(start_of("[4.2, 1.1, 0]"), std::pair(1.0, 2.0)) << "who walks";
  EXPECT_EQ(start_of("[3, 1, 0]"), std::pair(3.0, 1.0)) << "not yet there";
  const double beside = 5.0 - touching - 0.001;
  EXPECT_EQ(start_of(fmt::format("[{}, 3, 0]", beside).c_str()),
            std::pair(beside, 3.0));
}

// Where it ran into somebody, it is still there after a restart.
TEST_F(SimulatorProcessTest, GoesOnWhereItTouchedAPerson) {
  Write("person.yaml",
        "base: room.yaml\npeople: [{motion: stand, at: [2, 2]}]\n");
  config_.world = Path("person.yaml");
  config_.state_file = Path("state.yaml");
  double x = 0.0;
  {
    SimulatorOnBus run(config_);
    run.Drive(kStart, kStart + seconds(4), 0.4, 0.0);
    run.bus.RunUntil(kStart + seconds(6));
    EXPECT_EQ(run.bus.Messages<base_status_t>(kBase).back().num_contacts, 1);
    x = run.bus.Messages<truth_t>(kTruth).back().x;
  }
  SimulatorOnBus run(config_, kStart + seconds(10));
  run.bus.RunUntil(kStart + seconds(11));
  EXPECT_NEAR(run.bus.Messages<truth_t>(kTruth).back().x, x, 1e-6);
  EXPECT_NEAR(x, 2.0 - 0.25 - config_.robot.radius, 2e-4);
}

// Models alone have no walls that keep it on the floor about them.
TEST_F(SimulatorProcessTest, WhoLeavesTheFloorIsNotLockedOut) {
  Write("box.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
  Write("model.yaml",
        "models: [{file: box.obj, up: z}]\nstarts: [[0, 0, 0]]\n");
  config_.world = Path("model.yaml");
  config_.state_file = Path("state.yaml");
  {
    SimulatorOnBus run(config_);
    run.Drive(kStart, kStart + seconds(9), 0.5, 0.0);
    run.bus.RunUntil(kStart + seconds(9));
    ASSERT_GT(run.bus.Messages<truth_t>(kTruth).back().x, 4.0);
  }
  SimulatorOnBus run(config_, kStart + seconds(10));
  run.bus.RunUntil(kStart + seconds(11));
  EXPECT_EQ(run.bus.Messages<truth_t>(kTruth).front().x, 0.0);
}

TEST_F(SimulatorProcessTest, TimeAheadOfTheClockIsAFault) {
  config_.state_file = Path("state.yaml");
  const auto fault = [&](Duration ahead, double speed) {
    Write("state.yaml",
          fmt::format("world: {}\npose: [5, 3, 1]\nutime: {}\n",
                      config_.world,
                      Microseconds(kStart + ahead)));
    config_.speed = speed;
    SimulatorOnBus run(config_);
    run.bus.RunUntil(kStart + seconds(5));
    return run.bus.Status("simulator").fault;
  };
  EXPECT_THAT(fault(seconds(3600), 1.0),
              HasSubstr("time stamps are 3600 s ahead of the clock, as " +
                        config_.state_file));
  EXPECT_EQ(fault(seconds(2), 1.0), "");
  EXPECT_EQ(fault(-seconds(3600), 1.0), "");
  EXPECT_EQ(fault(seconds(3600), 2.0), "");
}

TEST_F(SimulatorProcessTest, BadInputIsOneLine) {
  SimulatorConfig config = config_;
  config.world = "nowhere";
  EXPECT_THAT(ErrorOf(config), HasSubstr("'nowhere' is neither a file nor"));
  config = config_;
  config.start = {0.1, 2.0, 0.0};
  EXPECT_THAT(ErrorOf(config), HasSubstr("would touch something at x 0.0"));
  config.start = {1000.0, 2.0, 0.0};
  EXPECT_THAT(ErrorOf(config), HasSubstr("would be outside of all rooms"));
  config = config_;
  Write("people.yaml",
        "base: room.yaml\n"
        "people:\n"
        "  - {motion: walk, path: [[3, 1], [5, 1]], start: 1}\n"
        "  - {motion: stand, at: [5, 3], name: Ann}\n");
  config.world = Path("people.yaml");
  config.start = {5.2, 2.9, 0.0};
  EXPECT_THAT(ErrorOf(config),
              AllOf(HasSubstr("people.yaml: start: a robot of radius"),
                    HasSubstr("would touch who stands at x 5.000, y 3.000"),
                    HasSubstr("people[1] (Ann)")));
  config.start = {4.1, 1.3, 0.0};
  EXPECT_THAT(ErrorOf(config),
              HasSubstr("would touch who walks at x 4.000, y 1.000"));
  config.start = {3.0, 1.3, 0.0};
  EXPECT_EQ(ErrorOf(config), "none");
  config = config_;
  config.camera.name = "FRONT";
  config.camera.file = "nothing";
  EXPECT_THAT(ErrorOf(config), HasSubstr("'nothing' is neither a file nor"));
  config = config_;
  config.state_file = Path("absent/state.yaml");
  EXPECT_THAT(ErrorOf(config), HasSubstr("cannot be written"));
  config.state_file = Path("state.yaml");
  Write("state.yaml", "world: [1]\n");
  EXPECT_THAT(ErrorOf(config), HasSubstr("state.yaml:1: world"));
  const std::string world = "world: " + config.world + "\n";
  Write("state.yaml", world + "pose: [.nan, 0, 0]\n");
  EXPECT_THAT(ErrorOf(config), HasSubstr("state.yaml:2: pose"));
  Write("state.yaml", world + "pose: [5, 3, 1]\n");
  EXPECT_EQ(ErrorOf(config), "none");
  config = config_;
  config.start = {1000.0, 2.0, 0.0};
  EXPECT_THAT(ErrorOf(config), HasSubstr("would be outside of all rooms"));
  EXPECT_EQ(ErrorOf(config_), "none");
}

TEST_F(SimulatorProcessTest, CheckOfAConfigurationFindsFilesAndNames) {
  const auto refusal = [&](const std::vector<std::string>& more) {
    const auto process = MakeProcessClass<SimulatorProcess>();
    const auto setup = process.make_setup();
    std::vector<std::string> settings = {"world=" + config_.world,
                                         "camera.file=" + Path("camera.yaml")};
    settings.insert(settings.end(), more.begin(), more.end());
    try {
      setup->Load("", settings);
      setup->CheckFiles();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(refusal({}), "none");
  EXPECT_THAT(refusal({"world=nosuch"}), HasSubstr("'nosuch' is neither"));
  EXPECT_THAT(refusal({"camera.file=nosuch"}),
              HasSubstr("'nosuch' is neither"));
  EXPECT_EQ(refusal({"camera.name=", "camera.file=nosuch"}), "none");
  EXPECT_THAT(refusal({"second_camera.name=B", "second_camera.file=nosuch"}),
              HasSubstr("'nosuch' is neither"));
  for (const char* name : {"bad/name", "foo bar", "front"}) {
    EXPECT_THAT(refusal({std::string("camera.name=") + name}),
                HasSubstr(std::string("camera.name = ") + name +
                          " must consist of A-Z, 0-9 and _"));
  }
  EXPECT_THAT(refusal({"start=[1e300, 0, 0]"}),
              HasSubstr("start: its numbers"));
}

TEST_F(SimulatorProcessTest, BadCommandsAreCountedAndNotObeyed) {
  SimulatorOnBus run(config_);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  run.bus.Publish(kMotionCommand, Velocity(kStart + seconds(1), nan, 0.0));
  run.bus.Publish(kPanTiltCommand, Look(kStart + seconds(1), 0.0, nan));
  run.bus.RunUntil(kStart + seconds(2));
  EXPECT_EQ(run.bus.Status("simulator").num_bad, 2);
  EXPECT_EQ(run.bus.Messages<truth_t>(kTruth).back().x, 1.0);
}

}  // namespace
}  // namespace waymark
