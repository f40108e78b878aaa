#include "drivers/simulator/build_rooms.h"

#include "drivers/simulator/mesh_builder.h"
#include "estimation/base/input_error.h"
#include "estimation/base/random.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace waymark {
namespace {

constexpr double kFrameWidth = 0.07;      // Of the boards around a door.
constexpr double kFrameThickness = 0.02;  // How far they stand out.
constexpr double kSkirtingDepth = 0.012;
constexpr double kLeafGap = 0.004;  // Around a leaf that stands open.

std::size_t Index(int i) {
  return static_cast<std::size_t>(i);
}

class RoomBuilder {
 public:
  RoomBuilder(const World& world,
              const Layout& layout,
              Finishes* finishes,
              Scene* scene)
      : world_(world), layout_(layout), finishes_(*finishes), scene_(*scene) {
    for (const Passage& passage : layout.passages) {
      levels_.push_back(passage.hole.height);
    }
    std::sort(levels_.begin(), levels_.end());
    levels_.erase(std::unique(levels_.begin(), levels_.end()), levels_.end());
  }

  void Run() {
    for (std::size_t r = 0; r < world_.rooms.size(); ++r) {
      AddFloorAndCeiling(r);
      AddWalls(r);
      AddSkirting(r);
    }
    for (const Passage& passage : layout_.passages) AddPassage(passage);
  }

 private:
  const std::vector<WallHole>& Holes(std::size_t room, std::size_t wall) const {
    return layout_.holes[room][wall];
  }

  // Heights at which panels up to `top` are cut, so that all neighbours are cut
  // alike.
  std::vector<double> CutsTo(double top) const {
    std::vector<double> cuts{0.0};
    for (const double level : levels_) {
      if (level > 1e-6 && level < top - 1e-6) cuts.push_back(level);
    }
    cuts.push_back(top);
    return cuts;
  }

  std::vector<double> CutsAlong(std::size_t room, std::size_t wall) const {
    std::vector<double> cuts{0.0};
    for (const WallHole& hole : Holes(room, wall)) {
      for (const double cut : {hole.begin, hole.end}) {
        if (cut > cuts.back() + 1e-6) cuts.push_back(cut);
      }
    }
    const double length =
        FrameOfWall(world_.rooms[room], static_cast<int>(wall)).length;
    if (cuts.back() > length - 1e-6) cuts.pop_back();
    cuts.push_back(length);
    return cuts;
  }

  void AddFloorAndCeiling(std::size_t r) {
    const WorldRoom& room = world_.rooms[r];
    std::vector<Eigen::Vector2d> outline;
    for (std::size_t w = 0; w < room.outline.size(); ++w) {
      const WallFrame frame = FrameOfWall(room, static_cast<int>(w));
      std::vector<double> cuts = CutsAlong(r, w);
      cuts.pop_back();  // The next wall's first corner.
      for (const double cut : cuts) outline.push_back(frame.At(cut));
    }
    try {
      AddAreas(room, outline);
    } catch (const std::invalid_argument&) {
      // Thinner than ResolveLayout() sees.
      throw InputError(room.where + ": outline: encloses no area");
    }
  }

  void AddAreas(const WorldRoom& room,
                const std::vector<Eigen::Vector2d>& outline) {
    MeshBuilder floor(
        &scene_.mesh,
        AddSurface(room.name + " floor", SurfaceKind::kFloor, &scene_));
    floor.AddArea(
        outline, 0.0, true, finishes_.Get(room.floor, room.where, "floor"));
    MeshBuilder ceiling(
        &scene_.mesh,
        AddSurface(room.name + " ceiling", SurfaceKind::kCeiling, &scene_));
    ceiling.AddArea(outline,
                    room.height,
                    false,
                    finishes_.Get(room.ceiling, room.where, "ceiling"));
  }

  void AddWalls(std::size_t r) {
    const WorldRoom& room = world_.rooms[r];
    double walked = 0.0;  // So that a pattern runs on around corners.
    for (std::size_t w = 0; w < room.outline.size(); ++w) {
      AddWall(r, w, walked);
      walked += FrameOfWall(room, static_cast<int>(w)).length;
    }
  }

