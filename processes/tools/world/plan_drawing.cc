#include "processes/tools/world/plan_drawing.h"

#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/wall_pictures.h"
#include "drivers/simulator/world_layout.h"
#include "processes/tools/world/plan_canvas.h"
#include "processes/tools/world/plan_legend.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace waymark {
namespace {

const cv::Scalar kGrid(243, 240, 237);
const cv::Scalar kWall(64, 58, 54);
const cv::Scalar kDoor(60, 120, 190);
const cv::Scalar kPillar(120, 114, 108);
const cv::Scalar kFurniture(176, 202, 220);
const cv::Scalar kFurnitureEdge(110, 140, 165);
const cv::Scalar kPicture(190, 110, 40);
const cv::Scalar kModel(150, 120, 90);
const cv::Scalar kPerson(70, 90, 210);
const cv::Scalar kStart(70, 150, 40);
const cv::Scalar kPlace(170, 60, 150);
const cv::Scalar kRoute(200, 170, 120);

constexpr int kOversampling = PlanCanvas::kOversampling;

struct PathStyle {
  cv::Scalar color;
  double pen = 0.0;
  const char* text = "";
};

// From wide to narrow, so that one is seen on the other where they agree.
PathStyle StyleOf(PlanPath::Kind kind) {
  switch (kind) {
    case PlanPath::Kind::kDriven:
      return {{90, 160, 60}, 6.0, "driven (TRUTH)"};
    case PlanPath::Kind::kDeadReckoning:
      return {{40, 140, 240}, 3.8, "dead reckoning (ODOMETRY)"};
    case PlanPath::Kind::kBelieved:
      break;
  }
  return {{200, 60, 30}, 1.2, "believed (POSE)"};
}

// What has to be seen of a world.
Eigen::AlignedBox2d BoxOf(const World& world,
                          const Scene& scene,
                          const WalkArea& area) {
  Eigen::AlignedBox2d box;
  for (const auto& segment : area.segments()) {
    for (const Eigen::Vector2d& p : segment) box.extend(p);
  }
  if (!world.models.empty()) {
    for (const Eigen::Vector3f& p : scene.mesh.positions) {
      box.extend(p.head<2>().cast<double>());
    }
  }
  for (const WorldPose& pose : world.starts) box.extend(pose.X_WR.position());
  if (box.isEmpty()) box.extend(Eigen::Vector2d::Zero());
  return box;
}

// What there is in this plan.
PlanLegend LegendOf(const World& world, const PlanOptions& options) {
  using Sign = PlanLegend::Sign;
  PlanLegend legend;
  const auto add = [&](bool is_there,
                       Sign sign,
                       const cv::Scalar& color,
                       double pen,
                       const char* text) {
    if (is_there) legend.Add(sign, color, pen, text);
  };
  const Layout layout = ResolveLayout(world);
  add(std::any_of(layout.passages.begin(),
                  layout.passages.end(),
                  [](const Passage& p) { return p.door != nullptr; }),
      Sign::kArea,
      kDoor,
      0.0,
      "door");
  add(!world.pillars.empty(), Sign::kArea, kPillar, 0.0, "pillar");
  add(!world.furniture.empty(), Sign::kArea, kFurniture, 0.0, "furniture");
  add(!HangPictures(world, layout).empty(),
      Sign::kLine,
      kPicture,
      2.0,
      "on the wall");
  add(!world.people.empty(), Sign::kDisc, kPerson, 0.0, "person");
  add(!world.starts.empty(), Sign::kDisc, kStart, 0.0, "start");
  add(!world.places.empty(), Sign::kDisc, kPlace, 0.0, "place");
  add(!world.routes.empty(), Sign::kLine, kRoute, 1.5, "route");
  for (const PlanPath& path : options.paths) {
    const PathStyle style = StyleOf(path.kind);
    add(!path.points.empty(), Sign::kLine, style.color, style.pen, style.text);
  }
  return legend;
}

class PlanDrawer {
 public:
  PlanDrawer(const World& world, const Scene& scene, const PlanOptions& options)
      : world_(world),
        scene_(scene),
        options_(options),
        area_(world),
        legend_(LegendOf(world, options)),
        canvas_(BoxOf(world, scene, area_),
                options.pixels,
                [this](double width) { return legend_.Arrange(width); }) {}

  cv::Mat3b Run() {
    DrawFloors();
    DrawWalls();
    DrawFurniture();
    DrawDoors();
    DrawPictures();
    DrawRoutes();
    DrawNames();
    DrawPeople();
    DrawPoses();
    DrawPaths();
    DrawCoordinates();
    legend_.Draw(&canvas_);
    canvas_.Text(world_.name,
                 {canvas_.width() / 2.0, 28.0 * kOversampling},
                 0.6,
                 kPlanText);
    return canvas_.Halved();
  }

