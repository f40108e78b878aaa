#include "processes/convert/world_reader.h"

#include "drivers/simulator/build_furniture.h"
#include "drivers/simulator/finishes.h"
#include "drivers/simulator/world_layout.h"
#include "processes/support/configuration_range.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <utility>

namespace waymark {
namespace {

constexpr Range kCoordinate{-200.0, 200.0};  // m; what a float resolves finely.
constexpr Range kHeading{-360.0, 360.0};     // Degrees.
constexpr Range kLight{0.0, 10.0};
constexpr std::int64_t kMaxSeed = std::numeric_limits<std::int64_t>::max();
constexpr int kMaxLamps = 100;  // Of a room, along each side.
constexpr double kLampSpacing = 3.0;
constexpr std::size_t kMaxObjects = 10000;  // Of each kind.

Eigen::Vector2d Vector2Of(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1]};
}

double Required(YamlGroup* group, const std::string& key, Range range) {
  const auto value = group->Number(key, range);
  if (!value) group->Miss(key);
  return *value;
}

Eigen::Vector2d RequiredPoint(YamlGroup* group, const std::string& key) {
  const auto numbers = group->Numbers(key, 2, kCoordinate);
  if (!numbers) group->Miss(key);
  return Vector2Of(*numbers);
}

double Degrees(YamlGroup* group, const std::string& key, Range range) {
  return group->Number(key, range).value_or(0.0) * kRadiansPerDegree;
}

std::uint64_t Seed(YamlGroup* group, std::uint64_t otherwise) {
  return static_cast<std::uint64_t>(
      group->Integer("seed", 0, kMaxSeed)
          .value_or(static_cast<std::int64_t>(otherwise)));
}

std::vector<YamlGroup> Objects(YamlGroup* root, const std::string& key) {
  std::vector<YamlGroup> groups = root->Groups(key);
  if (groups.size() > kMaxObjects) {
    root->Refuse(key,
                 "must be at most " + std::to_string(kMaxObjects) + " objects");
  }
  return groups;
}

std::vector<Eigen::Vector2d> Points(
    const std::vector<std::vector<double>>& rows) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& row : rows) points.push_back(Vector2Of(row));
  return points;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

// "${NAME}" by the environment.
std::string Expanded(const YamlGroup& group,
                     const std::string& key,
                     const std::string& text) {
  const std::size_t begin = text.find("${");
  if (begin == std::string::npos) return text;
  const std::size_t end = text.find('}', begin);
  if (end == std::string::npos) group.Refuse(key, "has no } behind its ${");
  const std::string name = text.substr(begin + 2, end - begin - 2);
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) {
    group.Refuse(key, "needs the environment variable " + name);
  }
  return text.substr(0, begin) + value +
         Expanded(group, key, text.substr(end + 1));
}

}  // namespace

void WorldReader::Read(YamlGroup* root) {
  if (const auto name = root->Text("name")) world_->name = *name;
  world_->seed = Seed(root, world_->seed);
  world_->ambient = root->Number("ambient", kLight).value_or(world_->ambient);
  ReadMaterials(root);
  for (YamlGroup& g : Objects(root, "rooms")) ReadRoom(std::move(g));
  for (YamlGroup& g : Objects(root, "openings")) {
    world_->openings.push_back(ReadOpening(&g));
    g.Finish();
  }
  for (YamlGroup& g : Objects(root, "doors")) ReadDoor(std::move(g));
  for (YamlGroup& g : Objects(root, "pillars")) ReadPillar(std::move(g));
  for (YamlGroup& g : Objects(root, "furniture")) ReadFurniture(std::move(g));
  for (YamlGroup& g : Objects(root, "pictures")) ReadPicture(std::move(g));
  for (YamlGroup& g : Objects(root, "picture_rows")) {
    ReadPictureRow(std::move(g));
  }
  for (YamlGroup& g : Objects(root, "lamps")) ReadLamp(std::move(g));
  for (YamlGroup& g : Objects(root, "models")) ReadModel(std::move(g));
  for (YamlGroup& g : Objects(root, "floor_plans")) ReadFloorPlan(std::move(g));
  for (YamlGroup& g : Objects(root, "people")) ReadPerson(std::move(g));
  ReadPoses(root);
  ReadRoutes(root);
  root->Finish();
}

// ---- materials -------------------------------------------------------------

void WorldReader::ReadMaterials(YamlGroup* root) {
  auto materials = root->Group("materials");
  if (!materials) return;
  for (const std::string& name : materials->keys()) {
    auto group = materials->Group(name);
    WorldMaterial material;
    material.where = group->Where();
    material.name = name;
    material.look = ReadLook(&*group);
    group->Finish();
    world_->materials.push_back(std::move(material));
  }
}

