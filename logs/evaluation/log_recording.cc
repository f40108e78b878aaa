#include "logs/evaluation/log_recording.h"

#include "estimation/filter/encoder_counter.h"
#include "processes/convert/camera_convert.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "processes/support/decode.h"

#include <waymark/bot_pose_t.hpp>
#include <waymark/camera_info_t.hpp>
#include <waymark/config_t.hpp>
#include <waymark/corridor_pose_t.hpp>
#include <waymark/encoders_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/odometry_parameters_t.hpp>
#include <waymark/planar_lidar_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/position_fix_t.hpp>
#include <waymark/relative_motion_t.hpp>
#include <waymark/status_t.hpp>
#include <waymark/truth_t.hpp>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

// Times of one channel, as rate and longest gap.
struct Cadence {
  std::optional<Time> first;
  Time last;
  double longest_gap_s = 0.0;

  void Add(Time t) {
    if (!first) {
      first = t;
    } else {
      longest_gap_s = std::max(longest_gap_s, Seconds(t - last));
    }
    last = t;
  }
};

bool IsFinite(double a, double b, double c) {
  return std::isfinite(a) && std::isfinite(b) && std::isfinite(c);
}

// What counts up or down in a text is no other fault.
std::string WithoutNumbers(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool is_number = (c >= '0' && c <= '9') || c == '.';
    if (!is_number) {
      result += c;
    } else if (result.empty() || result.back() != '#') {
      result += '#';
    }
  }
  return result;
}

// Keeps some of a stream of images, evenly spaced, without knowing its length:
// each k-th, and whenever there are too many of them, each second of those.
class SomeImages {
 public:
  void Add(image_t message) {
    if (num_++ % stride_ == 0) {
      kept_.push_back(std::move(message));
    } else {
      last_ = std::move(message);
    }
    if (kept_.size() <= kMaxKept) return;
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) {
      if (i > 0) kept_[i] = std::move(kept_[2 * i]);
    }
    kept_.resize((kept_.size() + 1) / 2);
    stride_ *= 2;
  }

  // As many as a row of pictures has, from the first to the last.
  void Finish(const std::string& channel,
              std::vector<RecordedPicture>* pictures) {
    if (last_ && (kept_.empty() || kept_.back().utime < last_->utime)) {
      kept_.push_back(std::move(*last_));
    }
    const std::size_t num_shown = std::min(kept_.size(), kNumShown);
    for (std::size_t i = 0; i < num_shown; ++i) {
      const std::size_t at =
          num_shown < 2 ? 0 : i * (kept_.size() - 1) / (num_shown - 1);
      std::string reason;
      auto file = ImageFileFromMessage(kept_[at], &reason);
      if (!file) continue;
      const auto tags = TagsFromMessage(kept_[at], &reason);
      pictures->push_back({channel,
                           TimeFromMicroseconds(kept_[at].utime),
                           tags ? tags->head : std::nullopt,
                           std::move(*file)});
    }
  }

 private:
  static constexpr std::size_t kNumShown = 6;
  // Enough that what is shown lies at equal distances.
  static constexpr std::size_t kMaxKept = 32;
  std::vector<image_t> kept_;
  std::optional<image_t> last_;
  std::int64_t num_ = 0;
  std::int64_t stride_ = 1;
};

// Collects one recording event by event.
class Collector {
 public:
  void Add(const LogEvent& event) {
    // A damaged record's time may be anything: it counts as the one before.
    if (Microseconds(event.time) > 0) last_ = event.time;
    if (!first_) first_ = last_;
    ChannelHealth& health = recording_.channels[event.channel];
    ++health.num_messages;
    if (!Dispatch(event)) {
      // Not one of ours: the log's own clock.
      cadences_[event.channel].Add(last_);
    }
  }

