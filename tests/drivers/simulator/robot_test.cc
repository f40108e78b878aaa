#include "drivers/simulator/robot.h"

#include "estimation/filter/differential_drive.h"
#include "estimation/geometry/angle.h"
#include "tests/support/rectangle_walls.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace waymark {
namespace {

const ObstacleMap& Emptiness() {
  static const ObstacleMap kMap({});
  return kMap;
}

RobotOptions Noiseless() {
  RobotOptions options;
  options.wheel_variance = 0.0;
  options.base_variance = 0.0;
  return options;
}

// Commands anew in every step of 5 ms.
void Drive(double forward,
           double turn_rate,
           double seconds,
           SimulatedRobot* robot,
           const ObstacleMap& map = Emptiness()) {
  for (int i = 0; i < std::lround(seconds / 0.005); ++i) {
    robot->Command(forward, turn_rate);
    robot->Step(0.005, map);
  }
}

// ---- odometry ---------------------------------------------------------------

TEST(Robot, SignsAreThoseOfAnyDifferentialDrive) {
  SimulatedRobot robot(Noiseless(), {}, 1);
  Drive(0.3, 0.5, 2.0, &robot);
  EXPECT_GT(robot.X_WR().x, 0.0);
  EXPECT_GT(robot.X_WR().y, 0.0);
  EXPECT_GT(robot.X_WR().heading, 0.0);
  EXPECT_GT(robot.RightTicksAt(1.0), robot.LeftTicksAt(1.0));
  EXPECT_NEAR(robot.forward_speed(), 0.3, 1e-12);
  EXPECT_NEAR(robot.turn_rate(), 0.5, 1e-12);
}

TEST(Robot, TicksAreWhatTheWheelsTurnedWhateverTheGroundMakesOfIt) {
  RobotOptions options = Noiseless();
  options.right_wheel_factor = 1.03;
  options.left_wheel_factor = 0.98;
  options.wheel_base_factor = 1.06;
  SimulatedRobot robot(options, {{}, 0.25, 1000.5}, 1);
  Drive(0.4, 0.0, 10.0, &robot);
  robot.Command(0.0, 0.0);
  for (int i = 0; i < 100; ++i) robot.Step(0.005, Emptiness());
  // 0.2 s of ramp up and down take one ramp's way off 0.4 m/s for 10 s ... and
  // give it back.
  const double way = 0.4 * 10.0;
  EXPECT_EQ(robot.RightTicksAt(1.0), std::llround(way / 1e-4));
  EXPECT_EQ(robot.LeftTicksAt(1.0), 1000 + std::llround(way / 1e-4));
  const double turn = way * (1.03 - 0.98) / (0.27 * 1.06);
  EXPECT_NEAR(robot.X_WR().heading, turn, 1e-6);
  EXPECT_NEAR(robot.way(), way * 0.5 * (1.03 + 0.98), 1e-6);
}

TEST(Robot, TicksWithinAStepGrowOneByOneAndEndAtItsEnd) {
  SimulatedRobot robot(Noiseless(), {}, 1);
  Drive(0.5, 0.8, 1.0, &robot);
  const std::int64_t before = robot.RightTicksAt(0.0);
  std::int64_t last = before;
  for (int k = 1; k <= 1000; ++k) {
    const std::int64_t ticks = robot.RightTicksAt(k / 1000.0);
    ASSERT_GE(ticks, last);
    ASSERT_LE(ticks, last + 1);
    last = ticks;
  }
  // 0.5 + 0.4 * 0.27 m/s, cut to 0.6 m/s, for 5 ms.
  EXPECT_NEAR(static_cast<double>(last - before), 0.6 * 0.005 / 1e-4, 1.0);
}

// What odometry predicts from the ticks, with the true parameters.
struct Prediction {
  Pose2 X_WR;
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();

