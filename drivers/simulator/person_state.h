// What people remember of the robots that they met.
#pragma once

#include <Eigen/Core>

#include <optional>

namespace waymark {

struct PersonState {
  double waited_s = 0.0;    // Of all the time so far.
  double patience_s = 0.0;  // Spent on the robot before them.
  Eigen::Vector2d aside_W = Eigen::Vector2d::Zero();  // From their path, m.
  // Of who goes beside the robot: in which direction from it they are, from W's
  // x, rad; turns add up. Absent before the first meeting.
  std::optional<double> bearing_W;
  double squeezed = 0.0;  // So much closer than they wish to be, m.
};

// Between two states of one person.
[[nodiscard]] inline PersonState Interpolate(const PersonState& from,
                                             const PersonState& to,
                                             double share) {
  PersonState state = to;
  state.waited_s = from.waited_s + share * (to.waited_s - from.waited_s);
  state.aside_W = from.aside_W + share * (to.aside_W - from.aside_W);
  if (from.bearing_W && to.bearing_W) {
    state.squeezed = from.squeezed + share * (to.squeezed - from.squeezed);
    state.bearing_W =
        *from.bearing_W + share * (*to.bearing_W - *from.bearing_W);
  }
  return state;
}

}  // namespace waymark
