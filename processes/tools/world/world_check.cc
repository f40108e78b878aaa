#include "processes/tools/world/world_check.h"

#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/world_layout.h"
#include "estimation/base/input_error.h"
#include "estimation/camera/camera_parameters.h"
#include "estimation/geometry/pose3.h"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace waymark {
namespace {

// Forward and aside, both change images.
const Pose2 kMillimetre{0.8e-3, 0.6e-3, 0.0};

struct Eye {
  std::string name;
  CameraRays rays;
  cv::Mat1b seen;
  Eigen::Isometry3d X_RC;
  bool looks_around = false;  // One heading is enough.
};

cv::Mat1b SeenBy(const CameraView& view) {
  cv::Mat1b seen(view.size.height, view.size.width);
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      seen(y, x) = RayFromPixel(view.model, Eigen::Vector2d(x, y)) ? 255 : 0;
    }
  }
  return seen;
}

std::vector<Eye> EyesOf(std::span<const NamedCamera> cameras) {
  std::vector<Eye> eyes;
  for (const NamedCamera& named : cameras) {
    const CameraView view{named.camera.model, named.camera.size};
    const CameraKind kind = KindOf(named.camera.model);
    eyes.push_back(
        {named.name,
         CameraRays(view),
         SeenBy(view),
         named.camera.X_RC,
         kind == CameraKind::kPanorama || kind == CameraKind::kSphere});
  }
  return eyes;
}

std::vector<Eigen::Isometry3d> MoverPoses(const People& people,
                                          const Pose2& X_WR) {
  std::vector<Eigen::Isometry3d> X_WP;
  for (const Pose2& pose : people.PosesAt(0.0, X_WR)) {
    X_WP.push_back(SpatialPose(pose));
  }
  return X_WP;
}

// Points at most kSpacing apart along a line, ends included.
template <typename Visit>
void VisitLine(const Eigen::Vector2d& a,
               const Eigen::Vector2d& b,
               const Visit& visit) {
  constexpr double kSpacing = 0.05;
  const int num_parts =
      std::max(1, static_cast<int>(std::ceil((b - a).norm() / kSpacing)));
  for (int i = 0; i <= num_parts; ++i) visit(a + (b - a) * i / num_parts);
}

std::string At(const Eigen::Vector2d& p) {
  return fmt::format("at x {:.2f}, y {:.2f}", p.x(), p.y());
}

// The piece but for what a skirting or the rounding of a file costs.
std::optional<std::string> FaultOf(const WorldFurniture& piece,
                                   const WalkArea& area) {
  constexpr double kPlay = 0.03;
  WorldFurniture core = piece;
  for (int i = 0; i < 2; ++i) {
    core.size[i] = std::max(0.5 * piece.size[i], piece.size[i] - 2.0 * kPlay);
  }
  const WalkArea::Outline outline = OutlineOf(core);
  std::optional<std::string> fault;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    VisitLine(outline[i],
              outline[(i + 1) % outline.size()],
              [&](const Eigen::Vector2d& p) {
                if (fault || area.IsOnFloor(p)) return;
                fault = piece.where +
                        ": is outside of all rooms, or in a wall, " + At(p);
              });
  }
  return fault;
}

// "furniture[0] (box)" of "world.yaml:4: furniture[0] (box)".
std::string NameOf(const std::string& where) {
  const std::size_t colon = where.rfind(": ");
  return colon == std::string::npos ? where : where.substr(colon + 2);
}

// The pillar or piece of furniture that p is in, else the one within `reach` of
// it; nullopt: neither.
struct Thing {
  std::string name;
  bool is_around = false;
};
std::optional<Thing> ThingAt(const World& world,
                             const Eigen::Vector2d& p,
                             double reach) {
  std::optional<Thing> thing;
  const auto look = [&](const std::string& where,
                        const WalkArea::Outline& outline) {
    if (IsInside(outline, p)) thing = {NameOf(where), true};
    if (!thing && DistanceToOutline(outline, p) <= reach) {
      thing = {NameOf(where), false};
    }
  };
  for (const WorldPillar& it : world.pillars) look(it.where, OutlineOf(it));
  for (const WorldFurniture& it : world.furniture) {
    look(it.where, OutlineOf(it));
  }
  return thing;
}

// What is in the way of a body of radius `room` at p; nullopt: nothing.
std::optional<std::string> FaultAt(const Eigen::Vector2d& p,
                                   double room,
                                   const World& world,
                                   const WalkArea& area) {
  const double clearance = area.Clearance(p);
  if (clearance >= room) return std::nullopt;
  if (!area.IsOnFloor(p)) {
    return "is outside of all rooms, or in a wall, " + At(p);
  }
  // Outlines of the plan and those of the mesh differ by roundings.
  constexpr double kPlay = 0.02;
  const auto thing = ThingAt(world, p, std::max(clearance, 0.0) + kPlay);
  // Between the legs of a table, too.
  if (clearance <= 0.0 || (thing && thing->is_around)) {
    return "is in " + (thing ? thing->name : std::string("a door")) + ", " +
           At(p);
  }
  return fmt::format("is {:.2f} m from {} {}, needs {:.2f} m",
                     clearance,
                     thing ? thing->name : "a wall, door or model",
                     At(p),
                     room);
}

// The same where the line has the least room.
std::optional<std::string> FaultOf(const std::vector<Eigen::Vector2d>& line,
                                   double room,
                                   const World& world,
                                   const WalkArea& area) {
  Eigen::Vector2d worst;
  double least = room;
  for (std::size_t i = 0; i < line.size(); ++i) {
    VisitLine(line[i],
              line[std::min(i + 1, line.size() - 1)],
              [&](const Eigen::Vector2d& p) {
                const double clearance = area.Clearance(p);
                if (clearance >= least) return;
                least = clearance;
                worst = p;
              });
  }
  if (least >= room) return std::nullopt;
  return FaultAt(worst, room, world, area);
}