  LogRecording Finish() {
    if (first_) recording_.log_duration_s = Seconds(last_ - *first_);
    for (auto& [channel, cadence] : cadences_) {
      ChannelHealth& health = recording_.channels[channel];
      health.longest_gap_s = cadence.longest_gap_s;
      if (!cadence.first) continue;
      const double span = Seconds(cadence.last - *cadence.first);
      const auto num = health.num_messages - health.num_bad;
      if (span > 0.0 && num > 1) {
        health.rate_hz = static_cast<double>(num - 1) / span;
      }
    }
    for (auto& [channel, images] : images_) {
      images.Finish(channel, &recording_.pictures);
    }
    // Offline, outputs carry their inputs' log time: latency is absent.
    bool is_live = false;
    for (const auto& [channel, values] : latencies_) {
      is_live |= std::any_of(
          values.begin(), values.end(), [](double ms) { return ms != 0.0; });
    }
    if (is_live) {
      for (const auto& [channel, values] : latencies_) {
        recording_.latency[channel] = SummariseLatency(values);
      }
    }
    recording_.sight = sight_.Finish(is_live);
    return std::move(recording_);
  }

 private:
  bool Dispatch(const LogEvent& event) {
    const std::string& channel = event.channel;
    if (channel == kTruth) return Take<truth_t>(event);
    if (channel == kEncoders) return Take<encoders_t>(event);
    if (channel == kPositionFix) return Take<position_fix_t>(event);
    if (channel == kCorridorPose) return Take<corridor_pose_t>(event);
    if (channel == kRelativeMotion) return Take<relative_motion_t>(event);
    if (channel == kInitialPose) return Take<initial_pose_t>(event);
    if (channel == kOdometry || channel == kPose || channel == kPoseSettled) {
      return Take<pose_t>(event);
    }
    if (channel == kOdometryParameters) {
      return Take<odometry_parameters_t>(event);
    }
    if (channel == kStatus) return Take<status_t>(event);
    if (channel == kConfig) return Take<config_t>(event);
    if (channel == kPoseBot) return Take<bot_pose_t>(event);
    if (channel == kRanges) return Take<planar_lidar_t>(event);
    if (channel.starts_with(kCameraInfoPrefix)) {
      TakeCamera(event);
      return false;
    }
    if (channel.starts_with(kImagePrefix)) {
      // Others name their channels so too.
      auto image = DecodeMessage<image_t>(event.data);
      if (!image) return false;
      image_times_[image->utime] = last_;
      sight_.OnImage(channel, image->utime, SequenceOf(*image));
      images_[channel].Add(std::move(*image));
    }
    return false;
  }

  void TakeCamera(const LogEvent& event) {
    const auto message = DecodeMessage<camera_info_t>(event.data);
    if (!message) return;
    std::string reason;
    auto camera = CameraFromMessage(*message, &reason);
    if (!camera) return;
    recording_.cameras.insert_or_assign(
        std::string(kImagePrefix) +
            event.channel.substr(std::string_view(kCameraInfoPrefix).size()),
        std::move(*camera));
  }

  template <typename M>
  bool Take(const LogEvent& event) {
    const std::optional<M> message = DecodeAs<M>(event);
    // Differences of stamps that are not negative cannot overflow. Before its
    // first input a process states its health at time 0.
    if (!message || message->utime < 0 || !OnMessage(event, *message)) {
      ++recording_.channels[event.channel].num_bad;
      return true;
    }
    if (message->utime > 0) {
      cadences_[event.channel].Add(TimeFromMicroseconds(message->utime));
    }
    return true;
  }

  void CountSequence(const LogEvent& event,
                     const std::string& sender,
                     std::int64_t seq) {
    const auto [place, is_new] =
        sequences_.try_emplace({event.channel, sender}, seq);
    if (is_new) return;
    // A smaller number is a sender that started again.
    if (seq > place->second + 1) {
      recording_.channels[event.channel].num_lost += seq - place->second - 1;
    }
    place->second = seq;
  }

  void NoteInput(std::int64_t utime) { input_times_[utime] = last_; }

  bool OnMessage(const LogEvent& event, const truth_t& m) {
    CountSequence(event, m.source, m.seq);
    if (!IsFinite(m.x, m.y, m.heading) ||
        !IsFinite(m.sensor_R[0], m.sensor_R[1], m.sensor_R[2])) {
      return false;
    }
    TruthSample sample;
    sample.time = TimeFromMicroseconds(m.utime);
    sample.p_WS = {m.x, m.y};
    if (m.has_heading) sample.heading = m.heading;
    sample.p_RS = {m.sensor_R[0], m.sensor_R[1]};
    recording_.truth.push_back(sample);
    recording_.truth_source = m.source;
    return true;
  }