  void AddWall(std::size_t r, std::size_t w, double walked) {
    const WorldRoom& room = world_.rooms[r];
    const WallFrame frame = FrameOfWall(room, static_cast<int>(w));
    const Finish finish = finishes_.Get(room.walls[w], room.where, "walls");
    MeshBuilder builder(
        &scene_.mesh,
        AddSurface(room.name + " wall " + NameOfWall(room, static_cast<int>(w)),
                   SurfaceKind::kWall,
                   &scene_));
    const std::vector<double> along = CutsAlong(r, w);
    const std::vector<double> up = CutsTo(room.height);
    const auto at = [&](double s, double z) -> Eigen::Vector3d {
      return frame.X_WE * Eigen::Vector3d(s, 0.0, z);
    };
    for (std::size_t i = 0; i + 1 < along.size(); ++i) {
      for (std::size_t k = 0; k + 1 < up.size(); ++k) {
        if (IsOpen(r, w, (along[i] + along[i + 1]) / 2.0, up[k + 1])) continue;
        // From inside, a wall's first corner is at the right.
        builder.AddPanel({at(along[i + 1], up[k]),
                          at(along[i], up[k]),
                          at(along[i], up[k + 1]),
                          at(along[i + 1], up[k + 1])},
                         finish,
                         {-(walked + along[i + 1]), up[k]});
      }
    }
  }

  bool IsOpen(std::size_t r, std::size_t w, double s, double top) const {
    const std::vector<WallHole>& holes = Holes(r, w);
    return std::any_of(holes.begin(), holes.end(), [&](const WallHole& hole) {
      return hole.begin < s && s < hole.end && top < hole.height + 1e-6;
    });
  }

  // ---- skirting boards -----------------------------------------------------

  void AddSkirting(std::size_t r) {
    const WorldRoom& room = world_.rooms[r];
    if (room.skirting_height <= 0.0) return;
    const Finish finish = finishes_.Get(room.skirting, room.where, "skirting");
    MeshBuilder builder(
        &scene_.mesh,
        AddSurface(room.name + " skirting", SurfaceKind::kWall, &scene_));
    for (std::size_t w = 0; w < room.outline.size(); ++w) {
      const WallFrame frame = FrameOfWall(room, static_cast<int>(w));
      double begin = 0.0;
      for (const WallHole& hole : Holes(r, w)) {
        const double margin =
            layout_.passages[Index(hole.passage)].door != nullptr ? kFrameWidth
                                                                  : 0.0;
        AddBoard(room, w, begin, hole.begin - margin, finish, &builder);
        begin = hole.end + margin;
      }
      AddBoard(room, w, begin, frame.length, finish, &builder);
    }
  }

  // Along the wall from begin to end; mitred where it meets the next board.
  void AddBoard(const WorldRoom& room,
                std::size_t w,
                double begin,
                double end,
                const Finish& finish,
                MeshBuilder* builder) const {
    const WallFrame frame = FrameOfWall(room, static_cast<int>(w));
    const bool at_first = begin < 1e-6;
    const bool at_last = end > frame.length - 1e-6;
    const double front_begin = begin + (at_first ? Mitre(room, w) : 0.0);
    const double front_end =
        end - (at_last ? Mitre(room, (w + 1) % room.outline.size()) : 0.0);
    if (end - begin < 0.01 || front_end - front_begin < 0.01) return;
    const auto at = [&](double s, double y, double z) -> Eigen::Vector3d {
      return frame.X_WE * Eigen::Vector3d(s, y, z);
    };
    const double d = kSkirtingDepth;
    const double h = room.skirting_height;
    builder->AddPanel({at(front_end, d, 0.0),
                       at(front_begin, d, 0.0),
                       at(front_begin, d, h),
                       at(front_end, d, h)},
                      finish);
    builder->AddPanel({at(front_end, d, h),
                       at(front_begin, d, h),
                       at(begin, 0.0, h),
                       at(end, 0.0, h)},
                      finish);
    if (!at_first) {
      builder->AddPanel({at(begin, d, 0.0),
                         at(begin, 0.0, 0.0),
                         at(begin, 0.0, h),
                         at(begin, d, h)},
                        finish);
    }
    if (!at_last) {
      builder->AddPanel(
          {at(end, 0.0, 0.0), at(end, d, 0.0), at(end, d, h), at(end, 0.0, h)},
          finish);
    }
  }