  void Add(const WheelTicks& ticks, const RobotOptions& o) {
    const DriveStep step =
        IntegrateTicks(ticks,
                       {o.meters_per_tick * o.right_wheel_factor,
                        o.meters_per_tick * o.left_wheel_factor,
                        o.wheel_base * o.wheel_base_factor},
                       {o.wheel_variance, o.base_variance},
                       DriveIntegration::kArc);
    const ComposeJacobians j = JacobiansOfCompose(X_WR, step.X_R0R1);
    P = j.d_AB * P * j.d_AB.transpose() +
        j.d_BC * step.covariance * j.d_BC.transpose();
    X_WR = X_WR * step.X_R0R1;
  }
};

struct NoiseRuns {
  double mean_nees = 0.0;                            // Over 3.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();  // Of the errors.
};

NoiseRuns RunWithNoise(double step_s, int steps_per_reading) {
  RobotOptions options;
  options.meters_per_tick = 1e-6;  // Rounding is no part of this.
  options.right_wheel_factor = 1.02;
  options.left_wheel_factor = 0.97;
  options.wheel_base_factor = 1.05;
  options.wheel_variance = 1e-5;
  options.base_variance = 1e-6;
  constexpr int kRuns = 500;
  NoiseRuns runs;
  for (int run = 0; run < kRuns; ++run) {
    SimulatedRobot robot(options, {}, SeedFor(7, std::to_string(run)));
    Prediction prediction;
    const int num_readings =
        static_cast<int>(std::lround(8.0 / step_s)) / steps_per_reading;
    for (int i = 0; i < num_readings; ++i) {
      const WheelTicks last{static_cast<double>(robot.RightTicksAt(1.0)),
                            static_cast<double>(robot.LeftTicksAt(1.0))};
      for (int k = 0; k < steps_per_reading; ++k) {
        const double t = (i * steps_per_reading + k) * step_s;
        robot.Command(t < 4.0 ? 0.4 : -0.1, t < 4.0 ? 0.3 : 1.0);
        robot.Step(step_s, Emptiness());
      }
      prediction.Add({static_cast<double>(robot.RightTicksAt(1.0)) - last.right,
                      static_cast<double>(robot.LeftTicksAt(1.0)) - last.left},
                     options);
    }
    Eigen::Vector3d e = robot.X_WR().vector() - prediction.X_WR.vector();
    e(2) = WrapAngle(e(2));
    runs.mean_nees += e.dot(prediction.P.llt().solve(e)) / 3.0 / kRuns;
    runs.spread += e * e.transpose() / kRuns;
  }
  return runs;
}

// The 95 % band of a chi-square of 3 * 500 degrees, over 1500: 1 -+ 0.072.
// Steps and readings of other lengths draw other numbers of the same spread.
TEST(Robot, FiveHundredRunsHaveTheCovarianceThatOdometryPredicts) {
  const NoiseRuns fine = RunWithNoise(0.005, 4);
  const NoiseRuns coarse = RunWithNoise(0.1, 1);
  EXPECT_NEAR(fine.mean_nees, 1.0, 0.072);
  EXPECT_NEAR(coarse.mean_nees, 1.0, 0.072);
  for (int i = 0; i < 3; ++i) {
    // Four sigma of a variance's estimate from 500 samples, on both sides.
    EXPECT_NEAR(coarse.spread(i, i) / fine.spread(i, i),
                1.0,
                4.0 * std::sqrt(2.0 * 2.0 / 500.0))
        << i;
  }
}

TEST(Robot, SlipLosesTheWayThatItsRateSays) {
  RobotOptions options = Noiseless();
  options.slip_every = 1.0;
  options.slip_length = 0.1;
  options.slip_share = 0.6;
  SimulatedRobot robot(options, {}, 3);
  Drive(0.5, 0.0, 2000.0, &robot);
  // Half of the robot's way hangs on the wheel that slips. A cycle has 1 m
  // without and 0.1 m with slip; 900 cycles say it to 1 / sqrt(900).
  const double turned = 1e-4 * static_cast<double>(robot.RightTicksAt(1.0));
  const double lost = 1.0 - robot.way() / turned;
  const double expected = 0.5 * 0.6 * 0.1 / 1.1;
  EXPECT_NEAR(lost / expected, 1.0, 4.0 / 30.0);
}

TEST(Robot, SameSeedSameWayAndOtherSeedAnother) {
  RobotOptions options;
  options.slip_every = 0.5;
  SimulatedRobot a(options, {}, 5), b(options, {}, 5), c(options, {}, 6);
  for (SimulatedRobot* robot : {&a, &b, &c}) Drive(0.3, 0.2, 5.0, robot);
  EXPECT_EQ(a.X_WR(), b.X_WR());
  EXPECT_NE(a.X_WR(), c.X_WR());
}

// ---- limits -----------------------------------------------------------------

TEST(Robot, WheelsKeepTheirSpeedAndAccelerationForAnyCommand) {
  Random random(SeedFor(1, "limits"));
  const RobotOptions options = Noiseless();
  SimulatedRobot robot(options, {}, 1);
  double last_right = 0.0;
  double last_left = 0.0;
  for (int i = 0; i < 20000; ++i) {
    if (i % 37 == 0) {
      robot.Command(random.Uniform(-3.0, 3.0), random.Uniform(-9.0, 9.0));
    }
    const double dt = random.Uniform(0.001, 0.02);
    robot.Step(dt, Emptiness());
    const double half = 0.5 * robot.turn_rate() * options.wheel_base;
    const double right = robot.forward_speed() + half;
    const double left = robot.forward_speed() - half;
    const double most = options.max_wheel_acceleration * dt + 1e-12;
    ASSERT_LE(std::abs(right), options.max_wheel_speed + 1e-12);
    ASSERT_LE(std::abs(left), options.max_wheel_speed + 1e-12);
    ASSERT_LE(std::abs(right - last_right), most);
    ASSERT_LE(std::abs(left - last_left), most);
    last_right = right;
    last_left = left;
  }
}

TEST(Robot, TooFastACommandKeepsItsCurve) {
  SimulatedRobot robot(Noiseless(), {}, 1);
  Drive(2.0, 1.0, 1.0, &robot);
  EXPECT_NEAR(robot.forward_speed() / robot.turn_rate(), 2.0, 1e-9);
  EXPECT_NEAR(robot.forward_speed() + 0.135 * robot.turn_rate(), 0.6, 1e-12);
}

TEST(Robot, StandsWhenItsLastCommandIsTooOld) {
  for (const double speed : {0.1, 0.6}) {
    SimulatedRobot robot(Noiseless(), {}, 1);
    EXPECT_FALSE(robot.is_command_current());
    Drive(speed, 0.0, 2.0, &robot);
    EXPECT_TRUE(robot.is_command_current());
    // 5 ms of the time-out have gone already.
    for (int i = 0; i < 99; ++i) robot.Step(0.005, Emptiness());
    EXPECT_NEAR(robot.forward_speed(), 0.0, 1e-9);
    robot.Step(0.005, Emptiness());
    EXPECT_FALSE(robot.is_command_current());
    EXPECT_EQ(robot.num_timeouts(), 1);
    const Pose2 rest = robot.X_WR();
    for (int i = 0; i < 100; ++i) robot.Step(0.005, Emptiness());
    EXPECT_EQ(robot.X_WR(), rest);
    EXPECT_EQ(robot.num_timeouts(), 1);
    Drive(speed, 0.0, 0.5, &robot);
    EXPECT_NEAR(robot.forward_speed(), speed, 1e-9);
  }
}

TEST(Robot, OptionsOutOfRangeAreNamed) {
  RobotOptions options;
  options.wheel_base = 0.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.max_wheel_speed = 1.1;  // Not to be braked from in 0.5 s at 2 m/s^2.
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.slip_share = std::nan("");
  EXPECT_THROW(SimulatedRobot(options, {}, 1), std::invalid_argument);
}

// ---- contact ----------------------------------------------------------------

TEST(Robot, StopsAtAWallOnceAndBacksOff) {
  const ObstacleMap wall({{{1.0, -2.0}, {1.0, 2.0}}});
  for (const BlockedWheels wheels :
       {BlockedWheels::kStall, BlockedWheels::kSpin}) {
    RobotOptions options = Noiseless();
    options.blocked_wheels = wheels;
    options.holds_at_bumper = false;
    SimulatedRobot robot(options, {}, 1);
    Drive(0.5, 0.0, 5.0, &robot, wall);
    const double reach = 1.0 - options.radius - SimulatedRobot::kSkin;
    EXPECT_NEAR(robot.X_WR().x, reach, 1e-9);
    EXPECT_EQ(robot.num_touches(), 1);
    EXPECT_TRUE(robot.is_touching());
    const double turned = 1e-4 * static_cast<double>(robot.LeftTicksAt(1.0));
    if (wheels == BlockedWheels::kStall) {
      EXPECT_NEAR(turned, reach, 1e-3);
    } else {
      EXPECT_GT(turned, 2.0);
    }
    // Turning on the spot is free and parts nothing.
    Drive(0.0, 1.0, 1.5, &robot, wall);
    EXPECT_NEAR(robot.X_WR().heading, 1.25, 0.25);
    Drive(0.0, -1.0, 1.5, &robot, wall);
    Drive(0.5, 0.0, 0.5, &robot, wall);
    EXPECT_EQ(robot.num_touches(), 1);
    Drive(-0.3, 0.0, 1.0, &robot, wall);
    EXPECT_LT(robot.X_WR().x, reach - 0.15);
    EXPECT_FALSE(robot.is_touching());
    Drive(0.5, 0.0, 2.0, &robot, wall);
    EXPECT_EQ(robot.num_touches(), 2);
  }
}

// As a base with bumpers: wheels/differential_base.h.
TEST(Robot, OnceBumpedGoesForwardOnlyAfterItWasToldNotTo) {
  std::vector<Segment2> walls{{{1.0, -2.0}, {1.0, 2.0}}};
  const ObstacleMap wall(walls);
  SimulatedRobot robot(Noiseless(), {}, 1);
  Drive(0.5, 0.0, 3.0, &robot, wall);
  EXPECT_TRUE(robot.is_held());
  // The wall goes: whoever goes on asking stands all the same.
  const Pose2 rest = robot.X_WR();
  Drive(0.5, 0.0, 1.0, &robot);
  EXPECT_EQ(robot.X_WR(), rest);
  EXPECT_FALSE(robot.is_left_bumper_pressed());
  EXPECT_TRUE(robot.is_held());
  Drive(0.0, 0.0, 0.005, &robot);
  EXPECT_FALSE(robot.is_held());
  Drive(0.5, 0.0, 1.0, &robot);
  EXPECT_GT(robot.X_WR().x, rest.x + 0.3);
  // Backing off serves as well; standing before the wall does not.
  SimulatedRobot other(Noiseless(), {}, 1);
  Drive(0.5, 0.0, 3.0, &other, wall);
  Drive(0.0, 0.0, 1.0, &other, wall);
  EXPECT_TRUE(other.is_held());
  Drive(-0.3, 0.0, 1.0, &other, wall);
  EXPECT_FALSE(other.is_held());
  Drive(0.5, 0.0, 3.0, &other, wall);
  EXPECT_EQ(other.num_touches(), 2);
}

TEST(Robot, BumperSaysWhichSide) {
  const ObstacleMap wall({{{1.0, -9.0}, {1.0, 9.0}}});
  const auto bump = [&](double heading, double speed) {
    SimulatedRobot robot(Noiseless(), {{0.5, 0.0, heading}, 0, 0}, 1);
    Drive(speed, 0.0, 4.0, &robot, wall);
    EXPECT_EQ(robot.num_touches(), 1);
    return std::pair(robot.is_left_bumper_pressed(),
                     robot.is_right_bumper_pressed());
  };
  // Turned right of the wall's normal, the wall is to the left.
  EXPECT_EQ(bump(-0.7, 0.3), std::pair(true, false));
  EXPECT_EQ(bump(0.7, 0.3), std::pair(false, true));
  EXPECT_EQ(bump(0.0, 0.3), std::pair(true, true));
  EXPECT_EQ(bump(3.0, -0.3), std::pair(false, false));  // Behind.
}

TEST(Robot, APersonWhoWalksIntoItTouchesAndDoesNotHoldIt) {
  SimulatedRobot robot(Noiseless(), {}, 1);
  for (int i = 0; i < 400; ++i) {
    // Comes from ahead, stays 5 cm inside, goes.
    const double x = i < 200 ? 0.6 - 0.00115 * i : 0.37 + 0.002 * (i - 200);
    const Disc2 person{{x, 0.0}, 0.25};
    robot.Step(0.005, Emptiness(), {&person, 1});
    if (i == 190) {
      EXPECT_TRUE(robot.is_touching());
    }
  }
  EXPECT_EQ(robot.num_touches(), 1);
  EXPECT_FALSE(robot.is_touching());
  EXPECT_EQ(robot.X_WR(), Pose2());

  const Disc2 person{{0.4, 0.0}, 0.25};
  for (int i = 0; i < 200; ++i) {
    robot.Command(-0.3, 0.0);
    robot.Step(0.005, Emptiness(), {&person, 1});
  }
  EXPECT_LT(robot.X_WR().x, -0.2);
  EXPECT_EQ(robot.num_touches(), 2);
}

double GapTo(const ObstacleMap& map, const Eigen::Vector2d& p) {
  const auto nearest = map.Nearest(p, 100.0);
  return nearest ? nearest->distance : 100.0;
}

// A closed room with things in it.
ObstacleMap RandomRoom(Random* random) {
  const double w = random->Uniform(1.5, 4.0);
  const double h = random->Uniform(1.5, 4.0);
  std::vector<Segment2> walls = RectangleWalls({-w, -h}, {w, h});
  for (std::uint64_t i = random->Index(8); i > 0; --i) {
    const Eigen::Vector2d a(random->Uniform(-w, w), random->Uniform(-h, h));
    const double angle = random->Uniform(-kPi, kPi);
    const double length = random->Uniform(0.02, 1.5);
    walls.push_back(
        {a, a + length * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  return ObstacleMap(walls);
}

// Full speed into whatever comes, in steps from 5 ms to 0.4 s at up to 18 m/s.
TEST(Robot, NeverPassesThroughAnythingInAThousandWorlds) {
  for (int world = 0; world < 1000; ++world) {
    Random random(SeedFor(11, std::to_string(world)));
    const ObstacleMap map = RandomRoom(&random);
    RobotOptions options;
    options.max_wheel_speed = world % 2 == 0 ? 0.6 : 20.0;
    options.max_wheel_acceleration = world % 2 == 0 ? 2.0 : 100.0;
    options.blocked_wheels =
        world % 3 == 0 ? BlockedWheels::kSpin : BlockedWheels::kStall;
    const double step_s = std::pow(10.0, random.Uniform(-2.3, -0.4));
    Pose2 start;
    do {
      start = {random.Uniform(-1.4, 1.4),
               random.Uniform(-1.4, 1.4),
               random.Uniform(-kPi, kPi)};
    } while (GapTo(map, start.position()) < options.radius + 0.001);
    SimulatedRobot robot(options, {start, 0.0, 0.0}, random.Bits());
    const double speed = random.Uniform(0.5, 0.9) * options.max_wheel_speed;
    const double bend = random.Uniform(-0.2, 0.2);
    const auto num_steps = std::lround(std::max(5.0, 9.0 / (speed * step_s)));
    const int num_looks = step_s * speed > 0.1 ? 30 : 1;
    for (std::int64_t i = 0; i < num_steps; ++i) {
      robot.Command(speed, bend * speed);
      robot.Step(step_s, map);
      // The robot has no gap to slip through between two looks.
      for (int k = 1; k <= num_looks; ++k) {
        const Pose2 at = robot.PoseAt(1.0 * k / num_looks);
        ASSERT_GT(GapTo(map, at.position()), options.radius) << world;
      }
    }
    // Twice as far as the farthest wall.
    ASSERT_GT(robot.num_touches(), 0) << world;
    EXPECT_TRUE(robot.is_touching()) << world;
    EXPECT_LE(robot.num_touches(), 3) << world;
    const Pose2 rest = robot.X_WR();
    robot.Command(speed, bend * speed);
    robot.Step(step_s, map);
    // Noise may turn the way along the wall, a little.
    EXPECT_LT((robot.X_WR().position() - rest.position()).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace waymark
