#include "processes/simulator/simulator_config.h"

#include "processes/convert/camera_file.h"
#include "processes/convert/world_file.h"
#include "processes/support/channels.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace waymark {
namespace {

// Slower clocks starve the filters, faster ones the machine.
constexpr Range kSensorRate{0.5, 200.0};
constexpr Range kShare{0.0, 1.0};
constexpr Range kSpeed{1e-3, 10.0};
constexpr double kFarthest = 1e6;  // m; beyond all worlds.

}  // namespace

// A small camera of a small robot.
SimulatedCameraConfig::SimulatedCameraConfig() {
  sensor.vignetting = 0.2;
  sensor.auto_exposure_s = 2.0;
  sensor.full_well_electrons = 10000.0;
  sensor.read_noise = 0.003;
}

void SimulatedCameraConfig::Describe(Describer& d) {
  d.Text("name",
         &name,
         "As in IMAGE_<name>: A-Z, 0-9 and _; empty: no such camera");
  d.Text("file",
         &file,
         "Calibration file, or one that comes with Waymark: perspective, "
         "fisheye, mirror, panorama");
  d.Number("rate_hz", &timing.rate_hz, {0.1, 60.0}, "Exposures a second");
  d.Number(
      "exposure_s", &timing.exposure_s, {1e-5, 0.1}, "Length of an exposure");
  d.Number("latency_s",
           &timing.latency_s,
           {0.0, 2.0},
           "From the end of the exposure to the image's arrival");
  d.Number("jitter_s",
           &timing.jitter_s,
           {0.0, 2.0},
           "Up to so much more latency, at random");
  d.Number("drop_share",
           &timing.drop_share,
           {0.0, 0.99},
           "Share of images that never arrive");
  d.Choice<CameraQuality>(
      "quality",
      &quality,
      {{"live", CameraQuality::kLive}, {"still", CameraQuality::kStill}},
      "Smooth edges only where they are, or 16 samples everywhere");
  d.Flag("raw", &is_raw, "Pixels as they are rather than JPEG");
  d.Flag("gray", &is_gray, "Gray rather than colour");
  d.Integer("max_bytes",
            &max_bytes,
            2000,
            10'000'000,
            "Of one JPEG; its quality follows");
  d.Numbers("covered_way_m",
            &covered_way,
            2,
            "From the first to the second, of the way driven, the lens is "
            "covered: images are black; empty: never");
  d.Group(
      "head", [&] { DescribeHead(d); }, "The camera's head");
  d.Group(
      "sensor",
      [&] { DescribeSensor(d); },
      "What the sensor makes of the light");
}

void SimulatedCameraConfig::DescribeHead(Describer& d) {
  d.Flag("present",
         &has_head,
         "On a pan-tilt head even where the calibration knows of none");
  d.Number("max_rate", &head.max_rate, {0.01, 20.0}, "rad/s");
  d.Degrees("max_pan_deg", &head.max_pan, {0.0, 180.0}, "To both sides");
  d.Degrees("max_tilt_deg", &head.max_tilt, {0.0, 90.0}, "Both ways");
}

void SimulatedCameraConfig::DescribeSensor(Describer& d) {
  d.Number("vignetting",
           &sensor.vignetting,
           {0.0, 0.99},
           "Share of the light that the image's corners lack");
  d.Number("gain", &sensor.gain, {0.1, 10.0}, "Of the first image");
  d.Number("auto_exposure_s",
           &sensor.auto_exposure_s,
           {0.0, 600.0},
           "Time in which the gain follows the light; 0: it is fixed");
  d.Number("full_well_electrons",
           &sensor.full_well_electrons,
           {0.0, 1e7},
           "Of a white pixel: photon noise; 0: none");
  d.Number("read_noise",
           &sensor.read_noise,
           {0.0, 0.5},
           "Standard deviation in the dark, of the full sensor");
  d.Integer("blur_samples",
            &blur_samples,
            1,
            64,
            "Images that are averaged over one exposure, each as costly "
            "as one; 1: no motion blur");
}

SimulatorConfig::SimulatorConfig() {
  camera.name = "FRONT";
  camera.file = "perspective";
  second_camera.file = "mirror";
}

