#include "processes/convert/world_reader.h"

#include "drivers/simulator/finishes.h"
#include "drivers/simulator/world_layout.h"
#include "processes/convert/world_values.h"

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace waymark {
namespace {

constexpr std::size_t kMaxObjects = 10000;  // Of each kind.

std::vector<YamlGroup> Objects(YamlGroup* root, const std::string& key) {
  std::vector<YamlGroup> groups = root->Groups(key);
  if (groups.size() > kMaxObjects) {
    root->Refuse(key,
                 "must be at most " + std::to_string(kMaxObjects) + " objects");
  }
  return groups;
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
    Put(std::move(material), &world_->materials);
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

}  // namespace waymark
