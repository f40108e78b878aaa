// From cumulative encoder counts to ticks between readings: removes wraps and
// refuses jumps that no wheel can make.
#pragma once

#include "estimation/filter/differential_drive.h"
#include "estimation/filter/measurement_types.h"

#include <optional>
#include <string>

namespace waymark {

struct EncoderCounterOptions {
  // Fastest possible wheel, ticks/s; 0: anything is possible.
  double max_tick_rate = 0.0;
  // How wrong the time between two readings may be (stamps made on arrival).
  double jitter_s = 0.1;
  // After a refused reading, this many in a row that agree with each other
  // become the new base line: counter reset, lost connection.
  int num_agreeing = 5;
};

struct EncoderStep {
  bool is_accepted = false;  // False: refused, because of reason.
  bool is_first = false;     // First reading: nothing to count from.
  std::string reason;
  WheelTicks ticks;      // Since the last accepted reading.
  double seconds = 0.0;  // Since the last accepted reading.
  // Part of `seconds` whose motion was not counted: the count was lost once
  // between the last accepted reading and the new base line.
  double unknown_s = 0.0;
};

// Copyable state; readings come in the order of their times. O(1).
class EncoderCounter {
 public:
  explicit EncoderCounter(const EncoderCounterOptions& options = {})
      : options_(options) {}

  // `counter_bits` is the width of the counter, 8 to 52; 0: it never wraps.
  // A difference is taken as the smallest that the width allows; where the
  // wheel could have turned farther than that, the reading counts as a jump.
  // A reading not later than the last accepted one is refused.
  [[nodiscard]] EncoderStep Add(const EncoderReading& raw, int counter_bits);

  void set_max_tick_rate(double rate) { options_.max_tick_rate = rate; }
  [[nodiscard]] const std::optional<EncoderReading>& last() const {
    return last_;
  }

 private:
  struct Difference {
    WheelTicks ticks;
    double seconds = 0.0;
    bool is_possible = false;
    std::string reason;
  };
  [[nodiscard]] Difference Between(const EncoderReading& from,
                                   const EncoderReading& to,
                                   int counter_bits) const;
  void Rebase(const EncoderReading& raw);

  EncoderCounterOptions options_;
  std::optional<EncoderReading> last_;
  // The refused readings that agree so far.
  std::optional<EncoderReading> first_refused_;
  EncoderReading last_refused_;
  WheelTicks refused_ticks_;
  int num_agreeing_ = 0;
};

}  // namespace waymark