  // How much shorter the front of a board is than its back at the first corner
  // of a wall; negative at a corner that points into the room.
  static double Mitre(const WorldRoom& room, std::size_t w) {
    const std::size_t n = room.outline.size();
    const WallFrame here = FrameOfWall(room, static_cast<int>(w));
    const WallFrame before =
        FrameOfWall(room, static_cast<int>((w + n - 1) % n));
    const Eigen::Vector3d x = here.X_WE.linear().col(0);
    const Eigen::Vector3d n1 = here.X_WE.linear().col(1);
    const Eigen::Vector3d n2 = before.X_WE.linear().col(1);
    // The point at distance d from both walls: d (n1 + n2) / (1 + n1 n2).
    const double scale = 1.0 + n1.dot(n2);
    if (scale < 0.05) return 0.0;  // A spike: no board fits in.
    return kSkirtingDepth * x.dot(n1 + n2) / scale;
  }

  // ---- openings and doors --------------------------------------------------

  void AddPassage(const Passage& passage) {
    const WorldRoom& room = world_.rooms[Index(passage.room)];
    const WallFrame frame = FrameOfWall(room, passage.wall);
    const std::string name =
        room.name + " " + NameOfWall(room, passage.wall) +
        (passage.door != nullptr ? " door " : " opening ") +
        std::to_string(passage.hole.passage);
    AddReveal(passage, frame, name);
    if (passage.door == nullptr) return;
    const Finish finish = finishes_.Get(
        passage.door->frame, passage.door->opening.where, "frame");
    MeshBuilder builder(
        &scene_.mesh, AddSurface(name + " frame", SurfaceKind::kDoor, &scene_));
    AddFrame(frame, passage.hole, finish, &builder);
    if (passage.other_room >= 0) {
      const WallFrame other = FrameOfWall(
          world_.rooms[Index(passage.other_room)], passage.other_wall);
      for (const WallHole& hole :
           Holes(Index(passage.other_room), Index(passage.other_wall))) {
        if (hole.passage == passage.hole.passage) {
          AddFrame(other, hole, finish, &builder);
        }
      }
    }
    AddLeaf(passage, name);
  }

  // What is seen of the wall's thickness: jambs, top, and the floor between.
  void AddReveal(const Passage& passage,
                 const WallFrame& frame,
                 const std::string& name) {
    const WorldRoom& room = world_.rooms[Index(passage.room)];
    const std::string& where = passage.opening->where;
    const Finish finish =
        passage.door != nullptr
            ? finishes_.Get(passage.door->frame, where, "frame")
            : finishes_.Get(room.walls[Index(passage.wall)], where, "walls");
    MeshBuilder sides(&scene_.mesh,
                      AddSurface(name + " reveal",
                                 passage.door != nullptr ? SurfaceKind::kDoor
                                                         : SurfaceKind::kWall,
                                 &scene_));
    const double b = passage.hole.begin;
    const double e = passage.hole.end;
    const double h = passage.hole.height;
    const double d = -passage.depth;
    const auto at = [&](double s, double y, double z) -> Eigen::Vector3d {
      return frame.X_WE * Eigen::Vector3d(s, y, z);
    };
    const std::vector<double> up = CutsTo(h);
    for (std::size_t k = 0; k + 1 < up.size(); ++k) {
      const double z0 = up[k];
      const double z1 = up[k + 1];
      sides.AddPanel(
          {at(b, d, z0), at(b, 0.0, z0), at(b, 0.0, z1), at(b, d, z1)},
          finish,
          {0.0, z0});
      sides.AddPanel(
          {at(e, 0.0, z0), at(e, d, z0), at(e, d, z1), at(e, 0.0, z1)},
          finish,
          {0.0, z0});
      if (passage.other_room < 0) {
        sides.AddPanel({at(e, d, z0), at(b, d, z0), at(b, d, z1), at(e, d, z1)},
                       finish);
      }
    }
    sides.AddPanel({at(b, d, h), at(b, 0.0, h), at(e, 0.0, h), at(e, d, h)},
                   finish);
    MeshBuilder floor(
        &scene_.mesh,
        AddSurface(name + " floor", SurfaceKind::kFloor, &scene_));
    floor.AddPanel(
        {at(b, d, 0.0), at(e, d, 0.0), at(e, 0.0, 0.0), at(b, 0.0, 0.0)},
        finishes_.Get(room.floor, room.where, "floor"));
  }

