#include "estimation/filter/delayed_fusion.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace waymark {
namespace {

// Starts of motions come last, when motions that end then are fused.
enum Rank {
  kParameters,
  kInitialPose,
  kFix,
  kMotion,
  kMotionStart,
  kReading,
};

// Recomputing some 25 readings costs about as much as copying the state.
constexpr int kReadingsPerCheckpoint = 25;
// More than anybody measures while restart_after readings come in.
constexpr std::size_t kMaxLate = 200;

}  // namespace

DelayedFusion::DelayedFusion(const DelayedFusionOptions& options)
    : options_(options),
      settled_filter_(options.filter),
      newest_(options.filter) {}

std::optional<Time> DelayedFusion::newest_time() const {
  return newest_reading_;
}

bool DelayedFusion::IsBehindWindow(Time time) const {
  return newest_reading_ &&
         time < *newest_reading_ - DurationFromSeconds(options_.window_s);
}

bool DelayedFusion::Feed(const Key& key,
                         const Event& event,
                         OdometryFilter* filter) {
  if (const auto* reading = std::get_if<Reading>(&event)) {
    filter->AddReading(reading->raw, reading->counter_bits);
    return true;
  }
  filter->Add(key.time, std::get<OdometryFilter::Measurement>(event));
  return false;
}

void DelayedFusion::KeepLate(Key key, Event event) {
  late_.emplace_back(std::move(key), std::move(event));
  if (late_.size() > kMaxLate) late_.pop_front();
}

Arrival DelayedFusion::Insert(Key key, Event event) {
  if (IsBehindWindow(key.time)) {
    ++counts_.num_late;
    KeepLate(std::move(key), std::move(event));
    return Arrival::kLate;
  }
  const auto [place, is_new] = history_.try_emplace(key, std::move(event));
  if (!is_new) {
    ++counts_.num_duplicates;
    return Arrival::kDuplicate;
  }
  if (history_.size() > options_.max_waiting && DropOneWaiting(key)) {
    return Arrival::kFull;
  }
  if (fed_ && key < *fed_) {
    ++counts_.num_recomputed;
    while (!checkpoints_.empty() && key < checkpoints_.back().key) {
      checkpoints_.pop_back();
    }
    readings_since_checkpoint_ = 0;
    if (checkpoints_.empty()) {
      newest_ = settled_filter_;
      fed_.reset();
    } else {
      newest_ = checkpoints_.back().filter;
      fed_ = checkpoints_.back().key;
    }
  }
  return Arrival::kTaken;
}

// Where more wait for readings than may, the farthest in the future goes. True
// where that is the one at `key`.
bool DelayedFusion::DropOneWaiting(const Key& key) {
  const auto first = newest_reading_ ? std::find_if(history_.rbegin(),
                                                    history_.rend(),
                                                    [this](const auto& item) {
                                                      return item.first.time <=
                                                             *newest_reading_;
                                                    })
                                           .base()
                                     : history_.begin();
  const auto num_waiting = std::distance(first, history_.end());
  const auto last = std::prev(history_.end());
  if (num_waiting <= static_cast<std::ptrdiff_t>(options_.max_waiting) ||
      last->first.rank == kReading) {
    return false;
  }
  const bool is_own = last->first == key;
  history_.erase(last);
  ++counts_.num_full;
  return is_own;
}

// Feeds `newest_` up to the newest reading.
void DelayedFusion::CatchUp() {
  if (!newest_reading_) return;
  auto next = fed_ ? history_.upper_bound(*fed_) : history_.begin();
  for (; next != history_.end() && next->first.time <= *newest_reading_;
       ++next) {
    const bool is_reading = Feed(next->first, next->second, &newest_);
    fed_ = next->first;
    if (is_reading && ++readings_since_checkpoint_ >= kReadingsPerCheckpoint) {
      checkpoints_.push_back({next->first, newest_});
      readings_since_checkpoint_ = 0;
    }
  }
}

void DelayedFusion::Settle(Time before) {
  while (!history_.empty() && history_.begin()->first.time < before) {
    const auto first = history_.begin();
    if (Feed(first->first, first->second, &settled_filter_)) {
      settled_.push_back({settled_filter_.estimate(),
                          settled_filter_.parameters(),
                          settled_filter_.counts()});
    }
    history_.erase(first);
  }
  while (!checkpoints_.empty() && checkpoints_.front().key.time < before) {
    checkpoints_.pop_front();
  }
}

