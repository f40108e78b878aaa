#include "logs/evaluation/sight_health.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <iterator>

namespace waymark {
namespace {

// ENCODERS farther from an image than this say nothing of its time: some of
// their periods at 50 Hz.
constexpr std::int64_t kMaxGapUs = 200'000;

}  // namespace

LatencySummary SummariseLatency(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const std::size_t n = ms.size();
  LatencySummary summary;
  summary.num = static_cast<std::int64_t>(n);
  summary.median_ms = 0.5 * (ms[(n - 1) / 2] + ms[n / 2]);
  summary.p95_ms = ms[(95 * n + 99) / 100 - 1];  // As p99.
  summary.p99_ms = ms[(99 * n + 99) / 100 - 1];  // ceil(0.99 n)-th smallest.
  summary.max_ms = ms.back();
  return summary;
}

void SightClock::OnEncoders(std::int64_t utime, Time t) {
  encoders_.emplace(utime, t);
}

void SightClock::OnImage(const std::string& channel,
                         std::int64_t utime,
                         std::int64_t seq) {
  cameras_[channel].images[utime] = seq;
}

void SightClock::OnAnswer(const std::string& channel,
                          std::int64_t utime,
                          bool has_heading,
                          Time t) {
  Camera& camera = cameras_[channel];
  camera.answered.insert(utime);
  camera.answers.push_back({utime, t});
  if (has_heading) waiting_.emplace_back(channel, utime);
}

void SightClock::OnPose(Time t) {
  for (const auto& [channel, utime] : waiting_) {
    cameras_[channel].poses.push_back({utime, t});
  }
  waiting_.clear();
}

std::optional<LatencySummary> SightClock::Summarise(
    const std::vector<Delay>& delays) const {
  std::vector<double> ms;
  for (const Delay& delay : delays) {
    // The nearest of those around it.
    auto at = encoders_.lower_bound(delay.utime);
    if (at != encoders_.begin() &&
        (at == encoders_.end() ||
         delay.utime - std::prev(at)->first < at->first - delay.utime)) {
      --at;
    }
    if (at == encoders_.end() ||
        std::abs(at->first - delay.utime) > kMaxGapUs) {
      continue;
    }
    const Time exposed =
        at->second + std::chrono::microseconds(delay.utime - at->first);
    // Microseconds to milliseconds.
    ms.push_back(static_cast<double>((delay.out - exposed).count()) * 1e-3);
  }
  if (ms.empty()) return std::nullopt;
  return SummariseLatency(std::move(ms));
}

std::optional<SightHealth> SightClock::Finish(bool is_live) const {
  const auto most = std::max_element(
      cameras_.begin(), cameras_.end(), [](const auto& a, const auto& b) {
        return a.second.answered.size() < b.second.answered.size();
      });
  if (most == cameras_.end() || most->second.answered.empty()) {
    return std::nullopt;
  }
  const Camera& camera = most->second;
  SightHealth health;
  health.channel = most->first;
  std::int64_t last_seq = -1;
  const auto end = camera.images.upper_bound(*camera.answered.rbegin());
  for (auto it = camera.images.lower_bound(*camera.answered.begin()); it != end;
       ++it) {
    const auto& [utime, seq] = *it;
    ++health.num_images;
    if (!camera.answered.contains(utime)) ++health.num_unanswered;
    // A smaller number is a camera that started again.
    if (last_seq >= 0 && seq > last_seq + 1) {
      health.num_lost += seq - last_seq - 1;
    }
    last_seq = seq;
  }
  if (is_live) {
    health.to_answer = Summarise(camera.answers);
    health.to_pose = Summarise(camera.poses);
  }
  return health;
}

}  // namespace waymark
