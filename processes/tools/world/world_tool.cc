#include "processes/tools/world/world_tool.h"

#include "drivers/simulator/build_scene.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/scene_edges.h"
#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "estimation/geometry/pose3.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/world_file.h"
#include "processes/support/output_file.h"
#include "processes/support/progress.h"
#include "processes/support/run_tool.h"
#include "processes/tools/world/plan_drawing.h"
#include "processes/tools/world/plan_paths.h"
#include "processes/tools/world/world_check.h"
#include "processes/tools/world/world_pictures.h"

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace waymark {
namespace {

struct Request {
  std::string world;
  std::vector<std::string> worlds;
  std::vector<double> pose;
  std::string camera = "perspective";
  std::string quality = "still";
  std::string out;
  std::string depth;
  std::string surfaces;
  std::string edges;
  std::string log;
  double seconds = 0.0;
  int pixels = 1200;
  int threads = 1;
  bool force = false;
  bool is_verbose = false;

  [[nodiscard]] IfExists if_exists() const {
    return force ? IfExists::kReplace : IfExists::kFail;
  }
};

Pose2 PoseOf(const Request& request, const World& world) {
  if (request.pose.empty()) {
    return world.starts.empty() ? Pose2{} : world.starts[0].X_WR;
  }
  return {request.pose[0],
          request.pose[1],
          request.pose[2] * std::numbers::pi / 180.0};
}

// No output may overwrite another one.
void CheckDifferent(const Request& request) {
  const std::array<std::pair<const char*, const std::string*>, 4> outputs{{
      {"--out", &request.out},
      {"--depth", &request.depth},
      {"--surfaces", &request.surfaces},
      {"--edges", &request.edges},
  }};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].second->empty()) continue;
    // Neither need be there yet.
    const auto path = std::filesystem::weakly_canonical(*outputs[i].second);
    for (std::size_t k = 0; k < i; ++k) {
      if (outputs[k].second->empty() ||
          path != std::filesystem::weakly_canonical(*outputs[k].second)) {
        continue;
      }
      throw InputError(std::string(outputs[i].first) + " " +
                       *outputs[i].second + ": is that of " + outputs[k].first +
                       " too");
    }
  }
}

void Render(const Request& request) {
  CheckImageOutput(request.out, "--out", false, request.if_exists());
  CheckImageOutput(request.depth, "--depth", true, request.if_exists());
  CheckImageOutput(request.surfaces, "--surfaces", true, request.if_exists());
  CheckImageOutput(request.edges, "--edges", false, request.if_exists());
  CheckDifferent(request);
  const CameraDescription camera =
      LoadCameraFile(FindCameraFile(request.camera));
  const World world = LoadWorldFile(FindWorldFile(request.world));
  const Scene scene = BuildScene(world);
  const Pose2 X_WR = PoseOf(request, world);
  std::vector<Eigen::Isometry3d> X_WP;
  for (const Pose2& pose : People(world, {}).PosesAt(request.seconds, X_WR)) {
    X_WP.push_back(SpatialPose(pose));
  }
  RenderOptions options;
  options.quality =
      request.quality == "live" ? RenderQuality::kLive : RenderQuality::kStill;
  options.depth = !request.depth.empty();
  options.surface = !request.surfaces.empty();
  RendererOptions renderer_options;
  renderer_options.num_threads = request.threads;
  const Renderer renderer(scene, renderer_options);
  const CameraView camera_view{camera.model, camera.size};
  const Eigen::Isometry3d X_WC = SpatialPose(X_WR) * camera.X_RC;
  const RenderedView view = renderer.Render(camera_view, X_WC, X_WP, options);
  WriteImage(request.out, view.image, request.if_exists());
  if (options.depth) {
    WriteImage(request.depth, DepthImage(view.depth), request.if_exists());
  }
  if (options.surface) {
    WriteImage(
        request.surfaces, SurfaceImage(view.surface), request.if_exists());
  }
  if (!request.edges.empty()) {
    const auto edges =
        SceneEdges(scene).Find(renderer.caster(), camera_view, X_WC, X_WP);
    WriteImage(
        request.edges, EdgeImage(view.image, edges), request.if_exists());
  }
}

std::string Degrees(double heading) {
  return ShortestNumber(std::round(1e6 * DegreesFromRadians(heading)) / 1e6);
}

