// Stands in for camera, wheels and people.
#pragma once

#include "drivers/simulator/obstacle_map.h"
#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/simulation.h"
#include "processes/simulator/camera_rig.h"
#include "processes/simulator/simulator_config.h"
#include "processes/support/bus.h"

#include <waymark/image_t.hpp>
#include <waymark/pan_tilt_t.hpp>
#include <waymark/velocity_t.hpp>

#include <cstdint>
#include <deque>
#include <future>
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
class SimulatorProcess {
 public:
  using Config = SimulatorConfig;
  static constexpr std::string_view kName = "simulator";
  static constexpr bool kIsLiveOnly = true;

  // Throws InputError for a world, camera or state file that cannot be used,
  // and where the robot would start inside something.
  SimulatorProcess(const Config& config, Bus* bus);
  // Saves where the robot is.
  void Finish();

 private:
  // An image on its way.
  struct Pending {
    Time arrival;  // Of the image, in simulated time.
    std::future<CameraRig::Shot> shot;
  };
  struct Camera {
    std::unique_ptr<CameraRig> rig;
    std::deque<Pending> pending;
    std::int64_t num_missed = 0;  // Exposures while the last was being drawn.
  };

  [[nodiscard]] Simulation MakeSimulation(Time start) const;
  [[nodiscard]] Pose2 StartPose() const;
  void AddCamera(const SimulatedCameraConfig& config);
  void OnTick(Time now);
  void OnStepTick(Time now);
  void Step(Time now);
  void OnCommand(const velocity_t& message, Time t);
  void OnHead(const pan_tilt_t& message);
  void AdvanceTo(Time simulated);
  void Publish(const std::vector<SimulationEvent>& events);
  void Publish(const EncoderEvent& event);
  void Publish(const RangeEvent& event);
  void Publish(const BaseEvent& event);
  void Publish(const TruthEvent& event);
  void Expose(const CameraEvent& event);
  void PublishImages(Time simulated);
  void PublishCameraInfo(Time simulated);
  void SaveState();

  Config config_;
  Bus* bus_;
  World world_;
  Scene scene_;
  ObstacleMap map_;
  People people_;
  std::optional<RangeSensorOptions> range_options_;
  RobotSnapshot start_;
  std::unique_ptr<Renderer> renderer_;  // Where there is a camera.
  std::vector<Camera> cameras_;
  Duration period_;  // Of ENCODERS.

  std::optional<Simulation> simulation_;  // From the first tick on.
  Time first_tick_;                       // On the bus's clock.
  // Stepped: the ENCODERS that waits for its answer, and since when.
  std::optional<Time> unanswered_;
  Time asked_at_;
  std::int64_t num_unanswered_ = 0;

  std::int64_t encoders_seq_ = 0;
  std::int64_t base_seq_ = 0;
  std::int64_t truth_seq_ = 0;
  std::optional<Time> info_time_;
  std::optional<Time> save_time_;
  std::int64_t info_seq_ = 0;
};

}  // namespace waymark
