// One description of a configuration serves loading, printing, checking and
// the generated reference.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace waymark {

// Allowed range of a number, ends included.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
inline constexpr Range kPositive{std::numeric_limits<double>::min(),
                                 std::numeric_limits<double>::infinity()};
inline constexpr Range kNotNegative{0.0,
                                    std::numeric_limits<double>::infinity()};

// Visits the fields of a configuration. A process's Config has
//
//   void Describe(Describer& d) {
//     d.Number("window_s", &window_s, {0.0, 30.0}, "How long ... late");
//     d.Group("gate", [&] { d.Number(...); });
//   }
//
// with keys that carry their unit and values that start at their defaults.
class Describer {
 public:
  virtual ~Describer() = default;

  virtual void Number(std::string_view key,
                      double* value,
                      Range range,
                      std::string_view help) = 0;
  // The key is in degrees, the value in radians.
  virtual void Degrees(std::string_view key,
                       double* value_rad,
                       Range range_deg,
                       std::string_view help) = 0;
  virtual void Integer(std::string_view key,
                       std::int64_t* value,
                       std::int64_t min,
                       std::int64_t max,
                       std::string_view help) = 0;
  virtual void Flag(std::string_view key,
                    bool* value,
                    std::string_view help) = 0;
  virtual void Text(std::string_view key,
                    std::string* value,
                    std::string_view help) = 0;
  // A list of exactly `size` numbers; size < 0: any length, and an empty list
  // means 'not given'. A given list of fixed size must have that size.
  virtual void Numbers(std::string_view key,
                       std::vector<double>* values,
                       int size,
                       std::string_view help) = 0;
  // One of the named values. `index` is the position in `names`.
  virtual void ChoiceIndex(std::string_view key,
                           int* index,
                           const std::vector<std::string>& names,
                           std::string_view help) = 0;
  virtual void Group(std::string_view key,
                     const std::function<void()>& describe,
                     std::string_view help) = 0;

  template <typename Enum>
  void Choice(std::string_view key,
              Enum* value,
              const std::vector<std::pair<std::string, Enum>>& choices,
              std::string_view help) {
    std::vector<std::string> names;
    int index = 0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      names.push_back(choices[i].first);
      if (choices[i].second == *value) index = static_cast<int>(i);
    }
    ChoiceIndex(key, &index, names, help);
    *value = choices[static_cast<std::size_t>(index)].second;
  }
};

}  // namespace waymark
