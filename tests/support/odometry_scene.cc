#include "tests/support/odometry_scene.h"

#include "estimation/base/random.h"
#include "estimation/geometry/angle.h"

#include <cmath>

namespace waymark {
namespace {

// Arc from X_WA to X_WB at a share of the way, for a step of a few degrees.
Pose2 Interpolate(const Pose2& X_WA, const Pose2& X_WB, double share) {
  const Pose2 X_AB = Between(X_WA, X_WB);
  return X_WA * Pose2{X_AB.x * share, X_AB.y * share, X_AB.heading * share};
}

}  // namespace

OdometryScene MakeOdometryScene(const OdometrySceneOptions& options) {
  // Left and right turns that depend on nothing the filter is not told.
  const Driver program = [](double t, const Pose2&) {
    return DriveCommand{0.4, std::sin(0.7 * t) + 0.3 * std::sin(0.11 * t)};
  };
  const auto drive =
      SimulateDrive(options.drive, options.driver ? options.driver : program);
  Random random(options.drive.seed ^ 0x5eed);
  OdometryScene scene;
  const auto stride = static_cast<std::size_t>(
      std::lround(options.fix_period_s * options.drive.rate_hz));
  for (std::size_t i = 0; i < drive.size(); ++i) {
    scene.truth.push_back(drive[i].X_WR);
    scene.readings.push_back({drive[i].time,
                              static_cast<std::int64_t>(i),
                              std::llround(drive[i].right_ticks),
                              std::llround(drive[i].left_ticks)});
    if (i == 0 || i % stride != 0 || i + 1 == drive.size()) continue;
    const Pose2 X_WR =
        Interpolate(drive[i].X_WR, drive[i + 1].X_WR, options.fix_shift);
    AbsoluteFix fix;
    fix.time =
        drive[i].time +
        Duration(std::llround(
            static_cast<double>((drive[i + 1].time - drive[i].time).count()) *
            options.fix_shift));
    fix.seq = static_cast<std::int64_t>(scene.fixes.size());
    fix.source = "scene";
    fix.has = {options.has_position, options.has_position, options.has_heading};
    fix.value = {
        X_WR.x + random.Normal(options.position_sigma),
        X_WR.y + random.Normal(options.position_sigma),
        WrapAngle(X_WR.heading + random.Normal(options.heading_sigma))};
    const double position = options.position_sigma * options.position_sigma;
    fix.covariance.diagonal() << position, position,
        options.heading_sigma * options.heading_sigma;
    scene.fixes.push_back(fix);
  }
  return scene;
}

}  // namespace waymark
