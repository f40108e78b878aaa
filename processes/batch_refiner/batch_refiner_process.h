// Wheel parameters and sensor mounting from the newest minutes of driving.
#pragma once

#include "estimation/batch/batch_refiner.h"
#include "estimation/batch/batch_window.h"
#include "estimation/filter/encoder_counter.h"
#include "estimation/filter/estimate_types.h"
#include "processes/batch_refiner/batch_refiner_config.h"
#include "processes/support/bus.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace waymark {

// A result as it is published: with the mounting that most measurements speak
// of, where one was estimated and there is an answer.
[[nodiscard]] OdometryParameters ParametersFromResult(
    const BatchResult& result);

// ENCODERS, POSITION_FIX, CORRIDOR_POSE, RELATIVE_MOTION, ODOMETRY_PARAMETERS
// (nominal) -> ODOMETRY_PARAMETERS (batch). Solves whenever the encoders' time
// has moved on by period_s, in the handler: a slow job (some 0.1 s), which its
// mailboxes outlast. What it publishes depends on the messages and their order
// only, not on how long it takes. Where there is no answer it says so, and why:
// what was published last as known stays the best that is known.
class BatchRefinerProcess {
 public:
  using Config = BatchRefinerConfig;
  static constexpr std::string_view kName = "batch_refiner";
  static constexpr std::string_view kAbout =
      "Wheel parameters over a sliding window: ENCODERS, POSITION_FIX, "
      "CORRIDOR_POSE, RELATIVE_MOTION, ODOMETRY_PARAMETERS -> "
      "ODOMETRY_PARAMETERS.";

  BatchRefinerProcess(const Config& config, Bus* bus);
  // Solves what came after the last solution.
  void Finish();

 private:
  struct Reading {
    EncoderReading raw;
    int counter_bits = 0;
  };

  // A reading whose stamp is farther than the window from all others waits for
  // a second one beside it (a log played again, a clock that was set): alone it
  // is a wrong stamp, and must not cost what the window holds.
  void OnReading(const EncoderReading& raw, int counter_bits);
  void Take(const EncoderReading& raw, int counter_bits);
  void OnParameters(const OdometryParameters& parameters);
  void SetNominal(const WheelParameters& nominal);
  void StartAnew(std::string_view why);
  void Solve();

  Config config_;
  Bus* bus_;
  std::optional<WheelParameters> nominal_;
  EncoderCounter counter_;
  BatchWindow window_;
  std::optional<Reading> far_;
  EncoderReading total_;  // Counts without wraps.
  std::optional<Time> solved_;
  std::int64_t seq_ = 0;
};

}  // namespace waymark
