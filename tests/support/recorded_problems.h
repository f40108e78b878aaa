// The batch problems on recordings by others, shared by tests and benchmarks.
#pragma once

#include "estimation/batch/batch_types.h"

#include <array>
#include <string>
#include <vector>

namespace waymark {

// ---- motion-capture runs (optiodom_diffdrive) ------------------------------

struct MocapTypeReport {
  std::string name;  // Path type: "circular", "ivanjko", "square".
  int num_runs = 0;
  // Median over runs of the dead-reckoning RMSE from the run's first pose,
  // each run with the parameters of the half that does not hold it.
  double nominal_m = 0.0;
  double fitted_m = 0.0;       // Wheels and mounting.
  double wheels_only_m = 0.0;  // Fitted wheels, nominal mounting.
  BatchResult alone;           // Fitted on all runs of this type.
};

struct MocapReport {
  std::vector<MocapTypeReport> types;
  std::array<BatchResult, 2> halves;
  double base_gap = 0.0;  // B of circles over B of squares, minus 1.
  int num_runs = 0;
};

// Halves take every second run of each path type, in order of path; each is
// fitted jointly over all path types and scored on the other.
[[nodiscard]] MocapReport CrossValidateMocap(const std::string& folder);

// ---- wheels and laser mountings (censi_joint_calibration) ------------------

struct MotionMedians {
  double position_m = 0.0;
  double yaw_rad = 0.0;
};

// How much larger one median is than another, as a share of the latter, with
// its central 95 % by bootstrap over the tuples (each tuple's residuals under
// both fits stay together). Zero inside: no difference that could be told.
struct MedianGap {
  double share = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct CensiMountingReport {
  std::string name;  // "lstraight", "l90".
  int num_held_out = 0;
  // Medians of the residuals of the laser's motion over all tuples, each
  // predicted by a fit that has not seen it: fitted on one of the three
  // subsets, evaluated on the other two, as the authors' stored results are.
  MotionMedians ours;      // Fitted jointly over both mountings.
  MotionMedians authors;   // Their result of the same subset.
  MedianGap position_gap;  // Ours beside theirs.
  MedianGap yaw_gap;
};

struct CensiReport {
  std::vector<CensiMountingReport> mountings;
  BatchResult joint;         // All tuples of both mountings.
  double axle_spread = 0.0;  // Largest over smallest minus 1, fitted alone.
  double authors_axle_spread = 0.0;
};

[[nodiscard]] CensiReport CrossValidateCensi(const std::string& folder);

// ---- LEGO robot (brenner_lego_robot4) --------------------------------------

struct LegoReport {
  BatchResult result;
  // Dead-reckoning RMSE of the scanner over the run, from the stated start
  // (nominal) and from the fitted one.
  double nominal_m = 0.0;
  double fitted_m = 0.0;
};

[[nodiscard]] LegoReport FitLego(const std::string& folder);

}  // namespace waymark
