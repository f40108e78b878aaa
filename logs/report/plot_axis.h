// One axis of a plot: its range, its ticks, and where a value lies on it.
#pragma once

#include <string>
#include <vector>

namespace waymark {

class PlotAxis {
 public:
  // Covers [low, high], widened to look well and never empty. A log axis needs
  // low > 0. `num_ticks` is about how many there shall be.
  PlotAxis(double low, double high, bool is_log, int num_ticks);

  // Where the value lies between the ends: 0 to 1 inside.
  [[nodiscard]] double Place(double value) const;

  struct Tick {
    double value = 0.0;
    std::string text;
  };
  [[nodiscard]] const std::vector<Tick>& ticks() const { return ticks_; }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

 private:
  double low_;
  double high_;
  bool is_log_;
  std::vector<Tick> ticks_;
};

}  // namespace waymark
