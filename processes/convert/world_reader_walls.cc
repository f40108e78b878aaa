// What is in and on the walls of a world file: openings, doors, pictures.
#include "drivers/simulator/world_layout.h"
#include "processes/convert/world_reader.h"
#include "processes/convert/world_values.h"

#include <string>
#include <utility>
#include <vector>

namespace waymark {

int WorldReader::WallNamed(YamlGroup* group,
                           const std::string& key,
                           const std::string& name,
                           const WorldRoom& room) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < room.outline.size(); ++i) {
    names.push_back(NameOfWall(room, static_cast<int>(i)));
    if (names.back() == name) return static_cast<int>(i);
  }
  group->Refuse(key, "must be a wall of that room: " + Joined(names));
}

WallPlace WorldReader::ReadWallPlace(YamlGroup* group, bool needs_wall) {
  WallPlace place;
  const auto room = group->Text("room");
  if (!room) group->Miss("room");
  place.room = *room;
  const int index = RoomNamed(*world_, *room);
  if (index < 0) {
    std::vector<std::string> names;
    for (const WorldRoom& r : world_->rooms) names.push_back(r.name);
    group->Refuse("room", "must be one of: " + Joined(names));
  }
  const WorldRoom& r = world_->rooms[static_cast<std::size_t>(index)];
  const auto wall = group->Text("wall");
  if (wall) {
    place.wall = WallNamed(group, "wall", *wall, r);
  } else if (needs_wall) {
    group->Miss("wall");
  } else {
    place.wall = -1;
  }
  if (needs_wall) {
    place.at = Required(group, "at", {0.0, FrameOfWall(r, place.wall).length});
  }
  return place;
}

WorldOpening WorldReader::ReadOpening(YamlGroup* group) {
  WorldOpening opening;
  opening.where = group->Where();
  opening.place = ReadWallPlace(group, true);
  opening.width = group->Number("width", {0.1, 100.0}).value_or(opening.width);
  opening.height = group->Number("height", {0.1, 20.0});
  return opening;
}

void WorldReader::ReadDoor(YamlGroup group) {
  WorldDoor door;
  door.opening = ReadOpening(&group);
  if (!door.opening.height) door.opening.height = 2.05;
  door.hinge = group.Choice("hinge", {"left", "right"}).value_or(0) == 0
                   ? Hinge::kLeft
                   : Hinge::kRight;
  door.angle = Degrees(&group, "open_deg", {-170.0, 170.0});
  door.leaf = Material(&group, "leaf", door.leaf);
  door.frame = Material(&group, "frame", door.frame);
  group.Finish();
  world_->doors.push_back(std::move(door));
}

void WorldReader::ReadPicture(YamlGroup group) {
  WorldPicture picture;
  picture.where = group.Where();
  picture.place = ReadWallPlace(&group, true);
  picture.height = group.Number("height", {0.0, 20.0}).value_or(picture.height);
  if (const auto size = group.Numbers("size", 2, {0.02, kMaxPatternSize})) {
    picture.size = Vector2Of(*size);
  }
  // The look takes the picture's size; one of its own would not be used.
  picture.look.pattern.kind = PatternKind::kPicture;
  if (!group.Has("pattern") && !group.Has("image")) {
    picture.look.pattern.seed = Seed(&group, 1);
    if (const auto text = group.Text("text")) picture.look.pattern.text = *text;
  } else {
    picture.look = ReadLook(&group);
  }
  group.Finish();
  world_->pictures.push_back(std::move(picture));
}

void WorldReader::ReadPictureRow(YamlGroup group) {
  WorldPictureRow row;
  row.where = group.Where();
  const WallPlace place = ReadWallPlace(&group, false);
  row.room = place.room;
  row.wall = place.wall;
  row.spacing = group.Number("spacing", {0.3, 100.0}).value_or(row.spacing);
  row.height = group.Number("height", {0.2, 20.0}).value_or(row.height);
  if (const auto size = group.Numbers("widths", 2, {0.1, 5.0})) {
    row.size = Vector2Of(*size);
    if (row.size.y() < row.size.x()) {
      group.Refuse("widths", "must be the smallest, then the largest");
    }
  }
  if (const auto pattern = group.Text("pattern")) {
    row.patterns = {PatternNamed(&group, "pattern", *pattern)};
  }
  row.seed = Seed(&group, 1);
  group.Finish();
  world_->picture_rows.push_back(std::move(row));
}

}  // namespace waymark