 private:
  void DrawFloors() {
    // What is between rooms is wall.
    for (const auto& floor : area_.floors()) canvas_.Outline(floor, kWall, 5.0);
    for (const auto& floor : area_.floors()) canvas_.Fill(floor, kPlanPaper);
    const cv::Mat1b paper = canvas_.Paper();
    const Eigen::AlignedBox2d& box = canvas_.box();
    for (double x = std::ceil(box.min().x()); x <= box.max().x(); x += 1.0) {
      canvas_.Line({x, box.min().y()}, {x, box.max().y()}, kGrid, 0.5);
    }
    for (double y = std::ceil(box.min().y()); y <= box.max().y(); y += 1.0) {
      canvas_.Line({box.min().x(), y}, {box.max().x(), y}, kGrid, 0.5);
    }
    if (!area_.floors().empty()) canvas_.ClearOutside(paper);
  }

  void DrawWalls() {
    for (const auto& segment : area_.segments()) {
      canvas_.Line(segment[0], segment[1], kWall, 2.0);
    }
    if (world_.models.empty()) return;
    for (const Segment2& segment : OutlineOfMesh(scene_.mesh, {0.1, 1.5})) {
      canvas_.Line(segment.a, segment.b, kModel, 0.8);
    }
  }

  void DrawFurniture() {
    for (const WorldFurniture& piece : world_.furniture) {
      const WalkArea::Outline outline = OutlineOf(piece);
      canvas_.Fill(outline, kFurniture);
      canvas_.Outline(outline, kFurnitureEdge, 1.2);
      // A line along its front.
      const Eigen::Vector2d shift = 0.12 * (outline[0] - outline[1]);
      canvas_.Line(outline[1] + shift, outline[2] + shift, kFurnitureEdge, 0.8);
    }
    for (const WorldPillar& pillar : world_.pillars) {
      canvas_.Fill(OutlineOf(pillar), kPillar);
      canvas_.Outline(OutlineOf(pillar), kWall, 1.5);
    }
  }

  void DrawDoors() {
    for (const Passage& passage : ResolveLayout(world_).passages) {
      if (passage.door == nullptr) continue;
      const DoorLeaf leaf = LeafOf(world_, passage);
      const auto at = [&](double x, double y) -> Eigen::Vector2d {
        return (leaf.X_WD * Eigen::Vector3d(x, y, 0.0)).head<2>();
      };
      const WalkArea::Outline outline{at(0.0, leaf.low),
                                      at(leaf.width, leaf.low),
                                      at(leaf.width, leaf.high),
                                      at(0.0, leaf.high)};
      canvas_.Fill(outline, kDoor);
      canvas_.Outline(outline, kDoor, 1.0);
      // The way of its end from where it is shut.
      const double angle = passage.door->angle;
      const double sign = passage.door->hinge == Hinge::kLeft ? 1.0 : -1.0;
      constexpr int kSteps = 24;
      Eigen::Vector2d last = at(leaf.width, 0.0);
      for (int i = 1; angle != 0.0 && i <= kSteps; ++i) {
        const double back = sign * angle * i / kSteps;
        const Eigen::Vector2d next =
            at(leaf.width * std::cos(back), leaf.width * std::sin(back));
        canvas_.Line(last, next, kDoor, 0.6);
        last = next;
      }
    }
  }

  void DrawPictures() {
    for (const HungPicture& picture :
         HangPictures(world_, ResolveLayout(world_))) {
      const WallFrame frame = FrameOfWall(
          world_.rooms[static_cast<std::size_t>(picture.room)], picture.wall);
      const double half = picture.size.x() / 2.0;
      const double inward = 2.5 * kOversampling / canvas_.scale();
      canvas_.Line(frame.At(picture.along - half, inward),
                   frame.At(picture.along + half, inward),
                   kPicture,
                   2.0);
    }
  }

  void DrawRoutes() {
    for (const WorldRoute& route : world_.routes) {
      for (std::size_t i = 1; i < route.points.size(); ++i) {
        const Eigen::Vector2d a = route.points[i - 1];
        const Eigen::Vector2d way = route.points[i] - a;
        const double dash = 8.0 * kOversampling / canvas_.scale();
        const int dashes = std::max(1, static_cast<int>(way.norm() / dash));
        for (int k = 0; k < dashes; k += 2) {
          canvas_.Line(a + way * k / dashes,
                       a + way * std::min(k + 1, dashes) / dashes,
                       kRoute,
                       1.5);
        }
      }
    }
  }

