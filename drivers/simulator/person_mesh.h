// A person, for a scene that people stand or walk in.
#pragma once

#include "drivers/simulator/scene.h"

#include <cstdint>
#include <string>

namespace waymark {

enum class PersonPose : std::uint8_t { kStanding, kMidStep };

struct PersonOptions {
  double height = 1.75;  // m, from the soles to the top of the hair.
  // Of the upright cylinder that holds everything: arms and, in mid-step, the
  // legs' spread are made to fit. m.
  double radius = 0.25;
  PersonPose pose = PersonPose::kStanding;
  // Clothes, skin, hair, build: another person for every seed.
  std::uint64_t seed = 1;

  // Throws std::invalid_argument naming the first field out of range.
  void Check() const;
};

// Appends a person who looks along x to the scene's movers, and their
// materials and one surface `name` to the scene. About 3,000 triangles; the
// same options give the same mesh. Returns the index in Scene::movers.
std::size_t AppendPerson(const std::string& name,
                         const PersonOptions& options,
                         Scene* scene);

}  // namespace waymark
