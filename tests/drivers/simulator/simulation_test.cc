#include "drivers/simulator/simulation.h"

#include "tests/support/rectangle_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

const ObstacleMap& Room() {
  static const ObstacleMap kRoom(RectangleWalls({-3.0, -2.0}, {3.0, 2.0}));
  return kRoom;
}

// One who walks to and fro, and one who goes along with the robot.
std::vector<Pose2> Walkers(double seconds,
                           const Pose2& X_WR,
                           std::span<const PersonState> states) {
  const double walked = seconds - (states.empty() ? 0.0 : states[0].waited_s);
  return {{2.0 * std::sin(walked), 1.5, 0.0}, X_WR * Pose2{0.0, -0.6, 0.0}};
}

// The first one does while the robot's heading is in [0.2, 0.4).
void WaitNowAndThen(double /*seconds*/,
                    double dt,
                    const Pose2& X_WR,
                    std::vector<PersonState>* states) {
  states->resize(2);
  if (X_WR.heading >= 0.2 && X_WR.heading < 0.4) (*states)[0].waited_s += dt;
}

SimulationWorld RoomOf(bool has_people) {
  SimulationWorld world;
  world.map = &Room();
  if (has_people) {
    world.people = Walkers;
    world.meet = WaitNowAndThen;
  }
  return world;
}

SimulationOptions Everything() {
  SimulationOptions options;
  options.robot.slip_every = 0.5;
  options.ranges = RangeSensorOptions::SonarRing();
  SimulatedCamera front{"front", {}, 1, {}};
  front.timing.jitter_s = 0.01;
  front.timing.drop_share = 0.2;
  SimulatedCamera blurred{"blurred", {}, 3, {}};
  blurred.timing.rate_hz = 7.0;
  options.cameras = {front, blurred};
  options.start_time = kStart;
  options.seed = 42;
  return options;
}

// Everything that an event says, digit by digit.
std::string TextOf(const SimulationEvent& event) {
  std::string text = std::to_string(event.index()) + "@" +
                     std::to_string(Microseconds(TimeOf(event)));
  const auto add = [&](double value) {
    char digits[32];
    std::snprintf(digits, sizeof(digits), " %a", value);
    text += digits;
  };
  const auto add_pose = [&](const Pose2& X) {
    for (const double value : {X.x, X.y, X.heading}) add(value);
  };
  if (const auto* encoders = std::get_if<EncoderEvent>(&event)) {
    add(static_cast<double>(encoders->left_ticks));
    add(static_cast<double>(encoders->right_ticks));
  } else if (const auto* ranges = std::get_if<RangeEvent>(&event)) {
    for (const float range : ranges->ranges) add(range);
  } else if (const auto* base = std::get_if<BaseEvent>(&event)) {
    add(static_cast<double>(base->num_touches));
    add(base->is_left_bumper_pressed ? 1.0 : 0.0);
  } else if (const auto* truth = std::get_if<TruthEvent>(&event)) {
    add_pose(truth->X_WR);
  } else if (const auto* camera = std::get_if<CameraEvent>(&event)) {
    add(static_cast<double>(Microseconds(camera->frame.arrival)));
    for (const ExposurePose& pose : camera->poses) {
      add_pose(pose.X_WR);
      add(pose.head.pan);
      for (const Pose2& person : pose.X_WP) add_pose(person);
    }
  }
  return text;
}

// Drives for 8 s with a new command every 70 ms, in slices of up to
// `longest_s` besides.
std::vector<std::string> DriveTexts(const SimulationOptions& options,
                                    double longest_s) {
  Simulation simulation(options, RoomOf(true), {});
  Random commands(5);
  Random slices(6);
  std::vector<std::string> texts;
  const auto advance = [&](Time end) {
    for (const SimulationEvent& event : simulation.AdvanceTo(end)) {
      texts.push_back(TextOf(event));
    }
  };
  for (int i = 0; i < 114; ++i) {
    simulation.Command(commands.Uniform(-0.2, 0.6), commands.Uniform(-2, 2));
    if (i % 10 == 0) simulation.CommandHead({commands.Uniform(-1, 1), 0.1});
    const Time next = kStart + Duration(70000) * (i + 1);
    while (longest_s > 0.0) {
      const Time slice =
          simulation.now() + DurationFromSeconds(slices.Uniform(0, longest_s));
      if (slice >= next) break;
      advance(slice);
    }
    advance(next);
  }
  return texts;
}

