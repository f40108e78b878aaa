#include "drivers/simulator/build_scene.h"

#include "drivers/simulator/build_furniture.h"
#include "drivers/simulator/build_rooms.h"
#include "drivers/simulator/floor_plan.h"
#include "drivers/simulator/mesh_file.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/person_mesh.h"
#include "drivers/simulator/wall_pictures.h"
#include "estimation/base/input_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr double kPictureDepth = 0.02;  // How far it stands out of the wall.
constexpr double kLampDepth = 0.03;     // How far a panel hangs below.
// Of a lamp whose `light` is 1, linear BGR: slightly warm. With a panel of
// 0.6 m every 3 m it makes white walls show at some 200 of 255.
const Eigen::Vector3d kLampRadiance(5.2, 5.6, 5.8);
// Around a lamp's light, below its panel, so that no ray to it meets the panel.
constexpr double kLightGap = 0.005;
constexpr double kAmbient = 0.25;
// What is built of floor plans; people of theirs are guided around it.
constexpr int kRoundPillarSides = 32;

// The light of as much takes a core a minute or two; a slip in a size or a grid
// of lamps would take hours.
constexpr double kMaxFloor = 20000.0;  // m^2.
constexpr std::int64_t kMaxLamps = 2000;
// Of models, m^2; that floor has some 100,000 with its walls and ceilings.
constexpr double kMaxModelFaces = 200000.0;

double AreaOf(const std::vector<Eigen::Vector2d>& outline) {
  double doubled = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& p = outline[i];
    const Eigen::Vector2d& q = outline[(i + 1) % outline.size()];
    doubled += p.x() * q.y() - p.y() * q.x();
  }
  return 0.5 * std::abs(doubled);
}

// A plan as it is built: its lamps are every 3 m, where it is free around them.
struct LoadedPlan {
  FloorPlan plan;
  std::vector<Eigen::Vector2d> lamps;  // In W.
};

constexpr double kPlanLampSpacing = 3.0;
constexpr double kPlanLampHalf = 0.3;

std::vector<Eigen::Vector2d> LampsOf(const FloorPlan& plan,
                                     const Eigen::Vector2d& at) {
  std::vector<Eigen::Vector2d> lamps;
  for (double x = kPlanLampSpacing / 2.0; x < plan.size.x();
       x += kPlanLampSpacing) {
    for (double y = kPlanLampSpacing / 2.0; y < plan.size.y();
         y += kPlanLampSpacing) {
      bool is_free = true;
      for (const double dx : {-kPlanLampHalf, 0.0, kPlanLampHalf}) {
        for (const double dy : {-kPlanLampHalf, 0.0, kPlanLampHalf}) {
          is_free = is_free && plan.IsFree({x + dx, y + dy});
        }
      }
      if (is_free) lamps.emplace_back(at.x() + x, at.y() + y);
    }
  }
  return lamps;
}

// Throws InputError where the plans have more floor or lamps than a world may
// have, beside `floor` and `num_lamps`.
std::vector<LoadedPlan> LoadPlans(const World& world,
                                  double floor,
                                  std::int64_t num_lamps) {
  std::vector<LoadedPlan> loaded;
  for (const WorldFloorPlan& plan : world.floor_plans) {
    FloorPlanOptions options;
    options.metres_per_pixel = plan.metres_per_pixel;
    LoadedPlan& out = loaded.emplace_back();
    try {
      out.plan = LoadFloorPlan(plan.image, options);
    } catch (const InputError& error) {
      throw InputError(plan.where + ": image: " + error.what());
    }
    const Eigen::Vector2d& size = out.plan.size;
    const std::string where = plan.where + ": metres_per_pixel: the image is " +
                              std::to_string(std::lround(size.x())) + " x " +
                              std::to_string(std::lround(size.y())) +
                              " m with it: ";
    if ((plan.at + size).maxCoeff() > kMaxWorldReach) {
      throw InputError(where + "reaches beyond 200 m");
    }
    floor += size.prod();
    if (floor > kMaxFloor) {
      throw InputError(where + "more than 20000 m^2 of floor with this plan");
    }
    out.lamps = LampsOf(out.plan, plan.at);
    num_lamps += static_cast<std::int64_t>(out.lamps.size());
    if (num_lamps > kMaxLamps) {
      throw InputError(where + "more than " + std::to_string(kMaxLamps) +
                       " lamps with this plan's, one every 3 m");
    }
  }
  return loaded;
}

// Refuses rooms and floor plans that are far larger than buildings; returns
// the plans.
std::vector<LoadedPlan> CheckSize(const World& world) {
  double floor = 0.0;
  auto num_lamps = static_cast<std::int64_t>(world.lamps.size());
  for (const WorldRoom& room : world.rooms) {
    floor += AreaOf(room.outline);
    num_lamps += std::int64_t{room.lamps[0]} * room.lamps[1];
    if (floor > kMaxFloor) {
      throw InputError(room.where +
                       ": more than 20000 m^2 of floor with this room");
    }
    if (num_lamps > kMaxLamps) {
      throw InputError(room.where + ": more than " + std::to_string(kMaxLamps) +
                       " lamps with this room's");
    }
  }
  return LoadPlans(world, floor, num_lamps);
}

