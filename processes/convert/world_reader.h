// How the objects of a world file are read.
#pragma once

#include "drivers/simulator/world.h"
#include "processes/support/yaml_group.h"

#include <string>

namespace waymark {

// Reads objects of one file into a world, in an order in which names are known
// before they are used.
class WorldReader {
 public:
  WorldReader(std::string folder, World* world)
      : folder_(std::move(folder)), world_(world) {}

  // All but `base`, which the caller has taken.
  void Read(YamlGroup* root);

 private:
  void ReadMaterials(YamlGroup* root);
  void ReadRoom(YamlGroup room);
  void ReadOutline(YamlGroup* group, WorldRoom* room);
  void ReadWallMaterials(YamlGroup* group, WorldRoom* room);
  void ReadLamps(YamlGroup* group, WorldRoom* room);
  WorldOpening ReadOpening(YamlGroup* group);
  void ReadDoor(YamlGroup group);
  void ReadPillar(YamlGroup group);
  void ReadFurniture(YamlGroup group);
  void ReadPicture(YamlGroup group);
  void ReadPictureRow(YamlGroup group);
  void ReadLamp(YamlGroup group);
  void ReadModel(YamlGroup group);
  void ReadFloorPlan(YamlGroup group);
  void ReadPerson(YamlGroup group);
  void ReadMotion(YamlGroup* group, WorldPerson* person);
  void ReadPoses(YamlGroup* root);
  void ReadRoutes(YamlGroup* root);

  WallPlace ReadWallPlace(YamlGroup* group, bool needs_wall);
  int WallNamed(YamlGroup* group,
                const std::string& key,
                const std::string& name,
                const WorldRoom& room) const;
  WorldLook ReadLook(YamlGroup* group);
  [[nodiscard]] PatternKind PatternNamed(YamlGroup* group,
                                         const std::string& key,
                                         const std::string& name) const;
  [[nodiscard]] std::string FilePath(YamlGroup* group, const std::string& key);
  [[nodiscard]] std::string Material(YamlGroup* group,
                                     const std::string& key,
                                     const std::string& otherwise) const;
  void CheckMaterial(const YamlGroup& group,
                     const std::string& key,
                     const std::string& name) const;

  std::string folder_;
  World* world_;
};

}  // namespace waymark
