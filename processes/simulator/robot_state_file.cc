#include "processes/simulator/robot_state_file.h"

#include "estimation/base/input_error.h"
#include "processes/support/configuration.h"
#include "processes/support/state_file.h"

#include <filesystem>
#include <system_error>
#include <vector>

namespace waymark {
namespace {

struct Contents {
  std::string world;
  std::vector<double> pose;  // x m, y m, heading rad.
  double right_ticks = 0.0;
  double left_ticks = 0.0;

  void Describe(Describer& d) {
    // Farther than any robot drives; a double still counts single ticks there.
    constexpr Range kTicks{-1e15, 1e15};
    d.Text("world", &world, "World file");
    d.Numbers("pose", &pose, 3, "x m, y m, heading rad");
    d.Number("right_ticks", &right_ticks, kTicks, "Of the right wheel");
    d.Number("left_ticks", &left_ticks, kTicks, "Of the left wheel");
  }
};

}  // namespace

std::optional<RobotSnapshot> LoadRobotState(const std::string& path,
                                            const std::string& world) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  Contents contents;
  LoadConfigurationFile(path, [&](Describer& d) { contents.Describe(d); });
  if (contents.pose.empty()) {
    throw InputError(path + ": pose: 3 numbers are missing");
  }
  if (contents.world != world) return std::nullopt;
  RobotSnapshot snapshot;
  snapshot.X_WR = {contents.pose[0], contents.pose[1], contents.pose[2]};
  snapshot.right_ticks = contents.right_ticks;
  snapshot.left_ticks = contents.left_ticks;
  return snapshot;
}

void SaveRobotState(const std::string& path, const RobotState& state) {
  const Pose2& X_WR = state.snapshot.X_WR;
  Contents contents{state.world,
                    {X_WR.x, X_WR.y, X_WR.heading},
                    state.snapshot.right_ticks,
                    state.snapshot.left_ticks};
  SaveStateFile(
      path,
      "# Where the simulated robot is, saved by simulator.\n" +
          PrintConfiguration([&](Describer& d) { contents.Describe(d); }));
}

}  // namespace waymark
