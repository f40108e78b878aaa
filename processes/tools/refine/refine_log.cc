#include "processes/tools/refine/refine_log.h"

#include "estimation/base/input_error.h"
#include "estimation/filter/encoder_counter.h"
#include "processes/convert/corridor_convert.h"
#include "processes/convert/odometry_convert.h"
#include "processes/support/channels.h"
#include "processes/support/log_file.h"

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

class Collector {
 public:
  Collector(RefineLog* result, double max_wheel_speed)
      : result_(result), max_wheel_speed_(max_wheel_speed) {}

  void Add(const LogEvent& event) {
    if (event.channel == kEncoders) {
      AddEncoders(event);
    } else if (event.channel == kPositionFix) {
      const auto message = DecodeAs<position_fix_t>(event);
      const auto fix =
          message ? AbsoluteFixFromMessage(*message, &reason_) : std::nullopt;
      if (fix) result_->log.fixes.push_back(*fix);
      Count(fix.has_value());
    } else if (event.channel == kCorridorPose) {
      const auto message = DecodeAs<corridor_pose_t>(event);
      const auto fix =
          message ? CorridorFixFromMessage(*message, &reason_) : std::nullopt;
      if (fix && fix->has_any()) result_->log.fixes.push_back(*fix);
      Count(fix.has_value());
    } else if (event.channel == kRelativeMotion) {
      const auto message = DecodeAs<relative_motion_t>(event);
      const auto motion = message
                              ? RelativeMotionFromMessage(*message, &reason_)
                              : std::nullopt;
      if (motion) result_->log.motions.push_back(*motion);
      Count(motion.has_value());
    } else if (event.channel == kInitialPose) {
      const auto message = DecodeAs<initial_pose_t>(event);
      const auto pose =
          message ? InitialPoseFromMessage(*message, &reason_) : std::nullopt;
      if (pose) {
        result_->log.start =
            StartPose{pose->time, pose->X_WR, pose->covariance};
      }
      Count(pose.has_value());
    } else if (event.channel == kOdometryParameters) {
      AddParameters(event);
    }
  }

 private:
  void Count(bool is_good) { result_->num_bad += is_good ? 0 : 1; }

  void AddEncoders(const LogEvent& event) {
    const auto message = DecodeAs<encoders_t>(event);
    const auto raw =
        message ? EncoderReadingFromMessage(*message, &reason_) : std::nullopt;
    if (!raw) {
      Count(false);
      return;
    }
    const EncoderStep step = counter_.Add(*raw, message->counter_bits);
    if (!step.is_accepted) {
      Count(false);
      return;
    }
    if (step.unknown_s > 0.0 && !result_->log.encoders.empty()) {
      throw InputError(result_->path + ": event " +
                       std::to_string(event.number) +
                       ": the encoder count was lost here; cut the log before "
                       "or after it (waymark-log cut)");
    }
    total_.time = raw->time;
    total_.seq = raw->seq;
    total_.right += std::llround(step.ticks.right);
    total_.left += std::llround(step.ticks.left);
    result_->log.encoders.push_back(total_);
  }

  void AddParameters(const LogEvent& event) {
    const auto message = DecodeAs<odometry_parameters_t>(event);
    if (message && message->source != "nominal") return;
    const auto values = message
                            ? OdometryParametersFromMessage(*message, &reason_)
                            : std::nullopt;
    Count(values.has_value());
    if (!values || !values->is_known) return;
    result_->nominal = values->parameters;
    counter_.set_max_tick_rate(
        max_wheel_speed_ /
        std::min(values->parameters.k_right, values->parameters.k_left));
  }

  RefineLog* result_;
  double max_wheel_speed_;
  EncoderCounter counter_;
  EncoderReading total_;
  std::string reason_;
};

}  // namespace

RefineLog ReadRefineLog(const std::string& path, double max_wheel_speed) {
  RefineLog result;
  result.path = path;
  LogReader reader(path);
  Collector collector(&result, max_wheel_speed);
  while (const auto event = reader.Next()) collector.Add(*event);
  if (result.log.encoders.empty()) {
    throw InputError(path + ": no usable message on ENCODERS");
  }
  return result;
}

}  // namespace waymark