void DelayedFusion::Restart(const std::vector<Reading>& kept) {
  Finish();
  history_.clear();
  options_.filter.start.reset();
  settled_filter_ = newest_ = OdometryFilter(options_.filter);
  fed_.reset();
  checkpoints_.clear();
  readings_since_checkpoint_ = 0;
  newest_reading_.reset();
  ahead_.reset();
  ++counts_.num_restarts;
  const auto late = std::exchange(late_, {});
  const Time from =
      kept.front().raw.time - DurationFromSeconds(options_.window_s);
  const Time to = kept.back().raw.time + DurationFromSeconds(options_.window_s);
  for (const auto& [key, event] : late) {
    if (key.time >= from && key.time <= to) (void)Insert(key, event);
  }
  for (const Reading& reading : kept) {
    (void)InsertReading(reading.raw, reading.counter_bits);
  }
}

void DelayedFusion::Finish() {
  if (!newest_reading_) return;
  Settle(*newest_reading_ + Duration(1));
}

std::vector<Settled> DelayedFusion::TakeSettled() {
  return std::exchange(settled_, {});
}

Arrival DelayedFusion::InsertReading(const EncoderReading& raw,
                                     int counter_bits) {
  const Arrival arrival = Insert({raw.time, kReading, "", raw.seq},
                                 Event(Reading{raw, counter_bits}));
  if (arrival != Arrival::kTaken) return arrival;
  if (!newest_reading_ || raw.time > *newest_reading_) {
    newest_reading_ = raw.time;
  }
  CatchUp();
  Settle(*newest_reading_ - DurationFromSeconds(options_.window_s));
  return arrival;
}

Arrival DelayedFusion::AddReading(const EncoderReading& raw, int counter_bits) {
  const Duration max_ahead = DurationFromSeconds(options_.max_ahead_s);
  if (newest_reading_ && raw.time > *newest_reading_ + max_ahead) {
    const bool confirms = ahead_ && raw.time != ahead_->raw.time &&
                          raw.time < ahead_->raw.time + max_ahead &&
                          ahead_->raw.time < raw.time + max_ahead;
    if (!confirms) {
      // The one before it was alone: a wrong stamp.
      if (ahead_) ++counts_.num_ahead;
      ahead_ = Reading{raw, counter_bits};
      return Arrival::kAhead;
    }
    const Reading first = *std::exchange(ahead_, std::nullopt);
    (void)InsertReading(first.raw, first.counter_bits);
    return InsertReading(raw, counter_bits);
  }
  if (!IsBehindWindow(raw.time)) {
    behind_.clear();
    return InsertReading(raw, counter_bits);
  }
  ++counts_.num_late;
  if (!behind_.empty() && raw.time <= behind_.back().raw.time) behind_.clear();
  behind_.push_back({raw, counter_bits});
  if (static_cast<int>(behind_.size()) < options_.restart_after) {
    return Arrival::kLate;
  }
  const std::vector<Reading> kept = std::exchange(behind_, {});
  Restart(kept);
  return Arrival::kRestarted;
}

Arrival DelayedFusion::AddFix(const AbsoluteFix& fix) {
  const Arrival arrival = Insert({fix.time, kFix, fix.source, fix.seq},
                                 Event(OdometryFilter::Measurement(fix)));
  CatchUp();
  return arrival;
}

Arrival DelayedFusion::AddMotion(const RelativeMotion& motion) {
  const Key start{motion.from, kMotionStart, motion.source, motion.seq};
  const Key end{motion.time, kMotion, motion.source, motion.seq};
  Event start_event(OdometryFilter::Measurement(MotionStart{motion.time}));
  Event end_event{OdometryFilter::Measurement(motion)};
  if (IsBehindWindow(motion.from)) {
    // Kept with its start, for the case that everything starts anew.
    const Arrival arrival = Insert(start, std::move(start_event));
    KeepLate(end, std::move(end_event));
    return arrival;
  }
  Arrival arrival = Insert(start, std::move(start_event));
  if (arrival != Arrival::kTaken) return arrival;
  arrival = Insert(end, std::move(end_event));
  if (arrival != Arrival::kTaken) history_.erase(start);
  CatchUp();
  return arrival;
}

Arrival DelayedFusion::AddInitialPose(const InitialPose& pose) {
  const Arrival arrival =
      Insert({pose.time, kInitialPose, pose.source, pose.seq},
             Event(OdometryFilter::Measurement(pose)));
  CatchUp();
  return arrival;
}

Arrival DelayedFusion::AddParameters(const OdometryParameters& parameters) {
  Time time = parameters.time;
  if (parameters.source == "batch") {
    time += DurationFromSeconds(options_.window_s);
  }
  const Arrival arrival =
      Insert({time, kParameters, parameters.source, Microseconds(time)},
             Event(OdometryFilter::Measurement(parameters)));
  CatchUp();
  return arrival;
}

}  // namespace waymark
