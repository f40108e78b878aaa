// People of a world file, and where robots start, stop and drive.
#include "estimation/base/input_error.h"
#include "processes/convert/world_reader.h"
#include "processes/convert/world_values.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace waymark {
namespace {

// waymark-world info prints a name as one word of a line.
void CheckWord(const YamlGroup& group, const std::string& name) {
  const bool is_word =
      !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        // Letters beyond ASCII have bytes above it.
        return static_cast<unsigned char>(c) > ' ' && c != '\x7f';
      });
  if (!is_word) {
    throw InputError(group.Where() + ": " + Quoted(name) +
                     ": names must be of one word, without blanks");
  }
}

}  // namespace

void WorldReader::ReadPerson(YamlGroup group) {
  WorldPerson person;
  person.name = group.Text("name").value_or(
      "person " + std::to_string(world_->people.size() + 1));
  CheckIsOneLine(group, "name", person.name);
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
      world_->starts.push_back(
          {root->Where() + "starts[" + std::to_string(i) + "]",
           name,
           pose((*rows)[i])});
    }
  }
  auto places = root->Group("places");
  if (!places) return;
  for (const std::string& name : places->keys()) {
    CheckWord(*places, name);
    const auto row = places->Numbers(name, 3, {-360.0, 360.0});
    Put(WorldPose{places->Where(name), name, pose(*row)}, &world_->places);
  }
}

void WorldReader::ReadRoutes(YamlGroup* root) {
  auto routes = root->Group("routes");
  if (!routes) return;
  for (const std::string& name : routes->keys()) {
    CheckWord(*routes, name);
    const auto rows = routes->Rows(name, 2, 2, kCoordinate);
    Put(WorldRoute{routes->Where(name), name, Points(*rows)}, &world_->routes);
  }
}

}  // namespace waymark
