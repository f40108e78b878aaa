// Delayed measurements, fused at their own times.
#pragma once

#include "estimation/base/time.h"
#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"
#include "estimation/filter/odometry_filter.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace waymark {

struct DelayedFusionOptions {
  OdometryFilterOptions filter;
  // A message that arrives while the newest reading is at most this much newer
  // than it still counts; for a relative motion its start must be. Estimates
  // older than that are settled.
  double window_s = 2.0;
  // A reading this far ahead of all others waits until a second one confirms
  // that time went on: one wrong stamp must not close the window.
  double max_ahead_s = 10.0;
  // So many readings in a row behind the window mean that time itself went
  // back (a log started over, a clock set): everything starts anew, with what
  // arrived late meanwhile. The configured start is not used again: the robot
  // may be anywhere.
  int restart_after = 20;
  // Bound of messages newer than the newest reading; more are dropped.
  std::size_t max_waiting = 20000;
};

enum class Arrival {
  kTaken,
  kDuplicate,  // Same time, source and sequence as one in the window.
  kLate,       // Older than the window.
  kAhead,      // A reading far ahead, not confirmed (yet).
  kFull,       // Too many wait.
  kRestarted,  // Taken, and all before it forgotten: time went back.
};

struct DelayedFusionCounts {
  std::int64_t num_duplicates = 0;
  std::int64_t num_late = 0;
  std::int64_t num_ahead = 0;
  std::int64_t num_full = 0;
  std::int64_t num_restarts = 0;
  std::int64_t num_recomputed = 0;  // Messages that arrived out of order.
};

// One reading once nothing can change it any more.
struct Settled {
  PoseEstimate pose;
  OdometryParameters parameters;
  OdometryFilterCounts counts;
};

// Keeps a history of the window, ordered by (time, rank, source, sequence);
// ranks: parameters, initial poses, fixes, relative motions, starts of relative
// motions, readings. Two filters run over it: one to the newest reading, that
// goes back to a checkpoint where a message arrives out of order, and one
// behind the window, that never goes back. What the latter says depends on the
// set of messages only, not on their arrival, as long as each arrives within
// the window: the same bits as OdometryFilter fed in order.
//
// A relative motion is two events: its start, where the filter keeps the pose,
// and its end, where it is fused. So it sends the filter back to its start, and
// its interval and delay together must fit into the window.
//
// Fixes and the like take effect with the first reading at or after their
// time, so without readings nothing settles. Parameters with source "batch"
// take effect one window after their time: their computation took a while.
//
// Deterministic. Cost: some microseconds per message in order; out of order,
// those times the messages since.
class DelayedFusion {
 public:
  explicit DelayedFusion(const DelayedFusionOptions& options);

  Arrival AddReading(const EncoderReading& raw, int counter_bits);
  Arrival AddFix(const AbsoluteFix& fix);
  Arrival AddMotion(const RelativeMotion& motion);
  Arrival AddInitialPose(const InitialPose& pose);
  Arrival AddParameters(const OdometryParameters& parameters);

  // Right now, at the newest reading.
  [[nodiscard]] const OdometryFilter& newest() const { return newest_; }
  // What settled since the last call, one per reading, oldest first.
  [[nodiscard]] std::vector<Settled> TakeSettled();
  // No more messages will come: everything held settles.
  void Finish();
  [[nodiscard]] const DelayedFusionCounts& counts() const { return counts_; }
  // Time of the newest reading, if there is one.
  [[nodiscard]] std::optional<Time> newest_time() const;

 private:
  struct Key {
    Time time;
    int rank = 0;
    std::string source;
    std::int64_t seq = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Reading {
    EncoderReading raw;
    int counter_bits = 0;
  };
  using Event = std::variant<OdometryFilter::Measurement, Reading>;
  struct Checkpoint {
    Key key;  // Of the last event in it.
    OdometryFilter filter;
  };

  Arrival Insert(Key key, Event event);
  void KeepLate(Key key, Event event);
  Arrival InsertReading(const EncoderReading& raw, int counter_bits);
  static bool Feed(const Key& key, const Event& event, OdometryFilter* filter);
  bool DropOneWaiting(const Key& key);
  void CatchUp();
  void Settle(Time before);
  [[nodiscard]] bool IsBehindWindow(Time time) const;
  void Restart(const std::vector<Reading>& kept);

  DelayedFusionOptions options_;
  std::map<Key, Event> history_;  // Not settled yet.
  OdometryFilter settled_filter_;
  OdometryFilter newest_;
  std::optional<Key> fed_;  // Last event that `newest_` has seen.
  std::deque<Checkpoint> checkpoints_;
  int readings_since_checkpoint_ = 0;
  std::optional<Time> newest_reading_;
  std::optional<Reading> ahead_;
  std::vector<Reading> behind_;             // Late readings in a row.
  std::deque<std::pair<Key, Event>> late_;  // The newest late other messages.
  std::vector<Settled> settled_;
  DelayedFusionCounts counts_;
};

}  // namespace waymark
