#include "drivers/simulator/wall_pictures.h"

#include "estimation/base/input_error.h"
#include "estimation/base/random.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

constexpr double kSlack = 1e-6;
// Free wall around each picture of a row, beside doors with their frames too.
constexpr double kMargin = 0.12;

std::uint64_t Mix(std::uint64_t a, std::uint64_t b) {
  Random random(a ^ (b * 0x9E3779B97F4A7C15ull));
  return random.Bits();
}

// Room in the horizontal for pictures: between holes and other pictures.
bool IsFree(const HungPicture& picture,
            double margin,
            double wall_length,
            const std::vector<WallHole>& holes,
            const std::vector<HungPicture>& others) {
  const double begin = picture.along - picture.size.x() / 2.0 - margin;
  const double end = picture.along + picture.size.x() / 2.0 + margin;
  if (begin < -kSlack || end > wall_length + kSlack) return false;
  const double bottom = picture.height - picture.size.y() / 2.0;
  for (const WallHole& hole : holes) {
    if (hole.begin < end - kSlack && begin < hole.end - kSlack &&
        bottom - margin < hole.height - kSlack) {
      return false;
    }
  }
  return std::none_of(others.begin(), others.end(), [&](const auto& other) {
    return other.room == picture.room && other.wall == picture.wall &&
           std::abs(other.along - picture.along) <
               (other.size.x() + picture.size.x()) / 2.0 + margin - kSlack &&
           std::abs(other.height - picture.height) <
               (other.size.y() + picture.size.y()) / 2.0 + margin - kSlack;
  });
}

int RequireRoom(const World& world,
                const std::string& name,
                const std::string& where) {
  const int room = RoomNamed(world, name);
  if (room < 0) {
    throw InputError(where + ": room = " + name + ": no such room");
  }
  return room;
}

HungPicture Hang(const World& world,
                 const Layout& layout,
                 const WorldPicture& picture) {
  HungPicture hung;
  hung.where = picture.where;
  hung.room = RequireRoom(world, picture.place.room, picture.where);
  hung.wall = picture.place.wall;
  hung.height = picture.height;
  hung.size = picture.size;
  hung.look = picture.look;
  hung.look.pattern.seed = Mix(picture.look.pattern.seed, world.seed);
  const auto r = static_cast<std::size_t>(hung.room);
  const auto w = static_cast<std::size_t>(hung.wall);
  const WorldRoom& room = world.rooms[r];
  hung.along = AlongWall(room, picture.place);
  if (hung.height - hung.size.y() / 2.0 < -kSlack ||
      hung.height + hung.size.y() / 2.0 > room.height + kSlack) {
    throw InputError(picture.where +
                     ": height: it must be between floor and ceiling");
  }
  if (!IsFree(hung,
              0.0,
              FrameOfWall(room, hung.wall).length,
              layout.holes[r][w],
              {})) {
    throw InputError(picture.where +
                     ": at: it must be within its wall, beside its openings");
  }
  return hung;
}

class RowHanger {
 public:
  RowHanger(const World& world,
            const Layout& layout,
            const WorldPictureRow& row,
            std::vector<HungPicture>* hung)
      : world_(world),
        layout_(layout),
        row_(row),
        random_(Mix(row.seed, world.seed)),
        hung_(hung) {}

  void Run() {
    const int room = RequireRoom(world_, row_.room, row_.where);
    const auto walls = static_cast<int>(
        world_.rooms[static_cast<std::size_t>(room)].outline.size());
    for (int wall = 0; wall < walls; ++wall) {
      if (row_.wall < 0 || row_.wall == wall) HangAlong(room, wall);
    }
  }

 private:
  void HangAlong(int room, int wall) {
    const WorldRoom& r = world_.rooms[static_cast<std::size_t>(room)];
    const double length = FrameOfWall(r, wall).length;
    const int count = static_cast<int>(std::floor(length / row_.spacing + 0.5));
    for (int i = 0; i < count; ++i) {
      HungPicture picture = Next(r.height);
      picture.room = room;
      picture.wall = wall;
      // All draws happen, hung or not, so that one more door changes the rest
      // of the wall no more than it must.
      const double shift = random_.Uniform(-0.15, 0.15) * row_.spacing;
      const double middle = (i + 0.5) * length / count + shift;
      Place(middle, length, &picture);
    }
  }

  HungPicture Next(double room_height) {
    HungPicture picture;
    picture.where = row_.where;
    const PatternKind kind = row_.patterns[random_.Index(row_.patterns.size())];
    const double width = random_.Uniform(row_.size.x(), row_.size.y());
    const double aspect = random_.Uniform(0.65, 1.4);
    picture.size = {width, std::min(width * aspect, 0.6 * room_height)};
    picture.height = row_.height + random_.Uniform(-0.1, 0.1);
    picture.height = std::clamp(picture.height,
                                picture.size.y() / 2.0 + 0.2,
                                room_height - picture.size.y() / 2.0 - 0.05);
    picture.look.pattern.kind = kind;
    picture.look.pattern.seed = random_.Bits();
    return picture;
  }

  // At the wanted place or the nearest free one within half a spacing.
  void Place(double middle, double length, HungPicture* picture) {
    const std::vector<WallHole>& holes =
        layout_.holes[static_cast<std::size_t>(picture->room)]
                     [static_cast<std::size_t>(picture->wall)];
    constexpr int kSteps = 8;
    for (int k = 0; k <= 2 * kSteps; ++k) {
      const int step = (k + 1) / 2 * (k % 2 == 1 ? 1 : -1);
      picture->along = middle + row_.spacing * 0.5 * step / kSteps;
      if (IsFree(*picture, kMargin, length, holes, *hung_)) {
        hung_->push_back(*picture);
        return;
      }
    }
  }

  const World& world_;
  const Layout& layout_;
  const WorldPictureRow& row_;
  Random random_;
  std::vector<HungPicture>* hung_;
};

}  // namespace

std::vector<HungPicture> HangPictures(const World& world,
                                      const Layout& layout) {
  std::vector<HungPicture> hung;
  for (const WorldPicture& picture : world.pictures) {
    hung.push_back(Hang(world, layout, picture));
  }
  for (const WorldPictureRow& row : world.picture_rows) {
    RowHanger(world, layout, row, &hung).Run();
  }
  return hung;
}

}  // namespace waymark
