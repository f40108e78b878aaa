// Configuration of corridor_tracker.
#pragma once

#include "estimation/corridor/corridor_tracker.h"
#include "processes/support/describer.h"

#include <string>

namespace waymark {

struct CorridorTrackerConfig {
  std::string camera = "FRONT";  // As in IMAGE_<camera>.
  std::string calibration;       // File; empty: CAMERA_INFO_<camera>.
  std::string corridors = "corridor_office";  // File, or name of a shipped one.
  CorridorTrackerOptions tracker;

  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
  // Throws InputError where a file cannot be used.
  void CheckFiles() const;
};

}  // namespace waymark
