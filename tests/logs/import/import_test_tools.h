// Shared by the importers' tests: texts in the formats of others, made from
// simulated drives, and what an error says.
#pragma once

#include "estimation/base/input_error.h"
#include "estimation/geometry/angle.h"
#include "logs/evaluation/dead_reckoning.h"
#include "logs/evaluation/trajectory_error.h"
#include "logs/import/recording.h"
#include "tests/support/drive_simulation.h"

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace waymark {

inline void WriteText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// What the InputError of `action` says; "no error" where it throws none.
inline std::string InputErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// printf into a string of at most 511 characters.
template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  const int size = std::snprintf(text, sizeof(text), format, values...);
  return {text, static_cast<std::size_t>(size)};
}

// A noiseless drive with curves both ways: its dead reckoning with the true
// parameters is its truth.
inline std::vector<SimulatedReading> NoiselessDrive(
    const WheelParameters& parameters, double rate_hz, double duration_s) {
  DriveSimulationOptions options;
  options.parameters = parameters;
  options.noise = {0.0, 0.0};
  options.rate_hz = rate_hz;
  options.duration_s = duration_s;
  options.start = {0.3, -0.2, 0.7};
  return SimulateDrive(options, ZigZagDriver(0.2, 0.5, 0.6, 0.8));
}

// Root mean square distance of the reference from dead reckoning with
// `parameters` that passes through X_WR at `time`, m.
inline double DeadReckoningRmse(const Recording& recording,
                                const WheelParameters& parameters,
                                Time time,
                                const Pose2& X_WR) {
  const auto path =
      Anchor(DeadReckon(recording.encoders, parameters), time, X_WR);
  const auto association =
      Associate(recording.reference.samples, path, AssociationOptions{});
  const auto error = EvaluateAbsoluteError(association.pairs, Alignment::kNone);
  return error ? error->position_summary.rmse : -1.0;
}

// The same by the recording's own start and nominal parameters.
inline double NominalRmse(const Recording& recording) {
  return DeadReckoningRmse(recording,
                           recording.nominal.parameters,
                           recording.start->time,
                           recording.start->X_WR);
}

}  // namespace waymark