// Starts, then places.
std::vector<WorldPose> PosesOf(const World& world) {
  std::vector<WorldPose> poses = world.starts;
  poses.insert(poses.end(), world.places.begin(), world.places.end());
  return poses;
}

}  // namespace

std::vector<std::string> CheckObjects(const World& world,
                                      const Scene& scene,
                                      const WorldCheckOptions& options) {
  std::vector<std::string> faults;
  const WalkArea for_people(world, scene.mesh, kPersonHeight);
  const WalkArea for_robots(world, scene.mesh, options.robot_height);
  for (const WorldFurniture& piece : world.furniture) {
    if (const auto fault = FaultOf(piece, for_people)) faults.push_back(*fault);
  }
  // Elbows may touch.
  constexpr double kRoom = kPersonRadius - 0.05;
  for (const WorldPerson& person : world.people) {
    std::vector<Eigen::Vector2d> line = person.path;
    if (person.motion == PersonMotion::kStand) line = {person.at};
    if (person.motion == PersonMotion::kBeside) continue;
    if (person.is_closed && !line.empty()) line.push_back(line.front());
    if (const auto fault = FaultOf(line, kRoom, world, for_people)) {
      faults.push_back(
          person.where +
          (person.motion == PersonMotion::kStand ? ": at: " : ": path: ") +
          *fault);
    }
  }
  for (const WorldPose& pose : PosesOf(world)) {
    if (const auto fault = FaultAt(
            pose.X_WR.position(), options.robot_radius, world, for_robots)) {
      faults.push_back(pose.where + ": " + *fault);
    }
  }
  for (const WorldRoute& route : world.routes) {
    if (const auto fault =
            FaultOf(route.points, options.robot_radius, world, for_robots)) {
      faults.push_back(route.where + ": " + *fault);
    }
  }
  return faults;
}

bool Exposure::IsGood() const {
  return burnt_share + black_share <= kMaxClippedShare && mean >= kMinMean &&
         mean <= kMaxMean;
}

Exposure ExposureOf(const cv::Mat3b& image, const cv::Mat1b& seen) {
  Exposure exposure;
  double sum = 0.0;
  std::int64_t burnt = 0;
  std::int64_t black = 0;
  std::int64_t count = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      if (!seen.empty() && seen(y, x) == 0) continue;
      const cv::Vec3b& p = image(y, x);
      const double grey = 0.114 * p[0] + 0.587 * p[1] + 0.299 * p[2];
      ++count;
      sum += grey;
      // Rounded as cv::cvtColor does.
      if (grey >= 254.5) ++burnt;
      if (grey < 0.5) ++black;
    }
  }
  if (count == 0) return exposure;
  const auto total = static_cast<double>(count);
  exposure.mean = sum / total;
  exposure.burnt_share = static_cast<double>(burnt) / total;
  exposure.black_share = static_cast<double>(black) / total;
  return exposure;
}

double GreyChange(const cv::Mat3b& first,
                  const cv::Mat3b& second,
                  const cv::Mat1b& seen) {
  cv::Mat1b grey[2];
  cv::cvtColor(first, grey[0], cv::COLOR_BGR2GRAY);
  cv::cvtColor(second, grey[1], cv::COLOR_BGR2GRAY);
  cv::Mat1b change;
  cv::absdiff(grey[0], grey[1], change);
  return cv::mean(change, seen.empty() ? cv::noArray() : seen)[0];
}

bool ViewCheck::IsGood() const {
  return exposure.IsGood() && change <= kMaxChange;
}

std::vector<ViewCheck> CheckViews(const World& world,
                                  const Scene& scene,
                                  std::span<const NamedCamera> cameras,
                                  const WorldCheckOptions& options) {
  const std::vector<WorldPose> poses = PosesOf(world);
  if (poses.empty()) {
    throw InputError(world.source + ": has neither starts nor places");
  }
  const WalkArea area(world, scene.mesh, options.robot_height);
  const People people(world, {});
  RendererOptions renderer_options;
  renderer_options.num_threads = options.num_threads;
  renderer_options.shader.light_map.cell_size = options.light_cell_size;
  const Renderer renderer(scene, renderer_options);
  const std::vector<Eye> eyes = EyesOf(cameras);
  std::vector<ViewCheck> checks;
  for (const WorldPose& pose : poses) {
    if (area.Clearance(pose.X_WR.position()) < options.robot_radius) continue;
    for (int i = 0; i < options.num_headings; ++i) {
      Pose2 X_WR = pose.X_WR;
      X_WR.heading += 2.0 * std::numbers::pi * i / options.num_headings;
      for (const Eye& eye : eyes) {
        if (eye.looks_around && i > 0) continue;
        ViewCheck check;
        check.name = fmt::format(
            "{}, {:.0f} deg, {}",
            pose.name,
            std::remainder(X_WR.heading * 180.0 / std::numbers::pi, 360.0),
            eye.name);
        // People stay where they are, whatever the robot does.
        const std::vector<Eigen::Isometry3d> X_WP = MoverPoses(people, X_WR);
        const auto view = [&](const Pose2& from) {
          return renderer
              .Render(eye.rays,
                      SpatialPose(from) * eye.X_RC,
                      X_WP,
                      {.quality = RenderQuality::kLive})
              .image;
        };
        const cv::Mat3b image = view(X_WR);
        check.exposure = ExposureOf(image, eye.seen);
        check.change = GreyChange(image, view(X_WR * kMillimetre), eye.seen);
        checks.push_back(std::move(check));
      }
    }
  }
  return checks;
}

}  // namespace waymark
