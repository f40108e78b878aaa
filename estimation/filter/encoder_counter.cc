#include "estimation/filter/encoder_counter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace waymark {
namespace {

// The representative of to - from modulo 2^bits that is nearest to 0.
std::int64_t WrappedDifference(std::int64_t from, std::int64_t to, int bits) {
  if (bits == 0) return to - from;
  const std::int64_t modulus = std::int64_t{1} << bits;
  std::int64_t difference = (to - from) % modulus;
  if (difference < 0) difference += modulus;
  return difference >= modulus / 2 ? difference - modulus : difference;
}

double Farthest(const WheelTicks& ticks) {
  return std::max(std::abs(ticks.right), std::abs(ticks.left));
}

}  // namespace

EncoderCounter::Difference EncoderCounter::Between(const EncoderReading& from,
                                                   const EncoderReading& to,
                                                   int counter_bits) const {
  Difference d;
  d.seconds = Seconds(to.time - from.time);
  d.ticks = {
      static_cast<double>(
          WrappedDifference(from.right, to.right, counter_bits)),
      static_cast<double>(WrappedDifference(from.left, to.left, counter_bits))};
  char text[160];
  if (d.seconds <= 0.0) {
    std::snprintf(text,
                  sizeof text,
                  "encoder reading %.6f s before the last one",
                  -d.seconds);
    d.reason = text;
    return d;
  }
  d.is_possible = true;
  if (options_.max_tick_rate <= 0.0) return d;
  const double most = options_.max_tick_rate * (d.seconds + options_.jitter_s);
  for (const auto& [side, ticks] :
       {std::pair{"right", d.ticks.right}, std::pair{"left", d.ticks.left}}) {
    if (std::abs(ticks) > most) {
      std::snprintf(text,
                    sizeof text,
                    "encoder jump: %s wheel %+.0f ticks in %.3f s, at most "
                    "%.0f possible",
                    side,
                    ticks,
                    d.seconds,
                    most);
      d.is_possible = false;
      d.reason = text;
      return d;
    }
  }
  if (counter_bits > 0 &&
      options_.max_tick_rate * d.seconds > std::ldexp(1.0, counter_bits - 1)) {
    std::snprintf(text,
                  sizeof text,
                  "encoder gap: the %d-bit counter may have wrapped unseen in "
                  "%.3f s",
                  counter_bits,
                  d.seconds);
    d.is_possible = false;
    d.reason = text;
  }
  return d;
}

void EncoderCounter::Rebase(const EncoderReading& raw) {
  last_ = raw;
  first_refused_.reset();
  refused_ticks_ = {};
  num_agreeing_ = 0;
}

EncoderStep EncoderCounter::Add(const EncoderReading& raw, int counter_bits) {
  EncoderStep step;
  if (!last_) {
    Rebase(raw);
    step.is_accepted = step.is_first = true;
    return step;
  }
  const Difference d = Between(*last_, raw, counter_bits);
  step.seconds = d.seconds;
  const Difference agreeing =
      first_refused_ ? Between(last_refused_, raw, counter_bits) : Difference{};
  // What may have been turned grows with the time since the last accepted
  // reading, so a reset that was refused would pass as motion a little later.
  // A reading belongs to what it is nearer to.
  const bool follows_refused =
      agreeing.is_possible && Farthest(agreeing.ticks) < Farthest(d.ticks);
  if (d.is_possible && !follows_refused) {
    step.is_accepted = true;
    step.ticks = d.ticks;
    Rebase(raw);
    return step;
  }
  step.reason = d.is_possible ? "encoder jump: follows refused readings, not "
                                "the last accepted one"
                              : d.reason;
  if (d.seconds <= 0.0) return step;
  if (agreeing.is_possible) {
    ++num_agreeing_;
    refused_ticks_.right += agreeing.ticks.right;
    refused_ticks_.left += agreeing.ticks.left;
  } else {
    first_refused_ = raw;
    refused_ticks_ = {};
    num_agreeing_ = 1;
  }
  last_refused_ = raw;
  if (num_agreeing_ < options_.num_agreeing) return step;
  step.is_accepted = true;
  step.ticks = refused_ticks_;
  step.unknown_s = Seconds(first_refused_->time - last_->time);
  Rebase(raw);
  return step;
}

}  // namespace waymark
