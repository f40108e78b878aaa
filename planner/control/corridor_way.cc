#include "planner/control/corridor_way.h"

#include <cmath>
#include <stdexcept>

namespace waymark {

void CorridorWayOptions::Check() const {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::invalid_argument(what);
  };
  require(std::isfinite(begin), "begin: must be finite");
  require(length > 0.0 && length <= 1000.0, "length: in (0, 1000]");
  require(num_legs >= 1 && num_legs <= 1000, "num_legs: in [1, 1000]");
  require(zigzag >= 0.0 && zigzag <= 100.0, "zigzag: in [0, 100]");
  require(zigzag_step >= 0.01 && zigzag_step <= 1000.0,
          "zigzag_step: in [0.01, 1000]");
}

std::vector<Eigen::Vector2d> CorridorWay(const CorridorWayOptions& options) {
  options.Check();
  const double first = options.begin;
  const double last = options.begin + options.length;
  std::vector<Eigen::Vector2d> way;
  double side = options.zigzag;
  for (std::int64_t leg = 0; leg < options.num_legs; ++leg) {
    const bool is_back = leg % 2 == 1;
    if (options.zigzag > 0.0) {
      for (double s = options.zigzag_step; s < options.length;
           s += options.zigzag_step) {
        way.emplace_back(is_back ? last - s : first + s, side);
        side = -side;
      }
    }
    way.emplace_back(is_back ? first : last, 0.0);
  }
  return way;
}

}  // namespace waymark
