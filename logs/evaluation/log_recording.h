// What a log says that evaluation needs, as values.
#pragma once

#include "estimation/filter/estimate_types.h"
#include "estimation/filter/measurement_types.h"
#include "logs/evaluation/dead_reckoning.h"
#include "logs/evaluation/sight_health.h"
#include "logs/evaluation/trajectory_types.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/corridor_convert.h"
#include "processes/convert/image_convert.h"
#include "processes/support/log_file.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace waymark {

struct ChannelHealth {
  std::int64_t num_messages = 0;
  std::int64_t num_bad = 0;   // Of a known channel, but not decodable.
  std::int64_t num_lost = 0;  // Gaps in the senders' sequence numbers.
  // By the messages' own clock (utime) where they have one, otherwise by the
  // log's. 0 where fewer than two.
  double rate_hz = 0.0;
  double longest_gap_s = 0.0;
};

// Faults of a process that differ in their numbers at most.
struct ProcessFault {
  std::string text;      // Of the newest STATUS with it.
  int num = 0;           // Of STATUS messages that tell of it.
  double first_s = 0.0;  // Since the log's first event.
};

// Newest STATUS of one process, and the worst of all.
struct ProcessHealth {
  std::int64_t num_statuses = 0;
  std::int64_t num_received = 0;
  std::int64_t num_published = 0;
  std::int64_t num_lost = 0;
  std::int64_t num_dropped = 0;
  std::int64_t num_bad = 0;
  std::optional<std::int64_t> worst_handler_us;  // Absent offline.
  std::vector<ProcessFault> faults;              // In order of the first.
};

// An image of a camera, as a file of its own.
struct RecordedPicture {
  std::string channel;
  Time time;
  std::optional<HeadAngles> head;
  ImageFile file;
};

struct LogRecording {
  std::string path;
  LogReadReport read_report;
  double log_duration_s = 0.0;  // Between the first and the last event.

  std::vector<TruthSample> truth;
  std::string truth_source;
  std::vector<EncoderReading> readings;  // Counter wraps removed.
  bool has_virtual_ticks = false;
  std::vector<AbsoluteFix> fixes;
  std::optional<InitialPose> initial_pose;
  std::vector<CorridorAnswer> corridor;  // In order of the log.
  std::vector<RelativeMotion> relative_motions;

  // Keys: ODOMETRY (X_OR), POSE, POSE_SETTLED. Known poses only.
  std::map<std::string, std::vector<EstimatedPose>> poses;
  std::map<std::string, std::int64_t> num_unknown_poses;
  // Keys: "nominal", "online", "batch".
  std::map<std::string, std::vector<ParameterSample>> parameters;
  // Why a source had no answer, where it said so last.
  std::map<std::string, std::string> parameters_missing;
  std::optional<SensorCalibration> sensor;  // Newest of source "batch".

  // A few of each camera's, from its first to its last image, in order; by
  // channel.
  std::vector<RecordedPicture> pictures;
  // Newest calibration of each camera, by IMAGE_<camera>.
  std::map<std::string, CameraDescription> cameras;

  std::map<std::string, ChannelHealth> channels;
  std::map<std::string, LatencySummary> latency;  // Empty offline.
  std::optional<SightHealth> sight;               // Of CORRIDOR_POSE.
  std::map<std::string, ProcessHealth> processes;
  std::map<std::string, std::string> configs;  // YAML of each process.
  std::string version;                         // Of Waymark, from CONFIG.

  // POSITION_FIX holds samples of the reference itself.
  [[nodiscard]] bool is_reference_aided() const;
};

// Reads one log, or several as if they were one (outputs in one, their inputs
// in another). Messages that cannot be used are counted per channel. Throws
// InputError where a log cannot be read.
[[nodiscard]] LogRecording ReadRecording(std::span<const std::string> paths);

}  // namespace waymark
