// Line finders timed beside each other on the same frames.
#pragma once

#include "tests/bench/bench_report.h"
#include "tests/bench/line_frames.h"

#include <functional>
#include <string>
#include <vector>

namespace waymark {

struct Contender {
  std::string name;
  std::function<void(const LineFrame&)> run;
  std::vector<double> seconds{};
};

// Interleaved: each frame by each in turn.
void Race(const std::vector<LineFrame>& frames,
          int num_rounds,
          std::vector<Contender>* contenders);

// Milliseconds of `ours`; the ratio is the median of each frame's.
[[nodiscard]] BenchRow TimeRow(const std::string& id,
                               const std::string& name,
                               const Contender& ours,
                               const Contender& peer);

}  // namespace waymark