// The name is one word.
void PrintPose(const char* kind, const std::string& name, const Pose2& X_WR) {
  fmt::print("{} {} {},{},{}\n",
             kind,
             name,
             ShortestNumber(X_WR.x),
             ShortestNumber(X_WR.y),
             Degrees(X_WR.heading));
}

void Info(const Request& request) {
  const World world = LoadWorldFile(FindWorldFile(request.world));
  for (std::size_t i = 0; i < world.starts.size(); ++i) {
    PrintPose("start", std::to_string(i), world.starts[i].X_WR);
  }
  for (const WorldPose& place : world.places) {
    PrintPose("place", place.name, place.X_WR);
  }
  for (const WorldRoute& route : world.routes) {
    fmt::print("route {}", route.name);
    for (const Eigen::Vector2d& p : route.points) {
      fmt::print(" {},{}", ShortestNumber(p.x()), ShortestNumber(p.y()));
    }
    fmt::print("\n");
  }
}

// The first sentence of the comment that a world file begins with.
std::string DescriptionOf(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line) && line.starts_with('#');) {
    const std::size_t begin = line.find_first_not_of("# ");
    if (begin == std::string::npos) break;
    text += (text.empty() ? "" : " ") + line.substr(begin);
  }
  const std::size_t end = text.find(". ");
  return end == std::string::npos ? text : text.substr(0, end + 1);
}

void List() {
  for (const std::string& name : WorldNames()) {
    const std::string path = FindWorldFile(name);
    Eigen::AlignedBox2d box;
    try {
      const World world = LoadWorldFile(path);
      for (const WorldRoom& room : world.rooms) {
        for (const Eigen::Vector2d& p : room.outline) box.extend(p);
      }
    } catch (const InputError&) {
      // Its model is not here; the others are.
    }
    const std::string size = box.isEmpty() ? std::string("-")
                                           : fmt::format("{:.0f} x {:.0f} m",
                                                         box.sizes().x(),
                                                         box.sizes().y());
    fmt::print("{:<20} {:<10} {}\n", name, size, DescriptionOf(path));
  }
}

void Plan(const Request& request) {
  CheckImageOutput(request.out, "--out", false, request.if_exists());
  const World world = LoadWorldFile(FindWorldFile(request.world));
  PlanOptions options;
  options.pixels = request.pixels;
  options.seconds = request.seconds;
  if (!request.log.empty()) options.paths = PathsOf(request.log);
  WriteImage(request.out,
             DrawPlan(world, BuildScene(world), options),
             request.if_exists());
}

// One line for each start and place; returns whether all is well.
bool CheckOne(const Request& request,
              const std::string& path,
              const std::vector<NamedCamera>& cameras) {
  const World world = LoadWorldFile(path);
  const Scene scene = BuildScene(world);
  fmt::print("{}: {} rooms, {} triangles, {} materials, {} people\n",
             path,
             world.rooms.size(),
             scene.mesh.triangles.size(),
             scene.materials.size(),
             world.people.size());
  WorldCheckOptions options;
  options.num_threads = request.threads;
  const std::vector<std::string> faults = CheckObjects(world, scene, options);
  for (const std::string& fault : faults) fmt::print("  BAD: {}\n", fault);
  int bad = 0;
  for (const ViewCheck& check : CheckViews(world, scene, cameras, options)) {
    if (!check.IsGood()) ++bad;
    if (check.IsGood() && !request.is_verbose) continue;
    fmt::print(
        "  {}: {}: mean grey {:.0f}, {:.1f} % at 0, {:.1f} % at 255, "
        "{:.2f} grey a millimetre\n",
        check.IsGood() ? "good" : "BAD",
        check.name,
        check.exposure.mean,
        100.0 * check.exposure.black_share,
        100.0 * check.exposure.burnt_share,
        check.change);
  }
  if (bad > 0) fmt::print("  {} views bad\n", bad);
  if (bad > 0 || !faults.empty()) return false;
  fmt::print("  good\n");
  return true;
}

void Check(const Request& request, int* exit_code) {
  std::vector<NamedCamera> cameras;
  for (const char* name : {"perspective", "mirror"}) {
    cameras.push_back({name, LoadCameraFile(FindCameraFile(name))});
  }
  std::vector<std::string> paths;
  for (const std::string& world : request.worlds) {
    paths.push_back(FindWorldFile(world));
  }
  for (const std::string& path : paths) {
    if (!CheckOne(request, path, cameras)) *exit_code = 1;
  }
}

