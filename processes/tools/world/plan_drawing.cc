#include "processes/tools/world/plan_drawing.h"

#include "drivers/simulator/mesh_outline.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/walk_area.h"
#include "drivers/simulator/wall_pictures.h"
#include "drivers/simulator/world_layout.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace waymark {
namespace {

const cv::Scalar kGround(236, 238, 240);
const cv::Scalar kFloor(255, 255, 255);
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
const cv::Scalar kText(70, 64, 60);

// Drawn twice as large, then halved: OpenCV smooths lines but no areas.
constexpr int kOversampling = 2;
constexpr int kShift = 4;  // Bits of a fraction of a pixel.
constexpr int kMargin = 70;
constexpr int kMaxPixels = 8000;

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

class PlanDrawer {
 public:
  PlanDrawer(const World& world, const Scene& scene, const PlanOptions& options)
      : world_(world), scene_(scene), options_(options), area_(world) {
    for (const auto& segment : area_.segments()) {
      for (const Eigen::Vector2d& p : segment) box_.extend(p);
    }
    if (!world.models.empty()) {
      for (const Eigen::Vector3f& p : scene.mesh.positions) {
        box_.extend(p.head<2>().cast<double>());
      }
    }
    for (const WorldPose& pose : world.starts) {
      box_.extend(pose.X_WR.position());
    }
    if (box_.isEmpty()) box_.extend(Eigen::Vector2d::Zero());
    const int pixels = std::clamp(options.pixels, 200, kMaxPixels);
    const double side = std::max(box_.sizes().maxCoeff(), 1.0);
    scale_ = kOversampling * (pixels - 2 * kMargin) / side;
    Eigen::Vector2d size =
        box_.sizes() * scale_ +
        Eigen::Vector2d::Constant(2.0 * kOversampling * kMargin);
    legend_height_ = FillLegend(size.x());
    size.y() += legend_height_;
    image_ = cv::Mat3b(static_cast<int>(size.y()) & ~1,
                       static_cast<int>(size.x()) & ~1,
                       cv::Vec3b(236, 238, 240));
  }

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
    DrawLegend();
    DrawTitle();
    cv::Mat3b small;
    cv::resize(image_,
               small,
               {},
               1.0 / kOversampling,
               1.0 / kOversampling,
               cv::INTER_AREA);
    return small;
  }

 private:
  cv::Point2d At(const Eigen::Vector2d& p) const {
    const double margin = kOversampling * kMargin;
    return {margin + (p.x() - box_.min().x()) * scale_,
            image_.rows - legend_height_ - margin -
                (p.y() - box_.min().y()) * scale_};
  }
  static cv::Point Fixed(const cv::Point2d& p) {
    return {static_cast<int>(std::lround(p.x * (1 << kShift))),
            static_cast<int>(std::lround(p.y * (1 << kShift)))};
  }
  // Of paper, in pixels of the result.
  static int Pen(double pixels) {
    return std::max(1, static_cast<int>(std::lround(pixels * kOversampling)));
  }

  void Line(const Eigen::Vector2d& a,
            const Eigen::Vector2d& b,
            const cv::Scalar& color,
            double pen) {
    cv::line(image_,
             Fixed(At(a)),
             Fixed(At(b)),
             color,
             Pen(pen),
             cv::LINE_AA,
             kShift);
  }

