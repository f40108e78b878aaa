#include "drivers/simulator/range_sensor.h"

#include "drivers/simulator/option_range.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace waymark {
namespace {

// Rays of a cone this far apart miss the nearest point of a wall by less than
// 0.5 deg: 0.04 mm in 1 m.
constexpr double kConeStep = RadiansFromDegrees(1.0);

}  // namespace

RangeSensorOptions RangeSensorOptions::SonarRing() {
  RangeSensorOptions options;
  options.bearing_step = 2.0 * kPi / options.num_beams;
  options.beam_width = RadiansFromDegrees(30.0);
  options.max_incidence = RadiansFromDegrees(25.0);
  options.edge_range = 1.5;
  options.sigma = 0.005;
  options.sigma_share = 0.01;
  options.drop_share = 0.01;
  return options;
}

RangeSensorOptions RangeSensorOptions::Lidar() {
  RangeSensorOptions options;
  options.num_beams = 360;
  options.first_bearing = RadiansFromDegrees(-180.0);
  options.bearing_step = RadiansFromDegrees(1.0);
  options.max_range = 8.0;
  options.sigma = 0.01;
  options.drop_share = 0.005;
  return options;
}

void RangeSensorOptions::Check() const {
  RequireWithin("rate_hz", rate_hz, 0.1, 1000.0);
  RequireWithin("num_beams", num_beams, 1.0, 10000.0);
  RequireWithin("first_bearing", first_bearing, -2.0 * kPi, 2.0 * kPi);
  RequireWithin("bearing_step", bearing_step, -kPi, kPi);
  RequireWithin("X_RS.x", X_RS.x, -10.0, 10.0);
  RequireWithin("X_RS.y", X_RS.y, -10.0, 10.0);
  RequireWithin("X_RS.heading", X_RS.heading, -2.0 * kPi, 2.0 * kPi);
  RequireNotNegative("ring_radius", ring_radius);
  RequireAbove0("max_range", max_range);
  RequireWithin("ring_radius", ring_radius, 0.0, max_range);
  RequireWithin("beam_width", beam_width, 0.0, kPi);
  RequireWithin("max_incidence", max_incidence, 0.0, kPi);
  RequireNotNegative("edge_range", edge_range);
  RequireNotNegative("sigma", sigma);
  RequireNotNegative("sigma_share", sigma_share);
  RequireWithin("drop_share", drop_share, 0.0, 1.0);
}

RangeSensor::RangeSensor(const RangeSensorOptions& options, std::uint64_t seed)
    : options_(options), random_(SeedFor(seed, "ranges")) {
  options_.Check();
}

std::vector<float> RangeSensor::Measure(const Pose2& X_WR,
                                        const ObstacleMap& map,
                                        std::span<const Disc2> people) {
  const Pose2 X_WS = X_WR * options_.X_RS;
  const double reach = options_.max_range - options_.ring_radius;
  const int num_rays =
      1 + static_cast<int>(std::ceil(options_.beam_width / kConeStep));
  std::vector<float> ranges;
  for (int beam = 0; beam < options_.num_beams; ++beam) {
    const double bearing =
        X_WS.heading + options_.first_bearing + beam * options_.bearing_step;
    const Eigen::Vector2d p_W =
        X_WS.position() +
        options_.ring_radius *
            Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    double nearest = reach;
    for (int ray = 0; ray < num_rays; ++ray) {
      const double off =
          num_rays > 1 ? options_.beam_width * (ray / (num_rays - 1.0) - 0.5)
                       : 0.0;
      const auto hit = map.CastRay(p_W, bearing + off, nearest, people);
      if (!hit) continue;
      // As near to it as two rays are to each other.
      const bool is_edge = hit->distance <= options_.edge_range &&
                           hit->to_end <= kConeStep * hit->distance;
      if (hit->incidence <= options_.max_incidence || is_edge) {
        nearest = hit->distance;
      }
    }
    double range = options_.ring_radius + nearest;
    // Both drawn for every beam: what is heard changes no other beam's noise.
    const double noise =
        random_.Normal(options_.sigma + options_.sigma_share * range);
    const bool is_lost = random_.Uniform() < options_.drop_share;
    range = nearest < reach && !is_lost ? range + noise : options_.max_range;
    ranges.push_back(
        static_cast<float>(std::clamp(range, 0.0, options_.max_range)));
  }
  return ranges;
}

}  // namespace waymark