void AddThreads(CLI::App* command, Request* request) {
  command
      ->add_option("--threads",
                   request->threads,
                   "Of the renderer; images do not depend on it")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
}

void AddOutput(CLI::App* command, Request* request) {
  command->add_option("WORLD", request->world, "Name or file")->required();
  command->add_option("--out", request->out, "Picture, .png or .jpg")
      ->required();
  RequireRange(command->add_option(
                   "--seconds", request->seconds, "When: of people who walk"),
               0.0,
               1e6);
  command->add_flag("-f,--force", request->force, "Replace outputs that exist");
}

void AddRender(CLI::App* app, Request* request) {
  CLI::App* command =
      app->add_subcommand("render", "A picture from any pose and camera");
  AddOutput(command, request);
  command
      ->add_option("--pose",
                   request->pose,
                   "X,Y,HEADING of the robot in m and degrees; default: the "
                   "world's first start")
      ->delimiter(',')
      ->expected(3)
      ->check(CLI::Range(-1000.0, 1000.0));
  command
      ->add_option("--camera",
                   request->camera,
                   "perspective, fisheye, mirror, panorama or a camera file")
      ->capture_default_str();
  command->add_option("--quality", request->quality, "live or still")
      ->check(CLI::IsMember({"live", "still"}))
      ->capture_default_str();
  command->add_option(
      "--depth", request->depth, "Distances too: .png of 16 bits, in mm");
  command->add_option(
      "--surfaces", request->surfaces, "Surfaces too: .png, a colour for each");
  command->add_option("--edges",
                      request->edges,
                      "The visible edges over the picture too, .png or .jpg");
  AddThreads(command, request);
  command->callback([request] { Render(*request); });
}

void AddPlan(CLI::App* app, Request* request) {
  CLI::App* command = app->add_subcommand("plan", "The plan as a picture");
  AddOutput(command, request);
  command->add_option("--pixels", request->pixels, "Of the longer side")
      ->check(CLI::Range(200, 8000))
      ->capture_default_str();
  command->add_option("--log",
                      request->log,
                      "Draw the paths of this LCM log too: TRUTH (green), "
                      "ODOMETRY (orange), POSE (blue)");
  command->callback([request] { Plan(*request); });
}

void AddInfo(CLI::App* app, Request* request) {
  CLI::App* command = app->add_subcommand(
      "info",
      "Starts, places and routes, one a line: poses as x,y,heading in m and "
      "degrees, way-points as x,y");
  command->add_option("WORLD", request->world, "Name or file")->required();
  command->callback([request] { Info(*request); });
}

void AddList(CLI::App* app) {
  app->add_subcommand("list",
                      "The worlds that come with Waymark, one a line: name, "
                      "size, what it is")
      ->callback([] { List(); });
}

void AddCheck(CLI::App* app, Request* request, int* exit_code) {
  CLI::App* command = app->add_subcommand(
      "check",
      "Loads and builds worlds; furniture must be in rooms, people, their "
      "paths and routes out of walls and furniture, robots 1.1 m high and "
      "0.5 m wide free at starts and places, and "
      "images from there well exposed: mean grey value from 50 to 200, at most "
      "2 % of pixels with a grey value of 0 or 255 (pure colours have "
      "neither), "
      "a mean change of at most 1.5 grey values when the robot moves a "
      "millimetre. Exit 1 where one is not.");
  command->add_option("WORLD", request->worlds, "Names or files")->required();
  command->add_flag(
      "-v,--verbose", request->is_verbose, "A line for good views too");
  AddThreads(command, request);
  command->callback([request, exit_code] { Check(*request, exit_code); });
}

}  // namespace

int RunWorldTool(int argc, char** argv) {
  Request request;
  return RunTool(argc,
                 argv,
                 "waymark-world",
                 "Simulated worlds: pictures, plans, checks.",
                 [&](CLI::App* app, int* exit_code) {
                   app->require_subcommand(1);
                   AddRender(app, &request);
                   AddPlan(app, &request);
                   AddInfo(app, &request);
                   AddList(app);
                   AddCheck(app, &request, exit_code);
                 });
}

}  // namespace waymark
