#include "tests/bench/line_race.h"

#include "tests/bench/measure.h"

#include <cstddef>
#include <cstdint>

namespace waymark {

void Race(const std::vector<LineFrame>& frames,
          int num_rounds,
          std::vector<Contender>* contenders) {
  for (int round = 0; round < num_rounds; ++round) {
    for (const LineFrame& frame : frames) {
      for (Contender& c : *contenders) {
        c.seconds.push_back(CpuSecondsOf([&] { c.run(frame); }));
      }
    }
  }
}

BenchRow TimeRow(const std::string& id,
                 const std::string& name,
                 const Contender& ours,
                 const Contender& peer) {
  BenchRow row;
  row.id = id;
  row.name = name;
  row.value = 1e3 * Median(ours.seconds);
  row.unit = "ms";
  row.peer = peer.name;
  row.peer_value = 1e3 * Median(peer.seconds);
  // Of each frame, not of the medians: what a frame costs varies with it.
  std::vector<double> ratios;
  for (std::size_t i = 0; i < ours.seconds.size(); ++i) {
    ratios.push_back(peer.seconds[i] / ours.seconds[i]);
  }
  row.ratio = Median(ratios);
  row.runs = static_cast<std::int64_t>(ours.seconds.size());
  return row;
}

}  // namespace waymark
