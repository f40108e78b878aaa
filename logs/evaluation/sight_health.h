// Whether and when images were answered: a camera's, from exposure to pose.
#pragma once

#include "estimation/base/time.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace waymark {

// Log time of an output minus log time of the input that caused it.
struct LatencySummary {
  std::int64_t num = 0;
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};
// Of at least one value.
[[nodiscard]] LatencySummary SummariseLatency(std::vector<double> ms);

struct SightHealth {
  std::string channel;  // IMAGE_<camera>.
  // From the first to the last image that was answered:
  std::int64_t num_images = 0;  // In the log,
  std::int64_t num_unanswered =
      0;                      // of those; a busy tracker takes the newest.
  std::int64_t num_lost = 0;  // Gaps in their numbers: never sent, or not
                              // recorded.
  // From the image's time, by the clock of ENCODERS in the log, to the answer,
  // and to the first POSE after an answer with a heading. Absent offline, and
  // without ENCODERS.
  std::optional<LatencySummary> to_answer;
  std::optional<LatencySummary> to_pose;
};

// Told of a log's messages in their order; `t` is the log's time.
class SightClock {
 public:
  void OnEncoders(std::int64_t utime, Time t);
  // `seq`: -1 where it has no number.
  void OnImage(const std::string& channel,
               std::int64_t utime,
               std::int64_t seq);
  void OnAnswer(const std::string& channel,
                std::int64_t utime,
                bool has_heading,
                Time t);
  void OnPose(Time t);

  // Of the camera with most answers; nullopt without any.
  [[nodiscard]] std::optional<SightHealth> Finish(bool is_live) const;

 private:
  struct Delay {
    std::int64_t utime;
    Time out;
  };
  struct Camera {
    std::map<std::int64_t, std::int64_t> images;  // utime to seq.
    std::set<std::int64_t> answered;              // utime.
    std::vector<Delay> answers;
    std::vector<Delay> poses;
  };
  [[nodiscard]] std::optional<LatencySummary> Summarise(
      const std::vector<Delay>& delays) const;

  std::map<std::int64_t, Time> encoders_;  // utime to log time.
  std::map<std::string, Camera> cameras_;
  // Answers that no POSE has followed yet: camera, utime.
  std::vector<std::pair<std::string, std::int64_t>> waiting_;
};

}  // namespace waymark
