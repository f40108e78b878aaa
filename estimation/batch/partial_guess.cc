#include "estimation/batch/partial_guess.h"

#include "estimation/geometry/angle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace waymark {
namespace {

struct Sample {
  double time = 0.0;
  double value = 0.0;
};

// Each value becomes the median of itself and its neighbours: up to four wild
// ones in a row vanish.
void Smooth(std::vector<Sample>* samples) {
  constexpr std::size_t kReach = 4;
  const std::vector<Sample> raw = *samples;
  std::vector<double> window;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const std::size_t begin = i < kReach ? 0 : i - kReach;
    const std::size_t end = std::min(raw.size(), i + kReach + 1);
    window.clear();
    for (std::size_t j = begin; j < end; ++j) window.push_back(raw[j].value);
    const auto middle =
        window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
    std::nth_element(window.begin(), middle, window.end());
    (*samples)[i].value = *middle;
  }
}

// Linear between samples, constant outside; 0 without any.
double At(const std::vector<Sample>& samples, double time) {
  if (samples.empty()) return 0.0;
  const auto after = std::lower_bound(
      samples.begin(), samples.end(), time, [](const Sample& s, double t) {
        return s.time < t;
      });
  if (after == samples.begin()) return samples.front().value;
  if (after == samples.end()) return samples.back().value;
  const Sample& a = *(after - 1);
  const double share = (time - a.time) / (after->time - a.time);
  return a.value + share * (after->value - a.value);
}

double TimeOf(const BatchFixInput& input,
              std::span<const BatchSensorSlot> sensors) {
  return input.time -
         sensors[static_cast<std::size_t>(input.sensor)].nominal(3);
}

// Poses by dead reckoning at ascending times, headings not wrapped.
std::vector<Eigen::Vector3d> Reckon(const BatchLogInput& log,
                                    std::span<const double> times,
                                    const BatchOptions& options) {
  std::vector<Eigen::Vector3d> poses;
  Pose2 X_OR;
  double heading = 0.0;
  double last = 0.0;
  for (const double time : times) {
    const TrackMotion step = log.track.Integrate(
        last, time, options.initial, DriveNoise{}, options.integration);
    X_OR = X_OR * step.X_R0R1;
    heading += WrapAngle(X_OR.heading - heading);
    poses.emplace_back(X_OR.x, X_OR.y, heading);
    last = time;
  }
  return poses;
}

// Measured minus reckoned heading.
std::vector<Sample> HeadingOffsets(const BatchLogInput& log,
                                   std::span<const BatchSensorSlot> sensors,
                                   const BatchOptions& options) {
  std::vector<const BatchFixInput*> used;
  std::vector<double> times;
  for (const BatchFixInput& input : log.fixes) {
    if (!input.fix->has[2]) continue;
    used.push_back(&input);
    times.push_back(std::max(TimeOf(input, sensors), 0.0));
  }
  // Offsets in the clocks of several sensors may cross.
  for (std::size_t i = 1; i < times.size(); ++i) {
    times[i] = std::max(times[i], times[i - 1]);
  }
  const std::vector<Eigen::Vector3d> reckoned = Reckon(log, times, options);
  std::vector<Sample> offsets;
  double near = 0.0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const AbsoluteFix& fix = *used[i]->fix;
    const double yaw =
        sensors[static_cast<std::size_t>(used[i]->sensor)].nominal(2);
    const double offset =
        fix.X_WF.heading + fix.value(2) - yaw - reckoned[i](2);
    near += WrapAngle(offset - near);
    offsets.push_back({times[i], near});
  }
  Smooth(&offsets);
  return offsets;
}

// The path with its headings turned, from `start`.
std::vector<Eigen::Vector3d> Turned(
    const std::vector<Eigen::Vector3d>& reckoned,
    std::span<const double> times,
    const std::vector<Sample>& offsets,
    const Pose2& start,
    double start_offset) {
  std::vector<Eigen::Vector3d> poses;
  Eigen::Vector2d p = start.position();
  for (std::size_t i = 0; i < reckoned.size(); ++i) {
    const double offset =
        offsets.empty() ? start_offset : At(offsets, times[i]);
    if (i > 0) {
      const Eigen::Vector2d step = (reckoned[i] - reckoned[i - 1]).head<2>();
      const double before =
          offsets.empty() ? start_offset : At(offsets, times[i - 1]);
      p += Pose2{0.0, 0.0, 0.5 * (before + offset)} * step;
    }
    poses.emplace_back(p.x(), p.y(), reckoned[i](2) + offset);
  }
  return poses;
}

