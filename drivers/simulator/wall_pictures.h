// What hangs on the walls, and where.
#pragma once

#include "drivers/simulator/world.h"
#include "drivers/simulator/world_layout.h"

#include <vector>

namespace waymark {

struct HungPicture {
  std::string where;
  int room = 0;
  int wall = 0;
  double along = 0.0;  // Of its middle, on the wall's x axis.
  double height = 0.0;
  Eigen::Vector2d size = Eigen::Vector2d::Zero();
  WorldLook look;
};

// World::pictures, then those of World::picture_rows: they keep clear of
// doors, openings and each other. Seeds have World::seed mixed in. Throws
// InputError where a picture is not within its wall or is over a hole in it.
[[nodiscard]] std::vector<HungPicture> HangPictures(const World& world,
                                                    const Layout& layout);

}  // namespace waymark
