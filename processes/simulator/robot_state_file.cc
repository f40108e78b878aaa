#include "processes/simulator/robot_state_file.h"

#include "estimation/base/input_error.h"
#include "processes/support/configuration.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <vector>

namespace waymark {
namespace {

constexpr std::int64_t kYear2100 = 4'102'444'800'000'000;

struct Contents {
  std::string world;
  std::vector<double> pose;  // x m, y m, heading rad.
  double right_ticks = 0.0;
  double left_ticks = 0.0;
  std::int64_t utime = 0;

  void Describe(Describer& d) {
    // Farther than any robot drives; a double still counts single ticks there.
    constexpr Range kTicks{-1e15, 1e15};
    d.Text("world", &world, "World file");
    d.Numbers("pose", &pose, 3, "x m, y m, heading rad");
    d.Number("right_ticks", &right_ticks, kTicks, "Of the right wheel");
    d.Number("left_ticks", &left_ticks, kTicks, "Of the left wheel");
    d.Integer("utime", &utime, 0, kYear2100, "No message of it is newer");
  }
};

}  // namespace

std::optional<RobotState> LoadRobotState(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  Contents contents;
  LoadConfigurationFile(path, [&](Describer& d) { contents.Describe(d); });
  if (contents.pose.empty()) {
    throw InputError(path + ": pose: 3 numbers are missing");
  }
  RobotState state;
  state.world = contents.world;
  state.snapshot.X_WR = {contents.pose[0], contents.pose[1], contents.pose[2]};
  state.snapshot.right_ticks = contents.right_ticks;
  state.snapshot.left_ticks = contents.left_ticks;
  state.time = TimeFromMicroseconds(contents.utime);
  return state;
}

std::string TextOfRobotState(const RobotState& state) {
  const Pose2& X_WR = state.snapshot.X_WR;
  Contents contents{state.world,
                    {X_WR.x, X_WR.y, X_WR.heading},
                    state.snapshot.right_ticks,
                    state.snapshot.left_ticks,
                    std::max<std::int64_t>(Microseconds(state.time), 0)};
  return "# Where the simulated robot is, saved by simulator.\n" +
         PrintConfiguration([&](Describer& d) { contents.Describe(d); });
}

}  // namespace waymark
