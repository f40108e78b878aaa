#include "processes/convert/corridor_file.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "processes/support/shipped_file.h"
#include "processes/support/yaml_group.h"

#include <set>
#include <stdexcept>

namespace waymark {
namespace {

// A building's size, m.
constexpr Range kPlace{-1e5, 1e5};

CorridorGeometry CorridorOf(YamlGroup* group) {
  CorridorGeometry corridor;
  if (const auto name = group->Text("name")) {
    if (name->empty()) group->Refuse("name", "must not be empty");
    corridor.name = *name;
  } else {
    group->Miss("name");
  }
  corridor.width = group->Number("width", {0.3, 50.0});
  corridor.height = group->Number("height", {0.5, 50.0});
  corridor.skirting_height = group->Number("skirting_height", {0.005, 1.0});
  corridor.skirting_depth =
      group->Number("skirting_depth", {0.0, 0.1}).value_or(0.0);
  if (const auto x = group->Numbers("x", 2, kPlace)) {
    corridor.x_min = (*x)[0];
    corridor.x_max = (*x)[1];
  }
  if (const auto axis = group->Numbers("axis_W", 3, kPlace)) {
    corridor.X_WL = {
        (*axis)[0], (*axis)[1], WrapAngle(RadiansFromDegrees((*axis)[2]))};
  } else {
    group->Miss("axis_W");
  }
  group->Finish();
  try {
    corridor.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError(group->Where(corridor.name) + ": " + error.what());
  }
  return corridor;
}

}  // namespace

std::vector<CorridorGeometry> CorridorsFromYaml(const std::string& yaml,
                                                const std::string& source) {
  YamlGroup root(LoadYamlDocument(yaml, source), source);
  std::vector<CorridorGeometry> corridors;
  std::set<std::string> names;
  for (YamlGroup& group : root.Groups("corridors")) {
    corridors.push_back(CorridorOf(&group));
    if (!names.insert(corridors.back().name).second) {
      group.Refuse("name", "given twice");
    }
  }
  root.Finish();
  if (corridors.empty()) throw InputError(source + ": corridors: none given");
  return corridors;
}

std::vector<CorridorGeometry> LoadCorridorFile(const std::string& path) {
  return CorridorsFromYaml(ReadYamlFile(path), path);
}

std::string FindCorridorFile(const std::string& name) {
  return FindShippedFile(
      name, "corridors", "processes/corridor_tracker/corridors", ".yaml");
}

}  // namespace waymark