  // In the south of each room, where few places are: beside its first wall.
  void DrawNames() {
    for (const WorldRoom& room : world_.rooms) {
      const WallFrame frame = FrameOfWall(room, 0);
      canvas_.Text(room.name,
                   canvas_.At(frame.At(frame.length / 2.0, 0.35)),
                   0.45,
                   kPlanText);
    }
  }

  void DrawPeople() {
    const Pose2 X_WR = world_.starts.empty() ? Pose2{} : world_.starts[0].X_WR;
    const auto poses =
        People(world_, area_, {}).PosesAt(options_.seconds, X_WR);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (world_.people[i].motion == PersonMotion::kWalk) {
        const auto& path = world_.people[i].path;
        const std::size_t parts =
            world_.people[i].is_closed ? path.size() : path.size() - 1;
        for (std::size_t k = 0; k < parts; ++k) {
          canvas_.Line(path[k], path[(k + 1) % path.size()], kPerson, 0.7);
        }
      }
      const Eigen::Vector2d p = poses[i].position();
      canvas_.Disc(p, kPersonRadius * canvas_.scale(), kPerson);
      canvas_.Line(p,
                   poses[i] * Eigen::Vector2d(1.6 * kPersonRadius, 0.0),
                   kPerson,
                   2.0);
    }
  }

  void DrawPoses() {
    for (const WorldPose& start : world_.starts) {
      const double size = std::max(0.3, 9.0 * kOversampling / canvas_.scale());
      WalkArea::Outline arrow;
      for (const Eigen::Vector2d& p : {Eigen::Vector2d(1.0, 0.0),
                                       Eigen::Vector2d(-0.7, 0.65),
                                       Eigen::Vector2d(-0.35, 0.0),
                                       Eigen::Vector2d(-0.7, -0.65)}) {
        arrow.push_back(start.X_WR * Eigen::Vector2d(size * p));
      }
      canvas_.Fill(arrow, kStart);
      canvas_.Outline(arrow, kStart, 1.0);
    }
    for (const WorldPose& place : world_.places) {
      const Eigen::Vector2d p = place.X_WR.position();
      canvas_.Disc(p, 5.0 * kOversampling, kPlace);
      canvas_.Disc(p, 2.0 * kOversampling, kPlanPaper);
      canvas_.Text(place.name,
                   canvas_.At(p) + cv::Point2d(0.0, 14.0 * kOversampling),
                   0.4,
                   kPlace);
    }
  }

  void DrawPaths() {
    for (const PlanPath& path : options_.paths) {
      const PathStyle style = StyleOf(path.kind);
      for (std::size_t i = 1; i < path.points.size(); ++i) {
        canvas_.Line(
            path.points[i - 1], path.points[i], style.color, style.pen);
      }
    }
  }

  // Metres along the lower and the left edge, as far apart as their texts need.
  void DrawCoordinates() {
    const Eigen::AlignedBox2d& box = canvas_.box();
    double step = 1.0;
    for (const double wider : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0}) {
      if (step * canvas_.scale() < 45.0 * kOversampling) step = wider;
    }
    const double gap = 6.0 * kOversampling;
    const double left = canvas_.At(box.min()).x - gap;
    const double bottom = canvas_.At(box.min()).y + gap;
    // "-0" is 0.
    const auto first = [&](double low) {
      return std::ceil(low / step) * step + 0.0;
    };
    const auto tick = [&](const cv::Point2d& a, const cv::Point2d& b) {
      canvas_.PixelLine(a, b, kPlanText, 0.8);
    };
    for (double x = first(box.min().x()); x <= box.max().x(); x += step) {
      const double at = canvas_.At({x, box.min().y()}).x;
      tick({at, bottom}, {at, bottom + gap});
      canvas_.Text(
          fmt::format("{:g} m", x), {at, bottom + 2.5 * gap}, 0.36, kPlanText);
    }
    for (double y = first(box.min().y()); y <= box.max().y(); y += step) {
      const double at = canvas_.At({box.min().x(), y}).y;
      tick({left - gap, at}, {left, at});
      canvas_.Text(
          fmt::format("{:g} m", y), {left - 4.5 * gap, at}, 0.36, kPlanText);
    }
  }

  const World& world_;
  const Scene& scene_;
  PlanOptions options_;
  WalkArea area_;
  PlanLegend legend_;
  PlanCanvas canvas_;
};

}  // namespace

cv::Mat3b DrawPlan(const World& world,
                   const Scene& scene,
                   const PlanOptions& options) {
  return PlanDrawer(world, scene, options).Run();
}

}  // namespace waymark
