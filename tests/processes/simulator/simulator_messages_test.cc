#include "processes/simulator/simulator_messages.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace waymark {
namespace {

constexpr Time kTime = TimeFromMicroseconds(1'700'000'000'123'456);

TEST(SimulatorMessages, SayWhatTheEventsSay) {
  const encoders_t encoders = ToMessage(EncoderEvent{kTime, 11, -7}, 3);
  EXPECT_EQ(encoders.utime, 1'700'000'000'123'456);
  EXPECT_EQ(encoders.seq, 3);
  EXPECT_EQ(encoders.left_ticks, 11);
  EXPECT_EQ(encoders.right_ticks, -7);

  BaseEvent bumped;
  bumped.time = kTime;
  bumped.is_left_bumper_pressed = true;
  bumped.num_touches = 5;
  bumped.num_timeouts = 2;
  const base_status_t base = ToMessage(bumped, 4);
  EXPECT_EQ(base.utime, encoders.utime);
  EXPECT_EQ(base.seq, 4);
  EXPECT_TRUE(base.is_bumper_left);
  EXPECT_FALSE(base.is_bumper_right);
  EXPECT_FALSE(base.is_command_current);
  EXPECT_EQ(base.num_contacts, 5);
  EXPECT_EQ(base.num_timeouts, 2);

  const truth_t truth = ToMessage(TruthEvent{kTime, {1.0, -2.0, 0.5}}, 6);
  EXPECT_EQ(truth.utime, encoders.utime);
  EXPECT_EQ(truth.seq, 6);
  EXPECT_EQ(truth.x, 1.0);
  EXPECT_EQ(truth.y, -2.0);
  EXPECT_TRUE(truth.has_heading);
  EXPECT_EQ(truth.heading, 0.5);

  RangeSensorOptions options;
  options.first_bearing = -1.5;
  options.bearing_step = 0.25;
  const planar_lidar_t ranges =
      ToMessage(RangeEvent{kTime, {1.0f, 2.0f, 3.0f}}, options);
  EXPECT_EQ(ranges.utime, encoders.utime);
  EXPECT_EQ(ranges.nranges, 3);
  EXPECT_EQ(ranges.ranges, (std::vector<float>{1.0f, 2.0f, 3.0f}));
  EXPECT_EQ(ranges.rad0, -1.5f);
  EXPECT_EQ(ranges.radstep, 0.25f);
}

// Who answers ENCODERS has seen the rest of their time, and nothing later.
TEST(SimulatorMessages, EncodersAreTheLastOfTheirTime) {
  const Time later = kTime + Duration(20'000);
  std::vector<SimulationEvent> events{EncoderEvent{kTime},
                                      RangeEvent{kTime, {}},
                                      BaseEvent{kTime},
                                      TruthEvent{kTime, {}},
                                      EncoderEvent{later},
                                      TruthEvent{later, {}},
                                      CameraEvent{later, 0, {}, 0.0, {}},
                                      CameraEvent{later, 1, {}, 0.0, {}}};
  SortForSending(&events);
  std::string kinds;
  for (const SimulationEvent& event : events) {
    kinds += "ERBTC"[event.index()];
  }
  EXPECT_EQ(kinds, "RBTETCCE");
  EXPECT_EQ(TimeOf(events[3]), kTime);
  EXPECT_EQ(std::get<CameraEvent>(events[5]).camera, 0);
  EXPECT_EQ(std::get<CameraEvent>(events[6]).camera, 1);
}

}  // namespace
}  // namespace waymark
