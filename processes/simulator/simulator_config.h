// Configuration of the simulator.
#pragma once

#include "drivers/simulator/camera_timing.h"
#include "drivers/simulator/image_sensor.h"
#include "drivers/simulator/pan_tilt_head.h"
#include "drivers/simulator/range_sensor.h"
#include "drivers/simulator/robot.h"
#include "processes/support/describer.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

enum class Pace : std::uint8_t { kRealTime, kStepped };
enum class RangeKind : std::uint8_t { kNone, kSonar, kLidar };
enum class CameraQuality : std::uint8_t { kLive, kStill };

struct SimulatedCameraConfig {
  std::string name;  // As in IMAGE_<name>, of A-Z, 0-9, _; empty: no camera.
  std::string file;  // Calibration, or one that comes with Waymark.
  CameraTimingOptions timing;
  CameraQuality quality = CameraQuality::kLive;
  bool is_raw = false;
  bool is_gray = false;
  std::int64_t max_bytes = 60000;
  bool has_head = false;
  PanTiltHeadOptions head;
  ImageSensorOptions sensor;
  std::int64_t blur_samples = 1;
  std::vector<double> covered_way;  // From, to, m; empty: never.

  SimulatedCameraConfig();
  void Describe(Describer& d);

 private:
  void DescribeHead(Describer& d);
  void DescribeSensor(Describer& d);
};

struct SimulatorConfig {
  std::string world = "corridor_office";
  std::vector<double> start;  // x m, y m, heading deg; empty: the world's own.
  std::int64_t seed = 1;
  Pace pace = Pace::kRealTime;
  double speed = 1.0;
  double answer_timeout_s = 1.0;
  double encoder_rate_hz = 50.0;
  double status_rate_hz = 10.0;
  std::string state_file;
  std::int64_t num_threads = 2;
  double light_cell = 0.4;
  RobotOptions robot;
  RangeKind ranges = RangeKind::kSonar;
  double range_rate_hz = 10.0;
  double range_noise = 0.01;
  double range_height = 0.0;  // m; 0: all heights of the robot.
  SimulatedCameraConfig camera;
  SimulatedCameraConfig second_camera;

  SimulatorConfig();
  void Describe(Describer& d);
  // Throws std::invalid_argument naming the key.
  void Check() const;
  // Throws InputError where the world's or a camera's file cannot be used.
  void CheckFiles() const;

 private:
  void DescribeTime(Describer& d);
  void DescribeRobot(Describer& d);
  void DescribeNoise(Describer& d);
  void DescribeRanges(Describer& d);
};

}  // namespace waymark
