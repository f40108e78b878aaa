#include "tests/support/drive_simulation.h"

#include "estimation/base/check.h"
#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace waymark {

std::vector<SimulatedReading> SimulateDrive(
    const DriveSimulationOptions& options, const Driver& driver) {
  WAYMARK_CHECK(options.rate_hz > 0.0, options.rate_hz);
  Random random(options.seed);
  const double period = 1.0 / options.rate_hz;
  const auto num_steps =
      static_cast<std::int64_t>(std::floor(options.duration_s / period));
  const WheelParameters& p = options.parameters;

  std::vector<SimulatedReading> readings;
  readings.reserve(static_cast<std::size_t>(num_steps) + 1);
  SimulatedReading now{options.start_time, 0.0, 0.0, options.start};
  readings.push_back(now);
  double wanted_left = 0.0;  // Cumulative ticks before rounding.
  double wanted_right = 0.0;
  for (std::int64_t i = 0; i < num_steps; ++i) {
    const DriveCommand command =
        driver(static_cast<double>(i) * period, now.X_WR);
    const double half_turn = 0.5 * command.turn_rate * p.wheel_base;
    wanted_left += (command.forward - half_turn) * period / p.k_left;
    wanted_right += (command.forward + half_turn) * period / p.k_right;
    const double left =
        options.whole_ticks ? std::round(wanted_left) : wanted_left;
    const double right =
        options.whole_ticks ? std::round(wanted_right) : wanted_right;

    // The world's step: travel and wheel base are off by their noise.
    const WheelTicks ticks{right - now.right_ticks, left - now.left_ticks};
    double l_right = p.k_right * ticks.right;
    double l_left = p.k_left * ticks.left;
    const double travel = 0.5 * (std::abs(l_right) + std::abs(l_left));
    WheelParameters actual = p;
    if (travel > 0.0) {
      const double e_right = random.Normal(
          std::sqrt(options.noise.wheel_variance * std::abs(l_right)));
      const double e_left = random.Normal(
          std::sqrt(options.noise.wheel_variance * std::abs(l_left)));
      const double b =
          random.Normal(std::sqrt(options.noise.base_variance / travel));
      // A turn error of -dtheta * b / B exactly, also where b is large.
      const double turn = (l_right - l_left) / p.wheel_base;
      const double extra = -0.5 * turn * b;
      l_right += e_right + extra;
      l_left += e_left - extra;
      actual.k_right = 1.0;
      actual.k_left = 1.0;
      const DriveStep step = IntegrateTicks(
          {l_right, l_left}, actual, DriveNoise{}, options.integration);
      now.X_WR = now.X_WR * step.X_R0R1;
    }
    now.left_ticks = left;
    now.right_ticks = right;
    now.time = options.start_time +
               DurationFromSeconds(static_cast<double>(i + 1) * period);
    readings.push_back(now);
  }
  return readings;
}

Driver ZigZagDriver(double forward,
                    double amplitude_rad,
                    double leg_m,
                    double turn_rate) {
  return [=](double t, const Pose2& X_WR) {
    const auto leg = static_cast<std::int64_t>(std::floor(t * forward / leg_m));
    const double target = leg % 2 == 0 ? amplitude_rad : -amplitude_rad;
    const double error = WrapAngle(target - X_WR.heading);
    // Slows down over the last tenth of a radian: no overshoot.
    const double rate = std::clamp(10.0 * error, -1.0, 1.0) * turn_rate;
    return DriveCommand{forward, rate};
  };
}

Driver SquareDriver(double forward, double side_m, double turn_rate) {
  const double side_s = side_m / forward;
  const double turn_s = 0.5 * kPi / std::abs(turn_rate);
  return [=](double t, const Pose2&) {
    const double phase = std::fmod(t, side_s + turn_s);
    return phase < side_s ? DriveCommand{forward, 0.0}
                          : DriveCommand{0.0, turn_rate};
  };
}

Driver CircleDriver(double forward, double radius_m) {
  return [=](double, const Pose2&) {
    return DriveCommand{forward, forward / radius_m};
  };
}

}  // namespace waymark
