// Where is the robot, from wheel ticks and measurements.
#pragma once

#include "estimation/filter/delayed_fusion.h"
#include "processes/pose_filter/pose_filter_config.h"
#include "processes/support/bus.h"
#include "processes/support/state_saver.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace waymark {

// ENCODERS, POSITION_FIX, CORRIDOR_POSE, RELATIVE_MOTION, INITIAL_POSE,
// ODOMETRY_PARAMETERS (nominal, batch) -> POSE, POSE_BOT and ODOMETRY with each
// reading, POSE_SETTLED and, once per period, ODOMETRY_PARAMETERS (online)
// behind the window. The latter two depend on what was sent only, not on when
// it arrived.
class PoseFilterProcess {
 public:
  using Config = PoseFilterConfig;
  static constexpr std::string_view kName = "pose_filter";
  static constexpr std::string_view kAbout =
      "Where the robot is: ENCODERS, POSITION_FIX, CORRIDOR_POSE, "
      "RELATIVE_MOTION, INITIAL_POSE, ODOMETRY_PARAMETERS -> POSE, POSE_BOT, "
      "POSE_SETTLED, ODOMETRY, ODOMETRY_PARAMETERS.";

  // Throws InputError where the parameter file cannot be used.
  PoseFilterProcess(const Config& config, Bus* bus);
  // Settles what is held and saves the parameters.
  void Finish();

 private:
  void OnReading(const EncoderReading& raw, int counter_bits);
  void OnFix(const AbsoluteFix& fix, std::string_view channel);
  void OnMotion(const RelativeMotion& motion);
  void OnParameters(const OdometryParameters& parameters);
  void Report(std::string_view channel, Arrival arrival, Time time);
  void PublishNewest();
  void PublishUnknown(Time time, std::string reason);
  void PublishSettled();
  void PublishParameters(const Settled& settled);
  void Save();

  Config config_;
  Bus* bus_;
  DelayedFusion fusion_;
  StateSaver saver_;
  std::int64_t pose_seq_ = 0;
  std::int64_t odometry_seq_ = 0;
  std::int64_t settled_seq_ = 0;
  std::int64_t parameters_seq_ = 0;
  std::int64_t num_refused_ = 0;
  std::int64_t num_crowded_ = 0;
  std::optional<Time> parameters_time_;  // Published last.
  bool has_parameters_ = false;          // What was published last.
  std::optional<Time> save_time_;
  std::optional<OdometryParameters> learned_;  // Settled.
};

}  // namespace waymark