  static void AddFrame(const WallFrame& frame,
                       const WallHole& hole,
                       const Finish& finish,
                       MeshBuilder* builder) {
    const double left = std::max(hole.begin - kFrameWidth, 0.0);
    const double right = std::min(hole.end + kFrameWidth, frame.length);
    const double top = hole.height;
    // In the wall's frame +y looks into the room: there is no face behind.
    const unsigned faces = kAllFaces & ~static_cast<unsigned>(kRight);
    if (hole.begin - left > 1e-3) {
      builder->AddBox(frame.X_WE,
                      {left, 0.0, 0.0},
                      {hole.begin, kFrameThickness, top},
                      finish,
                      faces & ~static_cast<unsigned>(kBottom | kTop));
    }
    if (right - hole.end > 1e-3) {
      builder->AddBox(frame.X_WE,
                      {hole.end, 0.0, 0.0},
                      {right, kFrameThickness, top},
                      finish,
                      faces & ~static_cast<unsigned>(kBottom | kTop));
    }
    builder->AddBox(frame.X_WE,
                    {left, 0.0, top},
                    {right, kFrameThickness, top + kFrameWidth},
                    finish,
                    faces);
  }

  // Papers hang on doors that are drawn, others on each of their faces.
  Finish LeafFinish(const Passage& passage,
                    const Eigen::Vector3d& size,
                    bool has_handle_left) {
    const WorldDoor& door = *passage.door;
    WorldLook look = finishes_.LookOf(door.leaf, door.opening.where, "leaf");
    if (!look.image.empty() || look.pattern.kind != PatternKind::kDoor) {
      Finish finish = finishes_.Get(door.leaf, door.opening.where, "leaf");
      finish.is_mirrored = has_handle_left;
      return finish;
    }
    look.pattern.size = {size.x(), size.z()};
    look.pattern.has_handle_left = has_handle_left;
    Random random(world_.seed * 4096 +
                  static_cast<std::uint64_t>(2 * passage.hole.passage) +
                  (has_handle_left ? 1 : 0));
    look.pattern.notices = random.Bits() | 1u;
    return finishes_.Make(look, door.leaf, door.opening.where);
  }

  void AddLeaf(const Passage& passage, const std::string& name) {
    const WorldDoor& door = *passage.door;
    MeshBuilder builder(&scene_.mesh,
                        AddSurface(name, SurfaceKind::kDoor, &scene_));
    const DoorLeaf leaf = LeafOf(world_, passage);
    // An open leaf clears floor and jambs; a shut one leaves no slit.
    const double gap = door.angle == 0.0 ? 0.0 : kLeafGap;
    const Eigen::Vector3d low(gap, leaf.low, gap);
    const Eigen::Vector3d high(
        leaf.width - gap, leaf.high, passage.hole.height - gap);
    // The handle is away from the hinge, which is right on the face at -y.
    builder.AddBox(
        leaf.X_WD, low, high, LeafFinish(passage, high, false), kRight);
    builder.AddBox(
        leaf.X_WD, low, high, LeafFinish(passage, high, true), kLeft);
    builder.AddBox(leaf.X_WD,
                   low,
                   high,
                   finishes_.Get(door.frame, door.opening.where, "frame"),
                   kFront | kBack | kTop | kBottom);
  }

  const World& world_;
  const Layout& layout_;
  Finishes& finishes_;
  Scene& scene_;
  std::vector<double> levels_;
};

}  // namespace

std::uint32_t AddSurface(const std::string& name,
                         SurfaceKind kind,
                         Scene* scene) {
  scene->surfaces.push_back({name, kind});
  return static_cast<std::uint32_t>(scene->surfaces.size() - 1);
}

void BuildRooms(const World& world,
                const Layout& layout,
                Finishes* finishes,
                Scene* scene) {
  RoomBuilder(world, layout, finishes, scene).Run();
}

}  // namespace waymark