// Of the triangles from one on.
double FacesFrom(std::size_t first, const SceneMesh& mesh) {
  double area = 0.0;
  for (std::size_t i = first; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i].vertices;
    const Eigen::Vector3d ab =
        (mesh.positions[b] - mesh.positions[a]).cast<double>();
    const Eigen::Vector3d ac =
        (mesh.positions[c] - mesh.positions[a]).cast<double>();
    area += 0.5 * ab.cross(ac).norm();
  }
  return area;
}

class SceneBuilder {
 public:
  SceneBuilder(const World& world, SceneLooks looks)
      : world_(world),
        looks_(looks),
        layout_(ResolveLayout(world)),
        finishes_(world, looks == SceneLooks::kPlain, &scene_) {}

  Scene Run() {
    plans_ = CheckSize(world_);
    scene_.ambient = Eigen::Vector3d::Constant(kAmbient * world_.ambient);
    BuildRooms(world_, layout_, &finishes_, &scene_);
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      AddFloorPlan(world_.floor_plans[i], plans_[i]);
    }
    for (const WorldPillar& pillar : world_.pillars) AddPillar(pillar);
    for (const WorldFurniture& piece : world_.furniture) {
      BuildFurniture(piece, &finishes_, &scene_);
    }
    for (const HungPicture& picture : HangPictures(world_, layout_)) {
      AddPicture(picture);
    }
    for (const WorldRoom& room : world_.rooms) AddLampGrid(room);
    for (const WorldLamp& lamp : world_.lamps) {
      AddLamp(lamp.at, lamp.size, lamp.light);
    }
    for (const WorldModel& model : world_.models) AddModel(model);
    if (looks_ == SceneLooks::kDrawn) {
      for (const WorldPerson& person : world_.people) AddPerson(person);
    }
    Check();
    return std::move(scene_);
  }

 private:
  MeshBuilder BuilderFor(const std::string& name, SurfaceKind kind) {
    return {&scene_.mesh, AddSurface(name, kind, &scene_)};
  }

  void AddPillar(const WorldPillar& pillar) {
    const int room = RoomAt(world_, pillar.at);
    if (room < 0) throw InputError(pillar.where + ": at: is in no room");
    const double height = world_.rooms[static_cast<std::size_t>(room)].height;
    const Finish finish =
        finishes_.Get(pillar.material, pillar.where, "material");
    MeshBuilder builder = BuilderFor("pillar", SurfaceKind::kPillar);
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
    X_WB.translation() << pillar.at, 0.0;
    X_WB.linear() = Eigen::AngleAxisd(pillar.heading, Eigen::Vector3d::UnitZ())
                        .toRotationMatrix();
    const double half = pillar.size / 2.0;
    if (pillar.shape == PillarShape::kSquare) {
      builder.AddBox(X_WB,
                     {-half, -half, 0.0},
                     {half, half, height},
                     finish,
                     kFront | kBack | kLeft | kRight);
    } else {
      builder.AddColumn(
          X_WB, 0.0, height, half, half, kRoundPillarSides, finish, kLeft);
    }
  }

  void AddPicture(const HungPicture& picture) {
    const WorldRoom& room =
        world_.rooms[static_cast<std::size_t>(picture.room)];
    WorldLook look = picture.look;
    if (IsOnePiece(look.pattern.kind)) look.pattern.size = picture.size;
    const std::string name =
        look.image.empty() ? NameOf(look.pattern.kind) : look.image;
    Finish finish = finishes_.Make(look, name, picture.where);
    finish.is_one_piece = true;
    MeshBuilder builder = BuilderFor(
        room.name + " " + NameOfWall(room, picture.wall) + " " + name,
        SurfaceKind::kPicture);
    const WallFrame frame = FrameOfWall(room, picture.wall);
    const double x = picture.size.x() / 2.0;
    const double z = picture.size.y() / 2.0;
    const Eigen::Isometry3d X_WB =
        frame.X_WE * Eigen::Translation3d(picture.along, 0.0, picture.height);
    builder.AddBox(X_WB, {-x, 0.0, -z}, {x, kPictureDepth, z}, finish, kLeft);
    builder.AddBox(X_WB,
                   {-x, 0.0, -z},
                   {x, kPictureDepth, z},
                   finishes_.Get("dark", picture.where, "frame"),
                   kFront | kBack | kTop | kBottom);
  }

  void AddLampGrid(const WorldRoom& room) {
    Eigen::Vector2d low = room.outline[0];
    Eigen::Vector2d high = room.outline[0];
    for (const Eigen::Vector2d& p : room.outline) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    for (int i = 0; i < room.lamps[0]; ++i) {
      for (int k = 0; k < room.lamps[1]; ++k) {
        const Eigen::Vector2d at =
            low + (high - low)
                      .cwiseProduct(Eigen::Vector2d((i + 0.5) / room.lamps[0],
                                                    (k + 0.5) / room.lamps[1]));
        // Of an L or U only what is over its floor.
        const Eigen::Vector2d half = room.lamp_size / 2.0;
        const bool fits = IsInside(room.outline, at - half) &&
                          IsInside(room.outline, at + half);
        if (fits) {
          AddLamp({at.x(), at.y(), room.height}, room.lamp_size, room.light);
        }
      }
    }
  }

  // A panel under `at`.
  void AddLamp(const Eigen::Vector3d& at,
               const Eigen::Vector2d& size,
               double light) {
    MeshBuilder builder = BuilderFor("lamp", SurfaceKind::kLamp);
    Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
    X_WB.translation() = at;
    const Eigen::Vector3d half(size.x() / 2.0, size.y() / 2.0, 0.0);
    const Eigen::Vector3d down(0.0, 0.0, -kLampDepth);
    builder.AddBox(X_WB, down - half, half, finishes_.Lamp(), kBottom);
    builder.AddBox(X_WB,
                   down - half,
                   half,
                   finishes_.Get("white", "lamp", "material"),
                   kFront | kBack | kLeft | kRight);
    SceneLamp lamp;
    lamp.p_W = at + down - Eigen::Vector3d(0.0, 0.0, kLightGap);
    lamp.size = size;
    lamp.radiance = light * kLampRadiance;
    scene_.lamps.push_back(lamp);
  }

  void AddModel(const WorldModel& model) {
    MeshFileOptions options;
    options.scale = model.scale;
    options.X_WM.translation() = model.at;
    options.X_WM.linear() =
        Eigen::AngleAxisd(model.heading, Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    options.is_y_up = model.is_y_up;
    options.has_baked_light = model.has_baked_light;
    const std::size_t first = scene_.mesh.triangles.size();
    try {
      AppendMeshFile(model.file, model.file, options, &scene_);
    } catch (const InputError& error) {
      throw InputError(model.where + ": file: " + error.what());
    }
    model_faces_ += FacesFrom(first, scene_.mesh);
    if (model_faces_ > kMaxModelFaces) {
      throw InputError(model.where + ": file: " + model.file +
                       ": more than 200000 m^2 of faces with this model");
    }
  }

  // Walls from floor to ceiling around every outline; floor and ceiling are
  // those of the whole image.
  void AddFloorPlan(const WorldFloorPlan& plan, const LoadedPlan& loaded) {
    const Eigen::Vector2d high = plan.at + loaded.plan.size;
    const std::vector<Eigen::Vector2d> ground{
        plan.at, {high.x(), plan.at.y()}, high, {plan.at.x(), high.y()}};
    BuilderFor("plan floor", SurfaceKind::kFloor)
        .AddArea(
            ground, 0.0, true, finishes_.Get(plan.floor, plan.where, "floor"));
    BuilderFor("plan ceiling", SurfaceKind::kCeiling)
        .AddArea(ground,
                 plan.height,
                 false,
                 finishes_.Get(plan.ceiling, plan.where, "ceiling"));
    const Finish finish = finishes_.Get(plan.walls, plan.where, "walls");
    MeshBuilder walls = BuilderFor("plan walls", SurfaceKind::kWall);
    for (std::vector<Eigen::Vector2d> outline : loaded.plan.outlines) {
      for (Eigen::Vector2d& p : outline) p += plan.at;
      double walked = 0.0;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        // The wall is at the left: outside is seen.
        const Eigen::Vector2d& a = outline[i];
        const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
        const Eigen::Vector3d low_a(a.x(), a.y(), 0.0);
        const Eigen::Vector3d low_b(b.x(), b.y(), 0.0);
        const Eigen::Vector3d up(0.0, 0.0, plan.height);
        walls.AddPanel(
            {low_a, low_b, low_b + up, low_a + up}, finish, {walked, 0.0});
        walked += (b - a).norm();
      }
    }
    for (const Eigen::Vector2d& at : loaded.lamps) {
      AddLamp({at.x(), at.y(), plan.height},
              Eigen::Vector2d::Constant(2.0 * kPlanLampHalf),
              1.0);
    }
  }

  void AddPerson(const WorldPerson& person) {
    PersonOptions options;
    options.height = person.height;
    options.radius = kPersonRadius;
    options.seed = person.seed;
    options.pose = person.motion == PersonMotion::kStand ? PersonPose::kStanding
                                                         : PersonPose::kMidStep;
    try {
      AppendPerson(person.name, options, &scene_);
    } catch (const std::invalid_argument& error) {
      throw InputError(person.where + ": " + error.what());
    }
  }

  void Check() const {
    try {
      CheckScene(scene_);
    } catch (const std::invalid_argument& error) {
      throw InputError(world_.source + ": " + error.what());
    }
  }

  const World& world_;
  SceneLooks looks_;
  Scene scene_;
  Layout layout_;
  Finishes finishes_;
  std::vector<LoadedPlan> plans_;
  double model_faces_ = 0.0;
};

}  // namespace

Scene BuildScene(const World& world, SceneLooks looks) {
  return SceneBuilder(world, looks).Run();
}

}  // namespace waymark