struct Shift {
  double time = 0.0;
  Eigen::Vector2d axis_W = Eigen::Vector2d::Zero();
  double value = 0.0;  // Along it, m.
};

// What x or y of each fix says beyond the path; poses at the fixes' times.
std::vector<Shift> ShiftsOf(const std::vector<const BatchFixInput*>& used,
                            std::span<const BatchSensorSlot> sensors,
                            const std::vector<Eigen::Vector3d>& poses) {
  std::vector<Shift> shifts;
  for (int k = 0; k < 2; ++k) {
    std::vector<Sample> samples;
    std::vector<Eigen::Vector2d> axes;
    for (std::size_t i = 0; i < used.size(); ++i) {
      const AbsoluteFix& fix = *used[i]->fix;
      if (!fix.has[static_cast<std::size_t>(k)]) continue;
      const Eigen::Vector4d& sensor =
          sensors[static_cast<std::size_t>(used[i]->sensor)].nominal;
      const Eigen::Vector2d p_WS =
          Pose2::FromVector(poses[i]) * Eigen::Vector2d(sensor.head<2>());
      const Eigen::Vector2d p_FS = Inverse(fix.X_WF) * p_WS;
      samples.push_back({TimeOf(*used[i], sensors), fix.value(k) - p_FS(k)});
      const double h = fix.X_WF.heading;
      axes.push_back(k == 0 ? Eigen::Vector2d(std::cos(h), std::sin(h))
                            : Eigen::Vector2d(-std::sin(h), std::cos(h)));
    }
    Smooth(&samples);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      shifts.push_back({samples[i].time, axes[i], samples[i].value});
    }
  }
  std::stable_sort(
      shifts.begin(), shifts.end(), [](const Shift& a, const Shift& b) {
        return a.time < b.time;
      });
  return shifts;
}

}  // namespace

std::vector<Eigen::Vector3d> GuessFromParts(
    const BatchLogInput& log,
    std::span<const BatchSensorSlot> sensors,
    std::span<const double> times,
    const BatchOptions& options) {
  // Where the path is wanted, and where fixes look at it.
  std::vector<const BatchFixInput*> used;
  std::vector<double> all(times.begin(), times.end());
  for (const BatchFixInput& input : log.fixes) {
    used.push_back(&input);
    all.push_back(std::max(TimeOf(input, sensors), 0.0));
  }
  if (log.start) all.push_back(log.track.SecondsAt(log.start->time));
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const auto index_of = [&all](double time) {
    return static_cast<std::size_t>(
        std::lower_bound(all.begin(), all.end(), std::max(time, 0.0)) -
        all.begin());
  };

  const std::vector<Eigen::Vector3d> reckoned = Reckon(log, all, options);
  const std::vector<Sample> offsets = HeadingOffsets(log, sensors, options);
  double start_offset = 0.0;
  if (log.start) {
    const std::size_t i = index_of(log.track.SecondsAt(log.start->time));
    start_offset = log.start->X_WR.heading - reckoned[i](2);
  }
  std::vector<Eigen::Vector3d> path =
      Turned(reckoned, all, offsets, Pose2{}, start_offset);
  if (log.start) {
    const std::size_t i = index_of(log.track.SecondsAt(log.start->time));
    const Eigen::Vector2d to_start =
        log.start->X_WR.position() - path[i].head<2>();
    for (Eigen::Vector3d& pose : path) pose.head<2>() += to_start;
  }

  std::vector<Eigen::Vector3d> at_fixes;
  for (const BatchFixInput* input : used) {
    at_fixes.push_back(path[index_of(TimeOf(*input, sensors))]);
  }
  const std::vector<Shift> shifts = ShiftsOf(used, sensors, at_fixes);
  std::vector<Eigen::Vector3d> poses;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  std::size_t next = 0;
  for (const double time : times) {
    // Before the first fix the path is moved as there.
    while (next < shifts.size() && (shifts[next].time <= time || next == 0)) {
      const Shift& s = shifts[next++];
      shift += s.axis_W * (s.value - s.axis_W.dot(shift));
    }
    Eigen::Vector3d pose = path[index_of(time)];
    pose.head<2>() += shift;
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace waymark
