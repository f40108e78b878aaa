// Whether a world can be used: things on floors, free starts and ways, images
// that are well exposed.
#pragma once

#include "drivers/simulator/scene.h"
#include "drivers/simulator/world.h"
#include "processes/convert/camera_file.h"

#include <opencv2/core/mat.hpp>

#include <span>
#include <string>
#include <vector>

namespace waymark {

// How bright an image is, over the pixels that the camera has rays for.
struct Exposure {
  double mean = 0.0;  // Grey value.
  // Pixels whose grey value is 255, or 0: a pure colour is neither.
  double burnt_share = 0.0;
  double black_share = 0.0;

  static constexpr double kMaxClippedShare = 0.02;
  static constexpr double kMinMean = 50.0;
  static constexpr double kMaxMean = 200.0;
  [[nodiscard]] bool IsGood() const;
};
// `seen`: CV_8U of the image's size, 0 where it does not count; empty: all do.
[[nodiscard]] Exposure ExposureOf(const cv::Mat3b& image,
                                  const cv::Mat1b& seen);

// Mean absolute change of the grey value, over the pixels that count.
[[nodiscard]] double GreyChange(const cv::Mat3b& first,
                                const cv::Mat3b& second,
                                const cv::Mat1b& seen);

struct NamedCamera {
  std::string name;
  CameraDescription camera;
};

struct ViewCheck {
  std::string name;  // "start 0, 90 deg, perspective".
  Exposure exposure;
  // GreyChange() of the view when the robot moves a millimetre: what changes
  // more flickers under way.
  double change = 0.0;

  static constexpr double kMaxChange = 1.5;
  [[nodiscard]] bool IsGood() const;
};

struct WorldCheckOptions {
  double robot_radius = 0.25;  // m; starts must be this clear of everything
  double robot_height = 1.1;   // up to here.
  int num_headings = 4;        // At each start and place.
  int num_threads = 1;
  // Of the light map, m: coarse, since only how bright a view is counts.
  double light_cell_size = 1.0;
};

// What stands, walks or is to be driven where that cannot be, a line each with
// file, object, and what is in its way: furniture outside of all rooms or in a
// wall, people and their paths outside or in something, starts, places and
// routes where a robot would be outside or touch something. Empty where all is
// well.
[[nodiscard]] std::vector<std::string> CheckObjects(
    const World& world, const Scene& scene, const WorldCheckOptions& options);

// Views from all starts and places of a world, one result each, in order; those
// where no robot can be, which CheckObjects() names, are left out.
// Throws InputError where the world has neither.
[[nodiscard]] std::vector<ViewCheck> CheckViews(
    const World& world,
    const Scene& scene,
    std::span<const NamedCamera> cameras,
    const WorldCheckOptions& options);

}  // namespace waymark