  void Fill(const WalkArea::Outline& outline, const cv::Scalar& color) {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& p : outline) points.push_back(Fixed(At(p)));
    cv::fillPoly(image_,
                 std::vector<std::vector<cv::Point>>{points},
                 color,
                 cv::LINE_AA,
                 kShift);
  }

  void Outline(const WalkArea::Outline& outline,
               const cv::Scalar& color,
               double pen) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      Line(outline[i], outline[(i + 1) % outline.size()], color, pen);
    }
  }

  void Disc(const Eigen::Vector2d& p,
            double radius_px,
            const cv::Scalar& color) {
    cv::circle(image_,
               Fixed(At(p)),
               static_cast<int>(std::lround(radius_px * (1 << kShift))),
               color,
               cv::FILLED,
               cv::LINE_AA,
               kShift);
  }

  // Centred at a pixel of image_.
  void Text(const std::string& text,
            const cv::Point2d& middle,
            double size,
            const cv::Scalar& color) {
    const double scale = size * kOversampling;
    const int pen = Pen(0.6);
    int baseline = 0;
    const cv::Size box =
        cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, pen, &baseline);
    const cv::Point origin(static_cast<int>(middle.x) - box.width / 2,
                           static_cast<int>(middle.y) + box.height / 2);
    cv::putText(image_,
                text,
                origin,
                cv::FONT_HERSHEY_SIMPLEX,
                scale,
                kFloor,
                Pen(2.4),
                cv::LINE_AA);
    cv::putText(image_,
                text,
                origin,
                cv::FONT_HERSHEY_SIMPLEX,
                scale,
                color,
                pen,
                cv::LINE_AA);
  }

  void DrawFloors() {
    // What is between rooms is wall.
    for (const auto& floor : area_.floors()) Outline(floor, kWall, 5.0);
    for (const auto& floor : area_.floors()) Fill(floor, kFloor);
    cv::Mat1b is_floor;
    cv::inRange(image_, kFloor, kFloor, is_floor);
    for (double x = std::ceil(box_.min().x()); x <= box_.max().x(); x += 1.0) {
      Line({x, box_.min().y()}, {x, box_.max().y()}, kGrid, 0.5);
    }
    for (double y = std::ceil(box_.min().y()); y <= box_.max().y(); y += 1.0) {
      Line({box_.min().x(), y}, {box_.max().x(), y}, kGrid, 0.5);
    }
    cv::Mat3b ground(image_.size(), cv::Vec3b(236, 238, 240));
    if (!area_.floors().empty()) ground.copyTo(image_, is_floor == 0);
  }

  void DrawWalls() {
    for (const auto& segment : area_.segments()) {
      Line(segment[0], segment[1], kWall, 2.0);
    }
    if (world_.models.empty()) return;
    for (const Segment2& segment : OutlineOfMesh(scene_.mesh, {0.1, 1.5})) {
      Line(segment.a, segment.b, kModel, 0.8);
    }
  }

  void DrawFurniture() {
    for (const WorldFurniture& piece : world_.furniture) {
      const WalkArea::Outline outline = OutlineOf(piece);
      Fill(outline, kFurniture);
      Outline(outline, kFurnitureEdge, 1.2);
      // A line along its front.
      const Eigen::Vector2d shift = 0.12 * (outline[0] - outline[1]);
      Line(outline[1] + shift, outline[2] + shift, kFurnitureEdge, 0.8);
    }
    for (const WorldPillar& pillar : world_.pillars) {
      Fill(OutlineOf(pillar), kPillar);
      Outline(OutlineOf(pillar), kWall, 1.5);
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
      Fill(outline, kDoor);
      Outline(outline, kDoor, 1.0);
      // The way of its end from where it is shut.
      const double angle = passage.door->angle;
      const double sign = passage.door->hinge == Hinge::kLeft ? 1.0 : -1.0;
      constexpr int kSteps = 24;
      Eigen::Vector2d last = at(leaf.width, 0.0);
      for (int i = 1; angle != 0.0 && i <= kSteps; ++i) {
        const double back = sign * angle * i / kSteps;
        const Eigen::Vector2d next =
            at(leaf.width * std::cos(back), leaf.width * std::sin(back));
        Line(last, next, kDoor, 0.6);
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
      const double inward = 2.5 * kOversampling / scale_;
      Line(frame.At(picture.along - half, inward),
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
        const double dash = 8.0 * kOversampling / scale_;
        const int dashes = std::max(1, static_cast<int>(way.norm() / dash));
        for (int k = 0; k < dashes; k += 2) {
          Line(a + way * k / dashes,
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
      Text(room.name, At(frame.At(frame.length / 2.0, 0.35)), 0.45, kText);
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
          Line(path[k], path[(k + 1) % path.size()], kPerson, 0.7);
        }
      }
      const Eigen::Vector2d p = poses[i].position();
      Disc(p, kPersonRadius * scale_, kPerson);
      Line(p,
           poses[i] * Eigen::Vector2d(1.6 * kPersonRadius, 0.0),
           kPerson,
           2.0);
    }
  }

  void DrawPoses() {
    for (const WorldPose& start : world_.starts) {
      const double size = std::max(0.3, 9.0 * kOversampling / scale_);
      WalkArea::Outline arrow;
      for (const Eigen::Vector2d& p : {Eigen::Vector2d(1.0, 0.0),
                                       Eigen::Vector2d(-0.7, 0.65),
                                       Eigen::Vector2d(-0.35, 0.0),
                                       Eigen::Vector2d(-0.7, -0.65)}) {
        arrow.push_back(start.X_WR * Eigen::Vector2d(size * p));
      }
      Fill(arrow, kStart);
      Outline(arrow, kStart, 1.0);
    }
    for (const WorldPose& place : world_.places) {
      const Eigen::Vector2d p = place.X_WR.position();
      Disc(p, 5.0 * kOversampling, kPlace);
      Disc(p, 2.0 * kOversampling, kFloor);
      Text(place.name,
           At(p) + cv::Point2d(0.0, 14.0 * kOversampling),
           0.4,
           kPlace);
    }
  }

  void DrawPaths() {
    for (const PlanPath& path : options_.paths) {
      const PathStyle style = StyleOf(path.kind);
      for (std::size_t i = 1; i < path.points.size(); ++i) {
        Line(path.points[i - 1], path.points[i], style.color, style.pen);
      }
    }
  }

  // Metres along the lower and the left edge, as far apart as their texts need.
  void DrawCoordinates() {
    double step = 1.0;
    for (const double wider : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0}) {
      if (step * scale_ < 45.0 * kOversampling) step = wider;
    }
    const double gap = 6.0 * kOversampling;
    const double left = At(box_.min()).x - gap;
    const double bottom = At(box_.min()).y + gap;
    // "-0" is 0.
    const auto first = [&](double low) {
      return std::ceil(low / step) * step + 0.0;
    };
    const auto tick = [&](const cv::Point2d& a, const cv::Point2d& b) {
      cv::line(
          image_, Fixed(a), Fixed(b), kText, Pen(0.8), cv::LINE_AA, kShift);
    };
    for (double x = first(box_.min().x()); x <= box_.max().x(); x += step) {
      const double at = At({x, box_.min().y()}).x;
      tick({at, bottom}, {at, bottom + gap});
      Text(fmt::format("{:g} m", x), {at, bottom + 2.5 * gap}, 0.36, kText);
    }
    for (double y = first(box_.min().y()); y <= box_.max().y(); y += step) {
      const double at = At({box_.min().x(), y}).y;
      tick({left - gap, at}, {left, at});
      Text(fmt::format("{:g} m", y), {left - 4.5 * gap, at}, 0.36, kText);
    }
  }

  // ---- legend --------------------------------------------------------------

  struct LegendEntry {
    enum class Kind { kLine, kArea, kDisc };
    Kind kind = Kind::kLine;
    cv::Scalar color;
    double pen = 2.0;  // Of a line.
    std::string text;
    cv::Point2d at;  // Of its sample's left end, below the plan.
  };

  static constexpr double kLegendRow = 18.0 * kOversampling;
  static constexpr double kLegendSample = 22.0 * kOversampling;
  static constexpr double kLegendText = 0.38;

  // What there is in this plan, in rows as wide as the picture; returns the
  // height of all.
  double FillLegend(double width) {
    using Kind = LegendEntry::Kind;
    const auto add = [&](bool is_there,
                         Kind kind,
                         const cv::Scalar& color,
                         double pen,
                         const char* text) {
      if (is_there) legend_.push_back({kind, color, pen, text, {}});
    };
    const auto passages = ResolveLayout(world_).passages;
    add(std::any_of(passages.begin(),
                    passages.end(),
                    [](const Passage& p) { return p.door != nullptr; }),
        Kind::kArea,
        kDoor,
        0.0,
        "door");
    add(!world_.pillars.empty(), Kind::kArea, kPillar, 0.0, "pillar");
    add(!world_.furniture.empty(), Kind::kArea, kFurniture, 0.0, "furniture");
    add(!HangPictures(world_, ResolveLayout(world_)).empty(),
        Kind::kLine,
        kPicture,
        2.0,
        "on the wall");
    add(!world_.people.empty(), Kind::kDisc, kPerson, 0.0, "person");
    add(!world_.starts.empty(), Kind::kDisc, kStart, 0.0, "start");
    add(!world_.places.empty(), Kind::kDisc, kPlace, 0.0, "place");
    add(!world_.routes.empty(), Kind::kLine, kRoute, 1.5, "route");
    for (const PlanPath& path : options_.paths) {
      const PathStyle style = StyleOf(path.kind);
      add(!path.points.empty(),
          Kind::kLine,
          style.color,
          style.pen,
          style.text);
    }
    cv::Point2d at(kOversampling * kMargin / 2.0, 0.0);
    const double left = at.x;
    for (LegendEntry& entry : legend_) {
      int baseline = 0;
      const double text_width = cv::getTextSize(entry.text,
                                                cv::FONT_HERSHEY_SIMPLEX,
                                                kLegendText * kOversampling,
                                                Pen(0.6),
                                                &baseline)
                                    .width;
      const double needed = kLegendSample + text_width + kLegendSample;
      if (at.x > left && at.x + needed > width - left) {
        at = {left, at.y + kLegendRow};
      }
      entry.at = at;
      at.x += needed;
    }
    return legend_.empty() ? 0.0 : at.y + kLegendRow;
  }

  void DrawLegend() {
    const double top = image_.rows - legend_height_ - 4.0 * kOversampling;
    const double length = 16.0 * kOversampling;
    for (const LegendEntry& entry : legend_) {
      const cv::Point2d a = entry.at + cv::Point2d(0.0, top);
      const cv::Point2d b = a + cv::Point2d(length, 0.0);
      switch (entry.kind) {
        case LegendEntry::Kind::kLine:
          cv::line(image_,
                   Fixed(a),
                   Fixed(b),
                   entry.color,
                   Pen(entry.pen),
                   cv::LINE_AA,
                   kShift);
          break;
        case LegendEntry::Kind::kArea:
          cv::rectangle(image_,
                        Fixed(a - cv::Point2d(0.0, length / 4.0)),
                        Fixed(b + cv::Point2d(0.0, length / 4.0)),
                        entry.color,
                        cv::FILLED,
                        cv::LINE_AA,
                        kShift);
          break;
        case LegendEntry::Kind::kDisc:
          cv::circle(image_,
                     Fixed((a + b) / 2.0),
                     static_cast<int>(length / 4.0 * (1 << kShift)),
                     entry.color,
                     cv::FILLED,
                     cv::LINE_AA,
                     kShift);
          break;
      }
      int baseline = 0;
      const cv::Size size = cv::getTextSize(entry.text,
                                            cv::FONT_HERSHEY_SIMPLEX,
                                            kLegendText * kOversampling,
                                            Pen(0.6),
                                            &baseline);
      Text(entry.text,
           a + cv::Point2d(kLegendSample + size.width / 2.0, 0.0),
           kLegendText,
           kText);
    }
  }

  void DrawTitle() {
    Text(world_.name, {image_.cols / 2.0, 28.0 * kOversampling}, 0.6, kText);
  }

  const World& world_;
  const Scene& scene_;
  PlanOptions options_;
  WalkArea area_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1.0;  // Pixels of image_ per metre.
  std::vector<LegendEntry> legend_;
  double legend_height_ = 0.0;
  cv::Mat3b image_;
};

}  // namespace

cv::Mat3b DrawPlan(const World& world,
                   const Scene& scene,
                   const PlanOptions& options) {
  return PlanDrawer(world, scene, options).Run();
}

}  // namespace waymark
