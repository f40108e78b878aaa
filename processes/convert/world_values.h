// Values that objects of a world file have in common.
#pragma once

#include "drivers/simulator/world.h"
#include "processes/support/configuration_range.h"
#include "processes/support/yaml_group.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace waymark {

inline constexpr Range kCoordinate{-kMaxWorldReach, kMaxWorldReach};  // m.
inline constexpr Range kHeading{-360.0, 360.0};  // Degrees.
inline constexpr Range kLight{0.0, 10.0};

[[nodiscard]] Eigen::Vector2d Vector2Of(const std::vector<double>& numbers);
[[nodiscard]] std::vector<Eigen::Vector2d> Points(
    const std::vector<std::vector<double>>& rows);

// The value under a key; InputError where it is missing or out of range.
[[nodiscard]] double Required(YamlGroup* group,
                              const std::string& key,
                              Range range);
[[nodiscard]] Eigen::Vector2d RequiredPoint(YamlGroup* group,
                                            const std::string& key);
// Radians of a key in degrees; 0 where it is missing.
[[nodiscard]] double Degrees(YamlGroup* group,
                             const std::string& key,
                             Range range);
// Of the key `seed`.
[[nodiscard]] std::uint64_t Seed(YamlGroup* group, std::uint64_t otherwise);

// In place of the one of the same name, which a base may have given.
template <typename Named>
void Put(Named value, std::vector<Named>* all) {
  for (Named& known : *all) {
    if (known.name == value.name) {
      known = std::move(value);
      return;
    }
  }
  all->push_back(std::move(value));
}

// InputError with "..., key = 'name': must be one line" where it is not: names
// stand in errors and reports.
void CheckIsOneLine(const YamlGroup& group,
                    const std::string& key,
                    const std::string& name);
// In quotes, without what ends a line: "a\nb" is 'a\x0ab'.
[[nodiscard]] std::string Quoted(const std::string& name);

// "a, b, c".
[[nodiscard]] std::string Joined(const std::vector<std::string>& names);

}  // namespace waymark
