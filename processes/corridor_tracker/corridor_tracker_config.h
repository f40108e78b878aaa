// Configuration of corridor_tracker.
#pragma once

#include "estimation/corridor/corridor_tracker.h"
#include "processes/support/describer.h"

#include <cstdint>
#include <string>

namespace waymark {

struct CorridorTrackerConfig {
  std::string camera = "FRONT";    // As in IMAGE_<camera>.
  std::string calibration;         // File; empty: CAMERA_INFO_<camera>.
  std::string corridors;           // File, or name of a shipped one.
  CorridorTrackerOptions tracker;  // But for these two:
  std::int64_t paper_points_kept = 30;
  std::int64_t paper_candidates_kept = 4;

  void Describe(Describer& d);
  [[nodiscard]] CorridorTrackerOptions Options() const;
  // Throws std::invalid_argument naming the key.
  void Check() const;
  // Throws InputError where a file cannot be used.
  void CheckFiles() const;

 private:
  void DescribePaper(Describer& d);
};

}  // namespace waymark
