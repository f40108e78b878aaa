#include "processes/convert/world_file.h"

#include "drivers/simulator/random_world.h"
#include "estimation/base/input_error.h"
#include "processes/convert/world_reader.h"
#include "processes/support/shipped_file.h"
#include "processes/support/yaml_group.h"

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <system_error>

namespace waymark {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFolder = "worlds";
constexpr std::string_view kSourceFolder = "drivers/simulator/worlds";
constexpr std::string_view kExtension = ".yaml";
constexpr int kMaxBases = 8;  // Files built upon each other.

// nullopt for the name of a file.
std::optional<std::uint64_t> RandomSeedOf(const std::string& name) {
  if (!name.starts_with(kRandomWorld)) return std::nullopt;
  const char* begin = name.data() + kRandomWorld.size();
  const char* end = name.data() + name.size();
  std::uint64_t seed = 0;
  const auto [last, error] = std::from_chars(begin, end, seed);
  if (begin == end || last != end || error != std::errc()) {
    throw InputError("world '" + name +
                     "': after random: must follow a whole number, 0 to " +
                     std::to_string(std::numeric_limits<std::uint64_t>::max()));
  }
  return seed;
}

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
    ReadWorld(ReadYamlFile(path), path, depth + 1, world);
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
  if (const auto seed = RandomSeedOf(path)) return RandomWorld(*seed);
  return WorldFromYaml(ReadYamlFile(path), path);
}

std::string FindWorldFile(const std::string& name) {
  if (RandomSeedOf(name)) return name;
  return FindShippedFile(name, kFolder, kSourceFolder, kExtension);
}

std::set<std::string> WorldNames() {
  return ShippedNames(kFolder, kSourceFolder, kExtension);
}

}  // namespace waymark