  // Of these only the times are looked at.
  bool OnMessage(const LogEvent&, const bot_pose_t&) { return true; }
  bool OnMessage(const LogEvent&, const planar_lidar_t&) { return true; }

  bool OnMessage(const LogEvent& event, const encoders_t& m) {
    CountSequence(event, "", m.seq);
    std::string reason;
    std::optional<EncoderReading> reading =
        EncoderReadingFromMessage(m, &reason);
    if (!reading) return false;
    NoteInput(m.utime);
    sight_.OnEncoders(m.utime, last_);
    const EncoderStep step = counter_.Add(*reading, m.counter_bits);
    // Refused: late, repeated, or a jump that no wheel can make. Counts are
    // cumulative, so that the next one makes good for it.
    if (!step.is_accepted) return true;
    right_ += std::llround(step.ticks.right);
    left_ += std::llround(step.ticks.left);
    reading->right = right_;
    reading->left = left_;
    recording_.has_virtual_ticks |= m.is_virtual != 0;
    recording_.readings.push_back(*reading);
    return true;
  }

  bool OnMessage(const LogEvent& event, const position_fix_t& m) {
    CountSequence(event, m.source, m.seq);
    std::string reason;
    const std::optional<AbsoluteFix> fix = AbsoluteFixFromMessage(m, &reason);
    if (!fix) return false;
    NoteInput(m.utime);
    recording_.fixes.push_back(*fix);
    return true;
  }

  bool OnMessage(const LogEvent& event, const corridor_pose_t& m) {
    CountSequence(event, m.source, m.seq);
    std::string reason;
    auto answer = CorridorAnswerFromMessage(m, &reason);
    if (!answer) return false;
    NoteLatency(event.channel, m.utime, image_times_);
    sight_.OnAnswer(std::string(kImagePrefix) + m.source,
                    m.utime,
                    m.has_heading != 0,
                    last_);
    recording_.corridor.push_back(std::move(*answer));
    return true;
  }

  // Of an output, whose input came at one of `times`.
  void NoteLatency(const std::string& channel,
                   std::int64_t utime,
                   const std::map<std::int64_t, Time>& times) {
    const auto input = times.find(utime);
    if (input == times.end()) return;
    // Microseconds to milliseconds.
    latencies_[channel].push_back(
        static_cast<double>((last_ - input->second).count()) * 1e-3);
  }

  bool OnMessage(const LogEvent& event, const relative_motion_t& m) {
    CountSequence(event, m.source, m.seq);
    std::string reason;
    const auto motion = RelativeMotionFromMessage(m, &reason);
    if (!motion) return false;
    NoteInput(m.utime);
    recording_.relative_motions.push_back(*motion);
    return true;
  }

  bool OnMessage(const LogEvent& event, const initial_pose_t& m) {
    CountSequence(event, m.source, m.seq);
    std::string reason;
    const std::optional<InitialPose> pose = InitialPoseFromMessage(m, &reason);
    if (!pose) return false;
    if (!recording_.initial_pose) recording_.initial_pose = pose;
    return true;
  }