void SimulatorConfig::Describe(Describer& d) {
  d.Text("world",
         &world,
         "World file, or one that comes with Waymark, or random:SEED");
  d.Numbers("start",
            &start,
            3,
            "x m, y m and heading deg of the robot; empty: the world's own");
  d.Integer("seed", &seed, 0, 1'000'000'000, "Of everything that is random");
  d.Integer("num_threads",
            &num_threads,
            1,
            64,
            "Of one image; it does not depend on them");
  d.Number("light_cell_m",
           &light_cell,
           {0.05, 5.0},
           "Of the light, computed at the start: finer takes longer");
  d.Text("state_file",
         &state_file,
         "Where the robot is is saved to this file once a second, and a "
         "restarted simulator goes on from it; empty: neither");
  d.Group(
      "time", [&] { DescribeTime(d); }, "How time passes");
  d.Group(
      "robot", [&] { DescribeRobot(d); }, "The base");
  d.Group(
      "noise",
      [&] { DescribeNoise(d); },
      "How it differs from its nominal self");
  d.Group(
      "ranges", [&] { DescribeRanges(d); }, "Sonar ring or lidar");
  d.Group(
      "camera", [&] { camera.Describe(d); }, "The camera");
  d.Group(
      "second_camera", [&] { second_camera.Describe(d); }, "Another one");
}

void SimulatorConfig::DescribeTime(Describer& d) {
  d.Choice<Pace>("pace",
                 &pace,
                 {{"real_time", Pace::kRealTime}, {"stepped", Pace::kStepped}},
                 "With the clock, or as fast as MOTION_COMMAND answers each "
                 "ENCODERS");
  d.Number("speed", &speed, {0.05, 20.0}, "Times real time (pace: real_time)");
  d.Number("answer_timeout_s",
           &answer_timeout_s,
           {0.05, 3600.0},
           "Without an answer time goes on after this (pace: stepped)");
}

void SimulatorConfig::DescribeRobot(Describer& d) {
  d.Number("radius", &robot.radius, {0.02, 2.0}, "Of the round body, m");
  d.Number("height",
           &robot.height,
           {0.04, 3.0},
           "Of all of it, cameras too, m: what is lower stands in its way");
  d.Number("meters_per_tick",
           &robot.meters_per_tick,
           {1e-7, 0.1},
           "Nominal travel of a wheel, m");
  d.Number("wheel_base", &robot.wheel_base, {0.02, 4.0}, "Nominal, m");
  d.Number("max_wheel_speed", &robot.max_wheel_speed, kSpeed, "m/s");
  d.Number("max_wheel_acceleration",
           &robot.max_wheel_acceleration,
           {0.01, 100.0},
           "Also when braking, m/s^2");
  d.Number("command_timeout_s",
           &robot.command_timeout_s,
           {0.02, 10.0},
           "After the last MOTION_COMMAND the robot stops");
  d.Flag("holds_at_bumper",
         &robot.holds_at_bumper,
         "Once bumped it goes no further forward until that is released and "
         "not asked for, as wheels does; else it pushes");
  d.Number("encoder_rate_hz", &encoder_rate_hz, kSensorRate, "ENCODERS, TRUTH");
  d.Number("status_rate_hz", &status_rate_hz, kSensorRate, "BASE");
}

void SimulatorConfig::DescribeNoise(Describer& d) {
  constexpr Range kFactor{0.5, 2.0};
  d.Number("right_wheel_factor",
           &robot.right_wheel_factor,
           kFactor,
           "True over nominal travel of the right wheel");
  d.Number("left_wheel_factor",
           &robot.left_wheel_factor,
           kFactor,
           "and of the left one");
  d.Number("wheel_base_factor",
           &robot.wheel_base_factor,
           kFactor,
           "True over nominal wheel base");
  d.Number("wheel_variance",
           &robot.wheel_variance,
           {0.0, 1.0},
           "Variance of a wheel's travel per metre, m^2/m");
  d.Number("base_variance",
           &robot.base_variance,
           {0.0, 1.0},
           "Variance of the wheel base of a step times its travel, m^3");
  d.Number("slip_every",
           &robot.slip_every,
           {0.0, 1e6},
           "Mean way between two slips of a wheel, m; 0: none");
  d.Number("slip_length", &robot.slip_length, {1e-3, 10.0}, "Of one, m");
  d.Number(
      "slip_share", &robot.slip_share, kShare, "Of the travel that is lost");
  d.Choice<BlockedWheels>(
      "blocked_wheels",
      &robot.blocked_wheels,
      {{"stall", BlockedWheels::kStall}, {"spin", BlockedWheels::kSpin}},
      "What wheels do that push against an obstacle");
}

void SimulatorConfig::DescribeRanges(Describer& d) {
  d.Choice<RangeKind>("kind",
                      &ranges,
                      {{"none", RangeKind::kNone},
                       {"sonar", RangeKind::kSonar},
                       {"lidar", RangeKind::kLidar}},
                      "16 sonar beams or 360 lidar rays, all around, on "
                      "RANGES");
  d.Number("rate_hz", &range_rate_hz, kSensorRate, "Readings a second");
  d.Number("sigma", &range_noise, {0.0, 1.0}, "Standard deviation, m");
  d.Number("height",
           &range_height,
           {0.0, 3.0},
           "Of the plane that is seen, m; 0: nearest of all that stands as "
           "high as the robot or lower, as in the scan of a depth camera");
}

void SimulatorConfig::Check() const {
  if (!camera.name.empty() && camera.name == second_camera.name) {
    throw std::invalid_argument("second_camera.name = " + camera.name +
                                ": is the first one's");
  }
  for (const double value : start) {
    if (std::abs(value) > kFarthest) {
      throw std::invalid_argument("start: its numbers must be within +-1e6");
    }
  }
  for (const auto& [key, one] : {std::pair("camera", &camera),
                                 std::pair("second_camera", &second_camera)}) {
    if (!one->name.empty() && !IsCameraName(one->name)) {
      throw std::invalid_argument(std::string(key) + ".name = " + one->name +
                                  " must consist of A-Z, 0-9 and _");
    }
    if (one->timing.exposure_s * one->timing.rate_hz > 1.0) {
      throw std::invalid_argument(
          "exposure_s of a camera must be at most 1 / rate_hz");
    }
    if (!one->covered_way.empty() &&
        !(one->covered_way[0] <= one->covered_way[1])) {
      throw std::invalid_argument(std::string(key) +
                                  ".covered_way_m: its end must not be before "
                                  "its beginning");
    }
    one->timing.Check();
    one->head.Check();
    one->sensor.Check();
  }
  robot.Check();
}

void SimulatorConfig::CheckFiles() const {
  (void)LoadWorldFile(FindWorldFile(world));
  for (const SimulatedCameraConfig* one : {&camera, &second_camera}) {
    if (!one->name.empty()) (void)LoadCameraFile(FindCameraFile(one->file));
  }
}

}  // namespace waymark
