// Stands in for camera, wheels and people.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/simulation.h"
#include "drivers/simulator/walk_area.h"
#include "processes/simulator/camera_feed.h"
#include "processes/simulator/robot_state_file.h"
#include "processes/simulator/simulated_clock.h"
#include "processes/simulator/simulator_config.h"
#include "processes/support/bus.h"
#include "processes/support/state_saver.h"

#include <waymark/pan_tilt_t.hpp>
#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// MOTION_COMMAND, PAN_TILT_COMMAND -> ENCODERS, RANGES, BASE, IMAGE_<camera>,
// CAMERA_INFO_<camera> as a robot's drivers send them, and TRUTH.
//
// Paced by the bus's clock (live: real time or a multiple; on LocalBus
// lock-step), or stepped: each ENCODERS waits for the MOTION_COMMAND that
// answers it, which carries its utime and a source. Both give the same
// trajectory for the same seed, since nothing else depends on the clock.
//
// Stepped, a command with any other utime is obeyed from the next step on, but
// no time passes for it. So teleop, which goes by a clock of its own, steers
// only what another process steps; alone it gets one step per answer_timeout_s,
// and STATUS says so.
//
// Time does not go back when it is restarted with a state file, not even where
// that is ahead of the clock; STATUS says so then. The robot goes on where it
// was, if it can be there: people begin anew, and it may have left the floor.
// Else it begins at the start again, and the log says so. What is missed while
// the machine stands still is made up for by a tenth of a second of the clock
// at most, or two ticks where these are longer; the rest is lost, and STATUS
// says so.
class SimulatorProcess {
 public:
  using Config = SimulatorConfig;
  static constexpr std::string_view kName = "simulator";
  static constexpr std::string_view kAbout =
      "A robot in a simulated world, as its own drivers would send it: "
      "MOTION_COMMAND, PAN_TILT_COMMAND -> ENCODERS, RANGES, BASE, TRUTH, "
      "IMAGE_<camera>, CAMERA_INFO_<camera>.";
  static constexpr bool kIsLiveOnly = true;

  // Throws InputError for a world, camera or state file that cannot be read,
  // and where FaultOfStart() finds a fault with the start of the configuration
  // or the world.
  SimulatorProcess(const Config& config, Bus* bus);
  // Saves where the robot is; says how many images there were.
  void Finish();

 private:
  [[nodiscard]] Simulation MakeSimulation(Time start) const;
  [[nodiscard]] Pose2 StartPose() const;
  [[nodiscard]] std::string FaultOf(const Pose2& X_WR) const;
  void LoadState();
  [[nodiscard]] bool IsLive() const;
  [[nodiscard]] Time StartTime(Time now) const;
  void AddCamera(const SimulatedCameraConfig& config);
  void OnTick(Time now);
  void OnStepTick(Time now);
  void OnImageTick(Time now);
  void Step(Time now);
  void OnCommand(const velocity_t& message, Time t);
  void OnHead(const pan_tilt_t& message);
  void AdvanceTo(Time simulated);
  void Publish(std::vector<SimulationEvent> events);
  void Publish(const EncoderEvent& event);
  void Publish(const RangeEvent& event);
  void Publish(const BaseEvent& event);
  void Publish(const TruthEvent& event);
  void Publish(const CameraEvent& event);
  void PublishCameraInfo(Time simulated);
  // `lead`: what may be sent before the state is on disk.
  void SaveState(Duration lead);
  [[nodiscard]] Duration SaveLead() const;
  void ShowFault(Time now);

  Config config_;
  Bus* bus_;
  World world_;
  Scene scene_;
  WalkArea area_;
  std::optional<ObstacleMap> seen_;  // By ranges, where that is not all.
  People people_;
  std::optional<RangeSensorOptions> range_options_;
  RobotSnapshot start_;
  std::unique_ptr<Renderer> renderer_;  // Where there is a camera.
  std::vector<CameraFeed> cameras_;
  StateSaver saver_;
  std::optional<Time> saved_time_;  // No message before a restart is newer.

  std::optional<Simulation> simulation_;  // From the first tick on.
  std::optional<SimulatedClock> clock_;   // Likewise; with the bus's clock.
  std::optional<Time> lost_time_;  // When time was lost last, on that clock.
  Time ticked_at_;                 // The last tick of the wheels, on it too.
  // Stepped: the ENCODERS that waits for its answer, and since when.
  std::optional<Time> unanswered_;
  Time asked_at_;
  std::int64_t num_unanswered_ = 0;
  bool is_unanswered_ = false;  // The last one.

  std::int64_t encoders_seq_ = 0;
  std::int64_t base_seq_ = 0;
  std::int64_t truth_seq_ = 0;
  std::optional<Time> info_time_;
  std::optional<Time> save_time_;
  std::int64_t info_seq_ = 0;
};

}  // namespace waymark
