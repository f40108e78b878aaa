#include "estimation/batch/batch_input.h"

#include "estimation/geometry/angle.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

bool IsFinite(const Pose2& X) {
  return X.vector().allFinite();
}

bool IsPositiveDefinite(const Eigen::MatrixXd& covariance) {
  return covariance.allFinite() &&
         Eigen::LLT<Eigen::MatrixXd>(covariance).info() == Eigen::Success;
}

bool IsUsable(const AbsoluteFix& fix) {
  std::vector<int> present;
  for (int i = 0; i < 3; ++i) {
    if (fix.has[static_cast<std::size_t>(i)]) present.push_back(i);
  }
  if (present.empty() || !IsFinite(fix.X_WF) || !IsFinite(fix.X_RS)) {
    return false;
  }
  return Eigen::VectorXd(fix.value(present)).allFinite() &&
         IsPositiveDefinite(fix.covariance(present, present));
}

bool IsUsable(const RelativeMotion& motion) {
  return motion.from < motion.time && IsFinite(motion.X_S0S1) &&
         IsFinite(motion.X_RS) && IsPositiveDefinite(motion.covariance);
}

bool IsUsable(const StartPose& start) {
  return IsFinite(start.X_WR) && IsPositiveDefinite(start.covariance);
}

const BatchSensorOptions* OptionsOf(const std::string& source,
                                    const BatchOptions& options) {
  const BatchSensorOptions* fallback = nullptr;
  for (const BatchSensorOptions& sensor : options.sensors) {
    if (sensor.source == source) return &sensor;
    if (sensor.source.empty()) fallback = &sensor;
  }
  return fallback;
}

// Index of the slot for measurements of `source` in `log`, made where there is
// none yet.
int SlotOf(const std::string& source,
           int log,
           const Pose2& X_RS,
           const BatchOptions& options,
           std::vector<BatchSensorSlot>* slots) {
  const BatchSensorOptions* found = OptionsOf(source, options);
  const BatchSensorOptions asked =
      found != nullptr ? *found : BatchSensorOptions{};
  const int owner = asked.shared ? -1 : log;
  for (std::size_t i = 0; i < slots->size(); ++i) {
    const BatchSensorSlot& slot = (*slots)[i];
    if (slot.source == source && slot.log == owner) return static_cast<int>(i);
  }
  BatchSensorSlot slot;
  slot.source = source;
  slot.log = owner;
  slot.options = asked;
  slot.nominal << X_RS.vector(), asked.time_offset_s;
  slots->push_back(slot);
  return static_cast<int>(slots->size()) - 1;
}

// A sensor has one mounting: what a pan-tilt head measures while it looks
// elsewhere is of another.
bool IsMountedAs(const BatchSensorSlot& slot, const Pose2& X_RS) {
  constexpr double kSameM = 1e-3;
  constexpr double kSameRad = 1e-3;
  const Eigen::Vector3d nominal = slot.nominal.head<3>();
  return (X_RS.position() - nominal.head<2>()).norm() < kSameM &&
         std::abs(WrapAngle(X_RS.heading - nominal.z())) < kSameRad;
}

BatchLogInput PrepareLog(const BatchLog& log,
                         int index,
                         const BatchOptions& options,
                         BatchInput* input) {
  BatchLogInput ready{.track = TickTrack(log.encoders),
                      .fixes = {},
                      .motions = {},
                      .start = std::nullopt};
  const TickTrack& track = ready.track;
  input->num_refused += track.num_refused();
  if (track.empty()) {
    input->num_refused += static_cast<int>(log.fixes.size()) +
                          static_cast<int>(log.motions.size());
    return ready;
  }
  const auto is_inside = [&](double time, int sensor) {
    const double t =
        time - input->sensors[static_cast<std::size_t>(sensor)].nominal(3);
    return t >= 0.0 && t <= track.duration();
  };
  for (const AbsoluteFix& fix : log.fixes) {
    if (IsUsable(fix)) {
      const int sensor =
          SlotOf(fix.source, index, fix.X_RS, options, &input->sensors);
      const double time = track.SecondsAt(fix.time);
      if (is_inside(time, sensor) &&
          IsMountedAs(input->sensors[static_cast<std::size_t>(sensor)],
                      fix.X_RS)) {
        ready.fixes.push_back({&fix, sensor, time});
        continue;
      }
    }
    ++input->num_refused;
  }
  for (const RelativeMotion& motion : log.motions) {
    if (IsUsable(motion)) {
      const int sensor =
          SlotOf(motion.source, index, motion.X_RS, options, &input->sensors);
      const double from = track.SecondsAt(motion.from);
      const double time = track.SecondsAt(motion.time);
      if (is_inside(from, sensor) && is_inside(time, sensor)) {
        ready.motions.push_back({&motion, sensor, from, time});
        continue;
      }
    }
    ++input->num_refused;
  }
  const auto by_time = [](const auto& a, const auto& b) {
    return a.time < b.time;
  };
  std::stable_sort(ready.fixes.begin(), ready.fixes.end(), by_time);
  std::stable_sort(ready.motions.begin(), ready.motions.end(), by_time);
  if (log.start && IsUsable(*log.start)) {
    const double t = track.SecondsAt(log.start->time);
    if (t >= 0.0 && t <= track.duration()) ready.start = log.start;
  }
  return ready;
}

}  // namespace

BatchInput PrepareBatch(std::span<const BatchLog> logs,
                        const BatchOptions& options) {
  BatchInput input;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    input.logs.push_back(
        PrepareLog(logs[i], static_cast<int>(i), options, &input));
    const BatchLogInput& log = input.logs.back();
    input.num_measurements +=
        static_cast<int>(log.fixes.size() + log.motions.size());
    if (!log.track.empty()) input.travel_m += log.track.Travel(options.initial);
    if (!log.fixes.empty()) {
      input.newest = std::max(input.newest, log.fixes.back().fix->time);
    }
    if (!log.motions.empty()) {
      input.newest = std::max(input.newest, log.motions.back().motion->time);
    }
  }
  return input;
}

}  // namespace waymark
