// An experiment: one closed loop, run once per seed.
#pragma once

#include "processes/support/describer.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace waymark {

// What one run came to. The same seed and configuration give the same.
struct RunResult {
  std::uint64_t seed = 0;
  bool is_success = false;
  std::string reason;  // Why not; a few words that runs share.
  std::int64_t num_touches = 0;
  double way_m = 0.0;       // That the robot drove.
  double shortest_m = 0.0;  // Of the shortest way to where it had to go; 0
                            // where it had nowhere to go.
  double duration_s = 0.0;  // Simulated.
  // Magnitudes of this experiment's own, named with their unit, always the
  // same ones in the same order: {"end_error_m", 0.02}.
  std::vector<std::pair<std::string, double>> figures;

  friend bool operator==(const RunResult&, const RunResult&) = default;
};

class Experiment {
 public:
  virtual ~Experiment() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  // Its set-up, those of its processes included, which are `process.key`.
  virtual void Describe(Describer& d) = 0;
  // Loads what all runs share. Throws InputError where the set-up does not
  // work, std::invalid_argument naming a key. Called once, after Describe().
  virtual void Prepare() = 0;
  // After Prepare(): what runs depend on beside the configuration, as text;
  // results of another one are not mixed with these.
  [[nodiscard]] virtual std::string Subject() const = 0;
  // Simulates one run to its end, and writes every message of it to `log_path`
  // (replaced where it is there) unless that is empty. Does not depend on runs
  // before it.
  [[nodiscard]] virtual RunResult Run(std::uint64_t seed,
                                      const std::string& log_path) const = 0;
};

}  // namespace waymark