TEST(Simulation, HowTimeIsCutChangesNothing) {
  const auto whole = DriveTexts(Everything(), 0.0);
  EXPECT_GT(whole.size(), 1000u);
  EXPECT_EQ(DriveTexts(Everything(), 0.0), whole);
  EXPECT_EQ(DriveTexts(Everything(), 0.02), whole);
  EXPECT_EQ(DriveTexts(Everything(), 0.001), whole);
}

std::vector<std::string> OfKind(const std::vector<std::string>& texts,
                                char kind) {
  std::vector<std::string> some;
  for (const std::string& text : texts) {
    if (text[0] == kind) some.push_back(text);
  }
  return some;
}

TEST(Simulation, ASensorMoreChangesNoOthersNoise) {
  const auto all = DriveTexts(Everything(), 0.0);
  SimulationOptions fewer = Everything();
  fewer.ranges.reset();
  fewer.cameras.clear();
  const auto few = DriveTexts(fewer, 0.0);
  EXPECT_EQ(OfKind(few, '0'), OfKind(all, '0'));  // Encoders.
  EXPECT_EQ(OfKind(few, '3'), OfKind(all, '3'));  // Truth.
  SimulationOptions other = Everything();
  other.seed = 43;
  EXPECT_NE(OfKind(DriveTexts(other, 0.0), '3'), OfKind(all, '3'));
}

TEST(Simulation, EventsComeInOrderAtTheirRates) {
  Simulation simulation(Everything(), RoomOf(true), {});
  const auto events = simulation.AdvanceTo(kStart + Duration(2'000'000));
  std::vector<int> counts(5, 0);
  Time last = kStart;
  std::size_t last_kind = 0;
  for (const SimulationEvent& event : events) {
    const Time t = TimeOf(event);
    ASSERT_GE(t, last);
    if (t == last) {
      ASSERT_GE(event.index(), last_kind);
    }
    last = t;
    last_kind = event.index();
    ++counts[event.index()];
  }
  EXPECT_EQ(counts[0], 101);  // Both ends.
  EXPECT_EQ(counts[1], 21);
  EXPECT_EQ(counts[2], 21);
  EXPECT_EQ(counts[3], 101);
  EXPECT_GT(simulation.NextTime(), simulation.now());
  EXPECT_THROW((void)simulation.AdvanceTo(kStart), std::logic_error);
}

TEST(Simulation, LockStepByNextTimeSeesOneInstantAtATime) {
  Simulation simulation(Everything(), RoomOf(false), {});
  for (int i = 0; i < 500; ++i) {
    const Time next = simulation.NextTime();
    for (const SimulationEvent& event : simulation.AdvanceTo(next)) {
      ASSERT_EQ(TimeOf(event), next);
      if (const auto* truth = std::get_if<TruthEvent>(&event)) {
        ASSERT_EQ(truth->X_WR, simulation.X_WR());
      }
    }
    simulation.Command(0.3, 0.1);
  }
}