// pattern, color, size, text, seed; or image and size.
WorldLook WorldReader::ReadLook(YamlGroup* group) {
  WorldLook look;
  const auto pattern = group->Text("pattern");
  if (group->Has("image")) {
    look.image = FilePath(group, "image");
    if (pattern) group->Refuse("image", "must not be beside a pattern");
  }
  if (pattern) look.pattern.kind = PatternNamed(group, "pattern", *pattern);
  if (const auto color =
          group->Numbers("color",
                         3,
                         {static_cast<double>(kMinPatternValue),
                          static_cast<double>(kMaxPatternValue)})) {
    look.pattern.color = cv::Vec3b(static_cast<std::uint8_t>((*color)[2]),
                                   static_cast<std::uint8_t>((*color)[1]),
                                   static_cast<std::uint8_t>((*color)[0]));
  }
  if (const auto size = group->Numbers("size", 2, {0.01, kMaxPatternSize})) {
    look.image_size = Vector2Of(*size);
    if (look.image.empty()) {
      if (!IsOnePiece(look.pattern.kind)) {
        group->Refuse("size", "is for images: this pattern has its own");
      }
      look.pattern.size = Vector2Of(*size);
    }
  } else if (!look.image.empty()) {
    group->Miss("size");
  }
  if (const auto text = group->Text("text")) look.pattern.text = *text;
  look.pattern.seed = Seed(group, 1);
  return look;
}

PatternKind WorldReader::PatternNamed(YamlGroup* group,
                                      const std::string& key,
                                      const std::string& name) const {
  const auto kind = PatternFromName(name);
  if (!kind) group->Refuse(key, "must be one of: " + Joined(PatternNames()));
  return *kind;
}

std::string WorldReader::FilePath(YamlGroup* group, const std::string& key) {
  const auto text = group->Text(key);
  if (!text) group->Miss(key);
  const std::filesystem::path path =
      std::filesystem::path(folder_) / Expanded(*group, key, *text);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    group->Refuse(key, "there is no file " + path.string());
  }
  return path.string();
}

std::string WorldReader::Material(YamlGroup* group,
                                  const std::string& key,
                                  const std::string& otherwise) const {
  const auto name = group->Text(key);
  if (!name) return otherwise;
  CheckMaterial(*group, key, *name);
  return *name;
}

void WorldReader::CheckMaterial(const YamlGroup& group,
                                const std::string& key,
                                const std::string& name) const {
  if (BuiltInFinish(name)) return;
  std::vector<std::string> known;
  for (const WorldMaterial& material : world_->materials) {
    if (material.name == name) return;
    known.push_back(material.name);
  }
  for (const std::string& built_in : BuiltInFinishNames()) {
    known.push_back(built_in);
  }
  group.Refuse(key, "must be one of: " + Joined(known));
}

// ---- rooms -----------------------------------------------------------------

void WorldReader::ReadRoom(YamlGroup group) {
  WorldRoom room;
  const auto name = group.Text("name");
  if (!name) group.Miss("name");
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

// ---- on walls --------------------------------------------------------------

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

// ---- on floors -------------------------------------------------------------

void WorldReader::ReadPillar(YamlGroup group) {
  WorldPillar pillar;
  pillar.where = group.Where();
  pillar.at = RequiredPoint(&group, "at");
  pillar.shape = group.Choice("shape", {"square", "round"}).value_or(0) == 0
                     ? PillarShape::kSquare
                     : PillarShape::kRound;
  pillar.size = group.Number("size", {0.02, 10.0}).value_or(pillar.size);
  pillar.heading = Degrees(&group, "heading_deg", kHeading);
  pillar.material = Material(&group, "material", pillar.material);
  group.Finish();
  world_->pillars.push_back(std::move(pillar));
}

void WorldReader::ReadFurniture(YamlGroup group) {
  WorldFurniture piece;
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(FurnitureKind::kBox); ++i) {
    names.push_back(NameOf(static_cast<FurnitureKind>(i)));
  }
  const auto kind = group.Choice("kind", names);
  if (!kind) group.Miss("kind");
  piece.kind = static_cast<FurnitureKind>(*kind);
  piece.where = group.Where(names[static_cast<std::size_t>(*kind)]);
  piece.at = RequiredPoint(&group, "at");
  piece.z = group.Number("z", {0.0, 20.0}).value_or(0.0);
  piece.heading = Degrees(&group, "heading_deg", kHeading);
  piece.size = UsualSize(piece.kind);
  if (const auto size = group.Numbers("size", 3, {0.02, 20.0})) {
    piece.size << (*size)[0], (*size)[1], (*size)[2];
  }
  piece.material = Material(&group, "material", "");
  piece.seed = Seed(&group, world_->furniture.size() + 1);
  group.Finish();
  world_->furniture.push_back(std::move(piece));
}