  bool OnMessage(const LogEvent& event, const pose_t& m) {
    CountSequence(event, "", m.seq);
    NoteLatency(event.channel, m.utime, input_times_);
    if (event.channel == kPose) sight_.OnPose(last_);
    if (m.is_known == 0) {
      ++recording_.num_unknown_poses[event.channel];
      return true;
    }
    if (!IsFinite(m.pose_W[0], m.pose_W[1], m.pose_W[2])) return false;
    EstimatedPose pose;
    pose.time = TimeFromMicroseconds(m.utime);
    pose.X_WR = Pose2::FromVector({m.pose_W[0], m.pose_W[1], m.pose_W[2]});
    const Eigen::Matrix3d covariance =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
            m.covariance);
    if (covariance.allFinite()) pose.covariance = covariance;
    recording_.poses[event.channel].push_back(pose);
    return true;
  }

  bool OnMessage(const LogEvent& event, const odometry_parameters_t& m) {
    CountSequence(event, m.source, m.seq);
    std::string reason;
    const auto values = OdometryParametersFromMessage(m, &reason);
    if (!values) return false;
    if (!values->is_known) {
      recording_.parameters_missing[values->source] = values->reason;
      return true;
    }
    recording_.parameters_missing.erase(values->source);
    // A wheel of a robot indoors; what counts faster has jumped.
    constexpr double kMaxWheelSpeed = 5.0;  // m/s, as pose_filter's default.
    counter_.set_max_tick_rate(
        kMaxWheelSpeed /
        std::min(values->parameters.k_right, values->parameters.k_left));
    recording_.parameters[values->source].push_back({values->time,
                                                     values->parameters,
                                                     values->covariance,
                                                     values->observability});
    if (values->sensor) recording_.sensor = values->sensor;
    return true;
  }

  bool OnMessage(const LogEvent& event, const status_t& m) {
    CountSequence(event, m.process, m.seq);
    ProcessHealth& health = recording_.processes[m.process];
    ++health.num_statuses;
    health.num_received = m.num_received;
    health.num_published = m.num_published;
    health.num_lost = m.num_lost;
    health.num_dropped = m.num_dropped;
    health.num_bad = m.num_bad;
    if (m.worst_handler_us >= 0) {
      health.worst_handler_us =
          std::max(health.worst_handler_us.value_or(0), m.worst_handler_us);
    }
    if (!m.fault.empty()) NoteFault(m.process, m.fault);
    return true;
  }

  void NoteFault(const std::string& process, const std::string& text) {
    auto& faults = recording_.processes[process].faults;
    const auto [place, is_new] = fault_kinds_.try_emplace(
        {process, WithoutNumbers(text)}, faults.size());
    if (is_new) {
      faults.push_back({"", 0, first_ ? Seconds(last_ - *first_) : 0.0});
    }
    faults[place->second].text = text;
    ++faults[place->second].num;
  }

  bool OnMessage(const LogEvent& event, const config_t& m) {
    CountSequence(event, m.process, m.seq);
    recording_.configs[m.process] = m.yaml;
    recording_.version = m.version;
    return true;
  }

  LogRecording recording_;
  std::optional<Time> first_;
  Time last_;
  EncoderCounter counter_;
  std::int64_t right_ = 0;  // Since the first reading.
  std::int64_t left_ = 0;
  std::map<std::string, Cadence> cadences_;
  std::map<std::string, SomeImages> images_;
  // Key: channel, sender.
  std::map<std::pair<std::string, std::string>, std::int64_t> sequences_;
  // Key: process, fault without its numbers. Where it is in its faults.
  std::map<std::pair<std::string, std::string>, std::size_t> fault_kinds_;
  std::map<std::int64_t, Time> input_times_;  // utime to log time.
  std::map<std::int64_t, Time> image_times_;
  SightClock sight_;
  std::map<std::string, std::vector<double>> latencies_;  // ms.
};

}  // namespace

bool LogRecording::is_reference_aided() const {
  return std::any_of(fixes.begin(), fixes.end(), [](const AbsoluteFix& fix) {
    return fix.source.starts_with("reference");
  });
}

LogRecording ReadRecording(std::span<const std::string> paths) {
  Collector collector;
  LogReadReport report;
  for (const std::string& path : paths) {
    LogReader reader(path);
    while (const std::optional<LogEvent> event = reader.Next()) {
      collector.Add(*event);
    }
    report.num_events += reader.report().num_events;
    report.num_skipped_bytes += reader.report().num_skipped_bytes;
    report.num_gaps += reader.report().num_gaps;
    report.torn_end |= reader.report().torn_end;
    report.num_file_bytes += reader.report().num_file_bytes;
  }
  LogRecording recording = collector.Finish();
  recording.path = paths.empty() ? "" : paths.front();
  recording.read_report = report;
  return recording;
}

}  // namespace waymark
