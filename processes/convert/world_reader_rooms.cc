// Rooms of a world file.
#include "drivers/simulator/world_layout.h"
#include "estimation/base/input_error.h"
#include "processes/convert/world_reader.h"
#include "processes/convert/world_values.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace waymark {
namespace {

constexpr int kMaxLamps = 100;  // Of a room, along each side.
constexpr double kLampSpacing = 3.0;

}  // namespace

void WorldReader::ReadRoom(YamlGroup group) {
  WorldRoom room;
  const auto name = group.Text("name");
  if (!name) group.Miss("name");
  CheckIsOneLine(group, "name", *name);
  room.name = *name;
  if (RoomNamed(*world_, room.name) >= 0) {
    group.Refuse("name", "must not be that of another room");
  }
  room.where = group.Where(room.name);
  ReadOutline(&group, &room);
  room.height = group.Number("height", {1.0, 20.0}).value_or(room.height);
  room.floor = Material(&group, "floor", room.floor);
  room.ceiling = Material(&group, "ceiling", room.ceiling);
  room.skirting = Material(&group, "skirting", room.skirting);
  room.skirting_height = group.Number("skirting_height", {0.0, 1.0})
                             .value_or(room.skirting_height);
  ReadWallMaterials(&group, &room);
  ReadLamps(&group, &room);
  group.Finish();
  world_->rooms.push_back(std::move(room));
}

void WorldReader::ReadOutline(YamlGroup* group, WorldRoom* room) {
  if (const auto box = group->Numbers("rectangle", 4, kCoordinate)) {
    const double west = (*box)[0];
    const double south = (*box)[1];
    const double east = (*box)[2];
    const double north = (*box)[3];
    if (east - west < 0.1 || north - south < 0.1) {
      group->Refuse("rectangle",
                    "must be [west, south, east, north], 0.1 m wide or wider");
    }
    room->is_rectangle = true;
    room->outline = {
        {west, south}, {east, south}, {east, north}, {west, north}};
    if (group->Has("outline")) {
      group->Refuse("outline", "must not be beside a rectangle");
    }
    return;
  }
  const auto rows = group->Rows("outline", 3, 2, kCoordinate);
  if (!rows) group->Miss("rectangle");
  if (rows->size() > 200) {
    group->Refuse("outline", "must have at most 200 corners");
  }
  room->outline = Points(*rows);
}

// One material, or one for each wall named and `other`.
void WorldReader::ReadWallMaterials(YamlGroup* group, WorldRoom* room) {
  const std::string usual = Material(group, "walls", "plaster");
  room->walls.assign(room->outline.size(), usual);
  auto walls = group->Group("wall_materials");
  if (!walls) return;
  for (const std::string& name : walls->keys()) {
    const int wall = WallNamed(&*walls, name, name, *room);
    room->walls[static_cast<std::size_t>(wall)] =
        Material(&*walls, name, usual);
  }
  walls->Finish();
}

void WorldReader::ReadLamps(YamlGroup* group, WorldRoom* room) {
  room->light = group->Number("light", kLight).value_or(room->light);
  if (const auto size = group->Numbers("lamp_size", 2, {0.05, 5.0})) {
    room->lamp_size = Vector2Of(*size);
  }
  if (const auto grid = group->Numbers("lamps", 2, {0.0, kMaxLamps})) {
    for (std::size_t i = 0; i < 2; ++i) {
      if ((*grid)[i] != std::floor((*grid)[i])) {
        group->Refuse("lamps", "must be two whole numbers");
      }
      room->lamps[i] = static_cast<int>((*grid)[i]);
    }
    return;
  }
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : room->outline) box.extend(p);
  for (int i = 0; i < 2; ++i) {
    room->lamps[static_cast<std::size_t>(i)] =
        std::clamp(static_cast<int>(std::round(box.sizes()[i] / kLampSpacing)),
                   1,
                   kMaxLamps);
  }
}

}  // namespace waymark
