#include "processes/convert/world_file.h"

#include "estimation/base/input_error.h"
#include "processes/convert/world_reader.h"
#include "processes/support/shipped_file.h"
#include "processes/support/yaml_group.h"

#include <filesystem>
#include <string>

namespace waymark {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxBases = 8;  // Files built upon each other.

void ReadWorld(const std::string& yaml,
               const std::string& source,
               int depth,
               World* world) {
  YamlGroup root(LoadYamlDocument(yaml, source), source);
  const fs::path folder = fs::path(source).parent_path();
  if (const auto base = root.Text("base")) {
    if (depth == kMaxBases) {
      root.Refuse("base",
                  "must not build upon more than " + std::to_string(kMaxBases) +
                      " files");
    }
    const std::string path = (folder / *base).string();
    if (!fs::is_regular_file(path)) {
      root.Refuse("base", "must be a world file beside this one");
    }
    ReadWorld(ReadTextFile(path), path, depth + 1, world);
  }
  world->source = source;
  WorldReader(folder.string(), world).Read(&root);
}

}  // namespace

World WorldFromYaml(const std::string& yaml, const std::string& source) {
  World world;
  ReadWorld(yaml, source, 0, &world);
  if (world.name.empty()) world.name = fs::path(source).stem().string();
  return world;
}

World LoadWorldFile(const std::string& path) {
  return WorldFromYaml(ReadTextFile(path), path);
}

std::string FindWorldFile(const std::string& name) {
  return FindShippedFile(name, "worlds", "drivers/simulator/worlds", ".yaml");
}

}  // namespace waymark
