// The simulator with everything else running: in lock-step, and live.
#include "estimation/base/check.h"
#include "estimation/geometry/angle.h"
#include "processes/collision_guard/collision_guard_process.h"
#include "processes/convert/world_file.h"
#include "processes/path_follower/path_follower_process.h"
#include "processes/pose_filter/pose_filter_process.h"
#include "processes/simulator/simulator_process.h"
#include "processes/support/channels.h"
#include "processes/support/configuration.h"
#include "processes/support/local_bus.h"
#include "tests/bench/bench_report.h"
#include "tests/support/child_process.h"

#include <waymark/task_t.hpp>
#include <waymark/truth_t.hpp>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace waymark {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr Time kStart = TimeFromMicroseconds(1'700'000'000'000'000);

template <typename Config>
Config Configure(const std::vector<std::string>& settings) {
  Config config;
  LoadConfiguration("", settings, &config);
  return config;
}

task_t TaskOf(const WorldRoute& route) {
  task_t task{};
  task.utime = Microseconds(kStart);
  task.source = "bench";
  task.kind = "waypoints";
  for (const Eigen::Vector2d& p : route.points) {
    waypoint_t place{};
    place.x = p.x();
    place.y = p.y();
    task.waypoints.push_back(place);
  }
  task.num_waypoints = static_cast<std::int32_t>(task.waypoints.size());
  return task;
}

// Simulated over real time of one drive along the first route of a world.
double SpeedOfLockStep(const std::string& ranges, seconds length) {
  const std::string name = "office_u";
  const World world = LoadWorldFile(FindWorldFile(name));
  const Pose2 X_WR = world.starts.front().X_WR;
  LocalBus bus(kStart);
  SimulatorProcess simulator(
      Configure<SimulatorConfig>(
          {"world=" + name, "camera.name=", "ranges.kind=" + ranges}),
      bus.AddProcess("simulator"));
  PoseFilterProcess filter(
      Configure<PoseFilterConfig>(
          {"wheels.nominal=[1e-4, 1e-4, 0.27]",
           fmt::format("start.position=[{}, {}]", X_WR.x, X_WR.y),
           fmt::format("start.heading_deg={}",
                       DegreesFromRadians(X_WR.heading))}),
      bus.AddProcess("pose_filter"));
  PathFollowerProcess follower(
      Configure<PathFollowerProcess::Config>({"task_file="}),
      bus.AddProcess("path_follower"));
  CollisionGuardProcess guard(Configure<CollisionGuardConfig>({"stop_file="}),
                              bus.AddProcess("collision_guard"));
  bus.Publish(kTask, TaskOf(world.routes.front()));
  const auto begin = Steady::now();
  bus.RunUntil(kStart + length);
  const double took_s =
      std::chrono::duration<double>(Steady::now() - begin).count();
  const auto truth = bus.Messages<truth_t>(kTruth);
  double way = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    way += std::hypot(truth[i].x - truth[i - 1].x, truth[i].y - truth[i - 1].y);
  }
  WAYMARK_CHECK(way > 5.0, way);  // A robot that stands is no load.
  return static_cast<double>(length.count()) / took_s;
}

struct LiveResult {
  double asked_hz = 0.0;
  double rate_hz = 0.0;
  int num_images = 0;
};

std::optional<LiveResult> DriveLive(const std::string& camera) {
  // Of this build, wherever it is.
  const auto build = std::filesystem::read_symlink("/proc/self/exe")
                         .parent_path()
                         .parent_path();
  ::setenv("WAYMARK_BUILD", build.c_str(), 0);
  const auto folder =
      std::filesystem::temp_directory_path() / ("waymark_bench_" + camera);
  const ChildResult demo =
      RunChild({std::string(WAYMARK_SOURCE) + "/procman/demo_drive.sh",
                "--world",
                "corridor_office",
                "--route",
                "to_office",
                "--camera",
                camera,
                "--out",
                folder.string()});
  std::filesystem::remove_all(folder);
  std::smatch found;
  const std::regex line(
      R"(camera:  ([0-9.]+) Hz of ([0-9.]+) asked for, ([0-9]+) images)");
  if (demo.exit_code != 0 || !std::regex_search(demo.out, found, line)) {
    std::fprintf(stderr, "simulator-live: %s", demo.err.c_str());
    return std::nullopt;
  }
  return LiveResult{
      std::stod(found[2]), std::stod(found[1]), std::stoi(found[3])};
}

std::vector<BenchRow> BenchLockStep(bool full) {
  std::vector<BenchRow> rows;
  const int num_runs = full ? 5 : 3;
  for (const char* ranges : {"sonar", "lidar"}) {
    std::vector<double> speeds;
    for (int i = 0; i < num_runs; ++i) {
      speeds.push_back(SpeedOfLockStep(ranges, seconds(60)));
    }
    std::nth_element(
        speeds.begin(), speeds.begin() + num_runs / 2, speeds.end());
    BenchRow row;
    row.id = "simulator-lockstep";
    row.name = std::string("drive in office_u, without vision, ") + ranges;
    row.value = speeds[static_cast<std::size_t>(num_runs / 2)];
    row.unit = "x real time";
    row.goal = ">= 3";
    row.holds = row.value >= 3.0;
    row.runs = num_runs;
    rows.push_back(row);
  }
  return rows;
}

// No rows where LCM has no network.
std::vector<BenchRow> BenchLive(bool /*full*/) {
  std::vector<BenchRow> rows;
  struct Goal {
    const char* camera;
    const char* size;
    double rate_hz;
  };
  for (const Goal& goal :
       {Goal{"perspective", "640x480", 15.0}, Goal{"mirror", "640x640", 8.0}}) {
    const auto live = DriveLive(goal.camera);
    if (!live) continue;
    BenchRow row;
    row.id = "simulator-live";
    row.name = fmt::format(
        "images of ./run demo drive, {} {}", goal.camera, goal.size);
    row.value = live->rate_hz;
    row.unit = "Hz";
    row.peer = "asked for";
    row.peer_value = live->asked_hz;
    row.ratio = live->rate_hz / live->asked_hz;
    row.goal = fmt::format(">= {:g}", goal.rate_hz);
    // One in a hundred may be left out where the goal is all of them.
    row.holds = live->rate_hz >= 0.99 * goal.rate_hz;
    row.runs = live->num_images;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace
}  // namespace waymark

int main(int argc, char** argv) {
  return waymark::RunBenches(argc,
                             argv,
                             "simulator_drives",
                             {{"simulator-lockstep",
                               "a closed loop without vision, beside real time",
                               waymark::BenchLockStep},
                              {"simulator-live",
                               "images a second of ./run demo drive, 3 min",
                               waymark::BenchLive}});
}
