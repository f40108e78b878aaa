// A simulated camera: from where it looks to the message with its image.
#pragma once

#include "drivers/simulator/camera_rays.h"
#include "drivers/simulator/image_sensor.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/simulation.h"
#include "estimation/camera/pan_tilt_mount.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/image_convert.h"
#include "processes/simulator/simulator_config.h"

#include <waymark/camera_info_t.hpp>
#include <waymark/image_t.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

class CameraRig {
 public:
  // `renderer` outlives this. Throws InputError for a calibration file that
  // cannot be used.
  CameraRig(const SimulatedCameraConfig& config,
            const Renderer* renderer,
            std::uint64_t seed);

  struct Shot {
    std::optional<image_t> image;
    std::string reason;  // Why there is none.
  };
  // Draws, exposes, encodes. One call at a time, in the order of the frames:
  // gain and JPEG quality follow from those before.
  [[nodiscard]] Shot Expose(const CameraEvent& event);

  [[nodiscard]] camera_info_t Info(Time time, std::int64_t seq) const;
  // What the simulation has to know of it.
  [[nodiscard]] SimulatedCamera timing() const;

  [[nodiscard]] const std::string& image_channel() const {
    return image_channel_;
  }
  [[nodiscard]] const std::string& info_channel() const {
    return info_channel_;
  }

 private:
  [[nodiscard]] Eigen::Isometry3d CameraPose(const ExposurePose& pose) const;
  // Linear, averaged over the exposure.
  [[nodiscard]] cv::Mat3f LightOf(const CameraEvent& event) const;
  [[nodiscard]] bool IsCovered(const CameraEvent& event) const;
  // Through lens and sensor, 8 bits.
  [[nodiscard]] cv::Mat ImageOf(const CameraEvent& event);

  SimulatedCameraConfig config_;
  const Renderer* renderer_;
  CameraDescription camera_;
  PanTiltMount mount_;
  CameraRays rays_;
  ImageSensor sensor_;
  ImageEncoder encoder_;
  std::optional<Time> last_;  // Exposure.
  std::string image_channel_;
  std::string info_channel_;
};

}  // namespace waymark
