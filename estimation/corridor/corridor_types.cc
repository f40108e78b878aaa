#include "estimation/corridor/corridor_types.h"

#include <cmath>
#include <stdexcept>

namespace waymark {
namespace {

void CheckLength(const char* key,
                 const std::optional<double>& value,
                 double least,
                 double most) {
  if (!value || (*value >= least && *value <= most)) return;
  throw std::invalid_argument(std::string(key) + ": " + std::to_string(*value) +
                              " must be in [" + std::to_string(least) + ", " +
                              std::to_string(most) + "] m");
}

}  // namespace

void CorridorGeometry::Check() const {
  // From what a robot fits through to a hall.
  CheckLength("width", width, 0.3, 50.0);
  CheckLength("height", height, 0.5, 50.0);
  CheckLength("skirting_height", skirting_height, 0.005, 1.0);
  CheckLength("skirting_depth", skirting_depth, 0.0, 0.1);
  if (skirting_height && height && *skirting_height >= *height) {
    throw std::invalid_argument(
        "skirting_height: must be below the corridor's height");
  }
  if (!std::isfinite(x_min) || !std::isfinite(x_max) || !(x_min < x_max)) {
    throw std::invalid_argument("x: its beginning must be below its end");
  }
}

const char* NameOf(CorridorStatus status) {
  switch (status) {
    case CorridorStatus::kAccepted:
      return "accepted";
    case CorridorStatus::kNoLines:
      return "no_lines";
    case CorridorStatus::kNoVanishingPoint:
      return "no_vanishing_point";
    case CorridorStatus::kAmbiguous:
      return "ambiguous";
    case CorridorStatus::kOutside:
      return "outside";
    case CorridorStatus::kEnds:
      return "ends";
    case CorridorStatus::kNoPosition:
      return "no_position";
    case CorridorStatus::kUnknownSize:
      return "unknown_size";
    case CorridorStatus::kFaulty:
      return "faulty";
  }
  return "unknown";
}

std::optional<CorridorStatus> CorridorStatusFromName(std::string_view name) {
  for (int i = 0; i <= static_cast<int>(CorridorStatus::kFaulty); ++i) {
    const auto status = static_cast<CorridorStatus>(i);
    if (name == NameOf(status)) return status;
  }
  return std::nullopt;
}

}  // namespace waymark
