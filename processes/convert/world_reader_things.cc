// What stands or hangs in the rooms of a world file: pillars, furniture, lamps,
// models, floor plans.
#include "drivers/simulator/build_furniture.h"
#include "processes/convert/world_reader.h"
#include "processes/convert/world_values.h"

#include <string>
#include <utility>
#include <vector>

namespace waymark {

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

}  // namespace waymark
