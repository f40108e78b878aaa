// Stands in for corridor_tracker: its errors, without images.
#pragma once

#include "estimation/base/random.h"
#include "estimation/corridor/corridor_types.h"
#include "processes/support/describer.h"
#include "processes/support/local_bus.h"

#include <cstdint>
#include <optional>

namespace waymark {

// How well corridor_tracker measures, fitted to what it said of rendered
// images.
struct CorridorVisionOptions {
  double rate_hz = 15.0;
  double latency_s = 0.08;
  // Of y and heading: from image to image, and what stays about as it is for
  // correlation_s. Both together are the root mean squares of the answers from
  // rendered frames in the hardest of the worlds, bricks and tiles (./run bench
  // Y18), more than twice those of a drive in a plain one; their shares, and
  // the time, are those of such a drive, image after image: correlation 0.1 of
  // y and 0.4 of the heading, half of it left after a second.
  double sigma_m = 0.0021;
  double sigma_rad = 0.0008;
  double slow_sigma_m = 0.0007;
  double slow_sigma_rad = 0.0006;
  double correlation_s = 1.5;
  // What it says of its own errors, m and rad.
  double stated_sigma_m = 0.01;
  double stated_sigma_rad = 0.002;
  // Of images within max_heading_rad of the axis; others have no answer. In a
  // plain corridor skirting board and floor edge of one wall are seen to beyond
  // 80 degrees, in nearly every image; with doors and furniture in fewer.
  double accepted_share = 0.85;
  double max_heading_rad = 1.4;
  // Share of answers that are wrong without knowing it, by so much. Of 8505
  // accepted frames none was (Y18); with 95 % certainty it is less than this.
  double faulty_share = 0.00035;
  double faulty_sigma_m = 0.3;
  double faulty_sigma_rad = 0.1;

  void Describe(Describer& d);
};

// Sends CORRIDOR_POSE from TRUTH: each image time of it, with errors, late.
class CorridorVision {
 public:
  // Nothing is seen while the robot's way is within `blind`. Both outlive this.
  CorridorVision(const CorridorVisionOptions& options,
                 const CorridorGeometry& corridor,
                 const std::optional<Eigen::Vector2d>& blind_way_m,
                 std::uint64_t seed,
                 LocalBus* bus);

 private:
  void OnTruth(const Pose2& X_WR, Time time);
  [[nodiscard]] CorridorEstimate EstimateAt(const Pose2& X_LR);
  // Errors of y and heading.
  [[nodiscard]] Eigen::Vector2d DrawError();

  CorridorVisionOptions options_;
  CorridorGeometry corridor_;
  std::optional<Eigen::Vector2d> blind_way_m_;
  Random random_;
  LocalBus* bus_;
  Eigen::Vector2d slow_ = Eigen::Vector2d::Zero();
  bool has_slow_ = false;
  std::optional<Pose2> last_;  // X_WR.
  double way_m_ = 0.0;
  Time next_;
  std::int64_t seq_ = 0;
};

}  // namespace waymark
