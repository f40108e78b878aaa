// The batch problem at one linearisation: parameter blocks and factors.
#pragma once

#include "estimation/batch/batch_input.h"

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <array>
#include <memory>
#include <vector>

namespace waymark {

// What the solver changes; a graph is built at one state and moves another.
struct BatchState {
  struct Keyframe {
    double time = 0.0;             // s of the track, encoders' clock.
    std::array<double, 3> pose{};  // X_WR, heading not wrapped.
  };
  std::array<double, 3> wheels{1.0, 1.0, 1.0};  // Times the initial values.
  std::vector<std::array<double, 4>> sensors;
  std::vector<std::vector<Keyframe>> logs;

  [[nodiscard]] WheelParameters Wheels(const WheelParameters& initial) const {
    return {wheels[0] * initial.k_right,
            wheels[1] * initial.k_left,
            wheels[2] * initial.wheel_base};
  }
};

enum class FactorKind { kPrior, kStep, kFix, kMotion };

struct BatchFactor {
  FactorKind kind = FactorKind::kPrior;
  std::unique_ptr<ceres::CostFunction> cost;
  std::unique_ptr<ceres::LossFunction> loss;  // Null: none.
  std::vector<double*> blocks;                // Into the graph's state.
  int log = -1;
  int index = -1;   // Of the measurement in its log's input.
  int sensor = -1;  // Of the measurement.
};

// State at the start: keyframes where measurements are, dead reckoning laid
// onto the fixes.
[[nodiscard]] BatchState FirstState(const BatchInput& input,
                                    const BatchOptions& options);

// Moves the keyframes to where the measurements are at the state's time
// offsets.
void RenewKeyframes(const BatchInput& input,
                    const BatchOptions& options,
                    BatchState* state);

// All factors on the blocks of `state`, whitened with the covariances that the
// state's wheel parameters give.
[[nodiscard]] std::vector<BatchFactor> BuildFactors(const BatchInput& input,
                                                    const BatchOptions& options,
                                                    BatchLoss loss,
                                                    BatchState* state);

// A value of chi-squared (n components, 1 to 3) that a thousandth of good
// measurements exceeds.
[[nodiscard]] double InlierGate(int num_components);

}  // namespace waymark