TEST(Simulation, ExposuresHaveThePosesOfTheirTimes) {
  SimulationOptions options = Everything();
  options.truth_rate_hz = 1000.0;
  Simulation simulation(options, RoomOf(true), {});
  simulation.Command(0.3, 0.4);
  simulation.CommandHead({1.0, 0.0});
  std::vector<TruthEvent> truth;
  int num_blurred = 0;
  for (int i = 0; i < 10; ++i) {
    simulation.Command(0.3, 0.4);
    const Time end = simulation.now() + Duration(100000);
    for (const SimulationEvent& event : simulation.AdvanceTo(end)) {
      if (const auto* t = std::get_if<TruthEvent>(&event)) truth.push_back(*t);
      const auto* camera = std::get_if<CameraEvent>(&event);
      if (camera == nullptr || camera->camera != 1) continue;
      ++num_blurred;
      ASSERT_EQ(camera->poses.size(), 3u);
      EXPECT_EQ(camera->poses[1].time, camera->frame.stamp);
      EXPECT_EQ(camera->time, camera->frame.exposure_end);
      for (const ExposurePose& pose : camera->poses) {
        const double age = Seconds(pose.time - kStart);
        EXPECT_NEAR(pose.head.pan, std::min(1.0, 1.5 * age), 1e-9);
        // Who waits falls behind.
        if (pose.X_WR.heading < 0.19) {
          EXPECT_NEAR(pose.X_WP[0].x, 2.0 * std::sin(age), 1e-9);
        }
        // The truth of the millisecond before, at up to 0.3 m/s.
        const auto i_truth = static_cast<std::size_t>(age * 1000.0);
        EXPECT_NEAR(
            (truth[i_truth].X_WR.position() - pose.X_WR.position()).norm(),
            0.0,
            0.0004);
      }
    }
  }
  EXPECT_GE(num_blurred, 7);
}

TEST(Simulation, EachCameraHasAHeadOfItsOwn) {
  SimulationOptions options = Everything();
  options.cameras[0].head.max_pan = 0.2;
  options.cameras[1].head.max_rate = 0.5;
  Simulation simulation(options, RoomOf(false), {});
  simulation.CommandHead({1.0, 0.0});
  int num_images[2] = {};
  for (const SimulationEvent& event :
       simulation.AdvanceTo(kStart + Duration(1'500'000))) {
    const auto* camera = std::get_if<CameraEvent>(&event);
    if (camera == nullptr) continue;
    ++num_images[camera->camera];
    const ExposurePose& pose = camera->poses.front();
    const double age = Seconds(pose.time - kStart);
    EXPECT_NEAR(pose.head.pan,
                camera->camera == 0 ? std::min(0.2, 1.5 * age) : 0.5 * age,
                1e-9);
  }
  EXPECT_GT(num_images[0], 5);
  EXPECT_GT(num_images[1], 5);
}

TEST(Simulation, GoesOnFromWhereItWasAtRest) {
  SimulationOptions options = Everything();
  Simulation before(options, RoomOf(false), {});
  before.Command(0.4, 0.3);
  (void)before.AdvanceTo(kStart + Duration(400000));
  const RobotSnapshot snapshot = before.Snapshot();
  options.start_time = kStart + Duration(9'000'000);
  Simulation after(options, RoomOf(false), snapshot);
  const auto first = after.AdvanceTo(options.start_time);
  const auto& encoders = std::get<EncoderEvent>(first.front());
  EXPECT_EQ(encoders.left_ticks, before.robot().LeftTicksAt(1.0));
  (void)after.AdvanceTo(options.start_time + Duration(1'000'000));
  EXPECT_EQ(after.X_WR(), snapshot.X_WR);
}

TEST(Simulation, PeopleWhoWalkIntoTheRobotAreTouches) {
  SimulationOptions options = Everything();
  SimulationWorld world = RoomOf(false);
  world.people =
      [](double seconds, const Pose2&, std::span<const PersonState>) {
        return std::vector<Pose2>{{1.0 - seconds, 0.0, 0.0}};
      };
  Simulation simulation(options, world, {});
  (void)simulation.AdvanceTo(kStart + Duration(2'000'000));
  EXPECT_EQ(simulation.robot().num_touches(), 1);
}

TEST(Simulation, OptionsOutOfRangeAreNamed) {
  SimulationOptions options = Everything();
  options.step_s = 1.0;
  EXPECT_THROW(Simulation(options, RoomOf(false), {}), std::invalid_argument);
  options = Everything();
  options.cameras[1].name = "front";
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace waymark
