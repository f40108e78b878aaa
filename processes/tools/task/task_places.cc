#include "processes/tools/task/task_places.h"

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace waymark {

Waypoint WaypointFromText(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  bool is_good = true;
  while (is_good) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    // Beyond this nothing is a place in a building.
    is_good = error == std::errc() && std::abs(value) <= 1e6;
    numbers.push_back(value);
    at = next;
    if (at == end || *at != ',') break;
    ++at;
  }
  if (!is_good || at != end || numbers.size() < 2 || numbers.size() > 3) {
    throw InputError("'" + text +
                     "' is no place: x,y or x,y,heading (m, m, deg), each "
                     "within +-1e6");
  }
  Waypoint waypoint{{numbers[0], numbers[1]}, {}};
  if (numbers.size() == 3) {
    waypoint.heading = WrapAngle(RadiansFromDegrees(numbers[2]));
  }
  return waypoint;
}

}  // namespace waymark
