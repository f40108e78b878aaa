#include "logs/import/write_imported_log.h"

#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"

#include <waymark/config_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <sstream>
#include <system_error>
#include <vector>

namespace waymark {
namespace {

// Text in double quotes, as YAML reads it.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c >= 0 && c < ' ' ? ' ' : c;
  }
  return quoted + "\"";
}

config_t ConfigMessage(const Recording& recording,
                       const ReferenceSplitOptions& options,
                       Time time) {
  std::ostringstream yaml;
  const bool is_running = options.use == ReferenceUse::kRunning;
  yaml << "format: " << recording.format << "\n"
       << "recording: " << Quoted(recording.name) << "\n"
       << "reference: " << Quoted(recording.reference.source) << "\n"
       << "use: " << (is_running ? "running" : "calibration") << "\n";
  if (is_running) {
    yaml << "every: " << options.every << "\n"
         << "noise_m: " << options.noise_m << "\n"
         << "noise_rad: " << options.noise_rad << "\n"
         << "seed: " << options.seed << "\n";
  }
  yaml << "heading: " << (options.use_heading ? "true" : "false") << "\n";
  if (recording.has_virtual_ticks) {
    yaml << "virtual_tick: " << Quoted(recording.virtual_resolution) << "\n";
  }
  yaml << "notes:" << (recording.notes.empty() ? " []\n" : "\n");
  for (const std::string& note : recording.notes) {
    yaml << "  - " << Quoted(note) << "\n";
  }
  config_t message;
  message.utime = Microseconds(time);
  message.seq = 0;
  message.process = "waymark-log import";
  message.version = WAYMARK_VERSION;
  message.yaml = yaml.str();
  return message;
}

truth_t TruthMessage(const TruthSample& sample,
                     const std::string& source,
                     std::size_t seq) {
  truth_t message{};
  message.utime = Microseconds(sample.time);
  message.seq = static_cast<std::int32_t>(seq);
  message.source = source;
  message.has_heading = sample.heading.has_value() ? 1 : 0;
  message.x = sample.p_WS.x();
  message.y = sample.p_WS.y();
  message.heading = sample.heading.value_or(0.0);
  message.sensor_R[0] = sample.p_RS.x();
  message.sensor_R[1] = sample.p_RS.y();
  message.sensor_R[2] = 0.0;
  return message;
}

planar_lidar_t RangesMessage(const RangeScan& scan) {
  planar_lidar_t message{};
  message.utime = Microseconds(scan.time);
  message.nranges = static_cast<std::int32_t>(scan.ranges.size());
  message.ranges = scan.ranges;
  message.nintensities = 0;
  message.rad0 = static_cast<float>(scan.first_angle);
  message.radstep = static_cast<float>(scan.step);
  return message;
}

// Messages that are not written yet. Encoding waits until its turn, so that
// memory holds no second copy of the recording.
class Schedule {
 public:
  void Add(Time time, std::function<void(LogWriter*)> write) {
    entries_.push_back({time, std::move(write)});
  }
  [[nodiscard]] Time FirstTime() const {
    return std::min_element(entries_.begin(), entries_.end(), Earlier)->time;
  }
  void WriteAll(LogWriter* writer, Duration* duration) {
    std::stable_sort(entries_.begin(), entries_.end(), Earlier);
    for (const Entry& entry : entries_) entry.write(writer);
    *duration = entries_.back().time - entries_.front().time;
  }

 private:
  struct Entry {
    Time time;
    std::function<void(LogWriter*)> write;
  };
  static bool Earlier(const Entry& a, const Entry& b) {
    return a.time < b.time;
  }
  std::vector<Entry> entries_;
};

void AddMeasurements(const Recording& recording,
                     const ReferenceSplit& split,
                     Schedule* schedule) {
  for (const EncoderReading& reading : recording.encoders) {
    schedule->Add(reading.time, [&](LogWriter* writer) {
      // The importer has removed the counters' wraps: 0 bits.
      writer->Write(kEncoders,
                    ToMessage(reading, 0, recording.has_virtual_ticks));
    });
  }
  for (const RelativeMotion& motion : recording.motions) {
    schedule->Add(motion.time, [&](LogWriter* writer) {
      writer->Write(kRelativeMotion, ToMessage(motion));
    });
  }
  for (const AbsoluteFix& fix : split.fixes) {
    schedule->Add(fix.time, [&](LogWriter* writer) {
      writer->Write(kPositionFix, ToMessage(fix));
    });
  }
  for (std::size_t i = 0; i < split.truth.size(); ++i) {
    schedule->Add(split.truth[i].time, [&, i](LogWriter* writer) {
      writer->Write(
          kTruth, TruthMessage(split.truth[i], recording.reference.source, i));
    });
  }
  for (const RangeScan& scan : recording.scans) {
    schedule->Add(scan.time, [&](LogWriter* writer) {
      writer->Write(kRanges, RangesMessage(scan));
    });
  }
}

// Removes what is left of an unfinished file.
class PartialFile {
 public:
  explicit PartialFile(std::string path) : path_(std::move(path)) {}
  ~PartialFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  void RenameTo(const std::string& path) {
    std::error_code error;
    std::filesystem::rename(path_, path, error);
    if (error) throw InputError(path + ": " + error.message());
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

ImportSummary WriteImportedLog(const Recording& recording,
                               const ReferenceSplitOptions& options,
                               const std::string& path,
                               IfExists if_exists) {
  const ReferenceSplit split = SplitReference(recording.reference, options);
  CheckOutput(path, if_exists, {});
  Schedule schedule;
  // First, so that it comes before a fix of the same time.
  if (recording.start) {
    schedule.Add(recording.start->time, [&](LogWriter* writer) {
      writer->Write(kInitialPose, ToMessage(*recording.start));
    });
  }
  AddMeasurements(recording, split, &schedule);
  const Time first = schedule.FirstTime();

  PartialFile partial(path + ".part");
  LogWriter writer(partial.path(), IfExists::kReplace);
  writer.Write(kConfig, ConfigMessage(recording, options, first));
  OdometryParameters nominal = recording.nominal;
  nominal.time = first;
  writer.Write(kOdometryParameters, ToMessage(nominal, 0));
  Duration duration{0};
  schedule.WriteAll(&writer, &duration);
  ImportSummary summary;
  summary.num_events = writer.num_events();
  writer.Close();
  partial.RenameTo(path);

  summary.num_encoders = static_cast<std::int64_t>(recording.encoders.size());
  summary.num_fixes = static_cast<std::int64_t>(split.fixes.size());
  summary.num_truth = static_cast<std::int64_t>(split.truth.size());
  summary.num_motions = static_cast<std::int64_t>(recording.motions.size());
  summary.num_scans = static_cast<std::int64_t>(recording.scans.size());
  summary.duration_s = Seconds(duration);
  summary.path_by_wheels = recording.reference.samples.empty();
  summary.path_m = summary.path_by_wheels ? WheelPathLength(recording)
                                          : PathLength(recording.reference);
  return summary;
}

}  // namespace waymark