void WorldReader::ReadLamp(YamlGroup group) {
  WorldLamp lamp;
  lamp.where = group.Where();
  const auto at = group.Numbers("at", 3, kCoordinate);
  if (!at) group.Miss("at");
  lamp.at << (*at)[0], (*at)[1], (*at)[2];
  if (const auto size = group.Numbers("size", 2, {0.05, 5.0})) {
    lamp.size = Vector2Of(*size);
  }
  lamp.light = group.Number("light", kLight).value_or(lamp.light);
  group.Finish();
  world_->lamps.push_back(std::move(lamp));
}

void WorldReader::ReadModel(YamlGroup group) {
  WorldModel model;
  model.where = group.Where();
  model.file = FilePath(&group, "file");
  model.scale = group.Number("scale", {1e-6, 1e6}).value_or(model.scale);
  if (const auto at = group.Numbers("at", 3, kCoordinate)) {
    model.at << (*at)[0], (*at)[1], (*at)[2];
  }
  model.heading = Degrees(&group, "heading_deg", kHeading);
  model.is_y_up = group.Choice("up", {"y", "z"}).value_or(0) == 0;
  model.has_baked_light =
      group.Flag("baked_light").value_or(model.has_baked_light);
  group.Finish();
  world_->models.push_back(std::move(model));
}

void WorldReader::ReadFloorPlan(YamlGroup group) {
  WorldFloorPlan plan;
  plan.where = group.Where();
  plan.image = FilePath(&group, "image");
  plan.metres_per_pixel = Required(&group, "metres_per_pixel", {1e-4, 10.0});
  if (group.Has("at")) plan.at = RequiredPoint(&group, "at");
  plan.height = group.Number("height", {1.0, 20.0}).value_or(plan.height);
  plan.floor = Material(&group, "floor", plan.floor);
  plan.walls = Material(&group, "walls", plan.walls);
  plan.ceiling = Material(&group, "ceiling", plan.ceiling);
  group.Finish();
  world_->floor_plans.push_back(std::move(plan));
}

// ---- people, poses, routes -------------------------------------------------

void WorldReader::ReadPerson(YamlGroup group) {
  WorldPerson person;
  person.name = group.Text("name").value_or(
      "person " + std::to_string(world_->people.size() + 1));
  person.where = group.Where(person.name);
  person.height = group.Number("height", {1.2, 2.2}).value_or(person.height);
  person.seed = Seed(&group, world_->people.size() + 1);
  ReadMotion(&group, &person);
  group.Finish();
  world_->people.push_back(std::move(person));
}

void WorldReader::ReadMotion(YamlGroup* group, WorldPerson* person) {
  const auto motion = group->Choice("motion", {"stand", "walk", "beside"});
  if (!motion) group->Miss("motion");
  person->motion = static_cast<PersonMotion>(*motion);
  switch (person->motion) {
    case PersonMotion::kStand:
      person->at = RequiredPoint(group, "at");
      person->heading = Degrees(group, "heading_deg", kHeading);
      return;
    case PersonMotion::kWalk: {
      const auto rows = group->Rows("path", 2, 2, kCoordinate);
      if (!rows) group->Miss("path");
      person->path = Points(*rows);
      person->is_closed = group->Flag("closed").value_or(false);
      person->speed = group->Number("speed", {0.0, 5.0}).value_or(1.0);
      person->start = group->Number("start", {0.0, 1e4}).value_or(0.0);
      double length = 0.0;
      for (std::size_t i = 1; i < person->path.size(); ++i) {
        length += (person->path[i] - person->path[i - 1]).norm();
      }
      if (!(length > 0.0)) group->Refuse("path", "must have a length");
      return;
    }
    case PersonMotion::kBeside:
      person->bearing = Degrees(group, "bearing_deg", kHeading);
      person->clearance =
          group->Number("clearance", {0.0, 10.0}).value_or(person->clearance);
      return;
  }
}

void WorldReader::ReadPoses(YamlGroup* root) {
  const auto pose = [](const std::vector<double>& row) -> Pose2 {
    return {row[0], row[1], std::remainder(row[2], 360.0) * kRadiansPerDegree};
  };
  if (const auto rows = root->Rows("starts", 1, 3, {-360.0, 360.0})) {
    world_->starts.clear();  // Those of a base.
    for (std::size_t i = 0; i < rows->size(); ++i) {
      const std::string name = "start " + std::to_string(i);
      world_->starts.push_back({root->Where() + name, name, pose((*rows)[i])});
    }
  }
  auto places = root->Group("places");
  if (!places) return;
  for (const std::string& name : places->keys()) {
    const auto row = places->Numbers(name, 3, {-360.0, 360.0});
    world_->places.push_back({places->Where(name), name, pose(*row)});
  }
}

void WorldReader::ReadRoutes(YamlGroup* root) {
  auto routes = root->Group("routes");
  if (!routes) return;
  for (const std::string& name : routes->keys()) {
    const auto rows = routes->Rows(name, 2, 2, kCoordinate);
    world_->routes.push_back({routes->Where(name), name, Points(*rows)});
  }
}

}  // namespace waymark
