// Where in a corridor the robot is, by the lines of its images.
#pragma once

#include "estimation/corridor/corridor_choice.h"
#include "estimation/corridor/corridor_tracker.h"
#include "estimation/filter/pose_history.h"
#include "processes/convert/camera_file.h"
#include "processes/convert/corridor_convert.h"
#include "processes/convert/image_convert.h"
#include "processes/corridor_tracker/corridor_tracker_config.h"
#include "processes/support/bus.h"

#include <waymark/camera_info_t.hpp>
#include <waymark/image_t.hpp>
#include <waymark/pose_t.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {

// IMAGE_<camera>, CAMERA_INFO_<camera>, POSE -> CORRIDOR_POSE, one for each
// image, also when the answer is none.
class CorridorTrackerProcess {
 public:
  using Config = CorridorTrackerConfig;
  static constexpr std::string_view kName = "corridor_tracker";
  static constexpr std::string_view kAbout =
      "Where in a corridor the robot is, by the lines of its images: "
      "IMAGE_<camera>, CAMERA_INFO_<camera>, POSE -> CORRIDOR_POSE.";

  // Throws InputError where a file cannot be used.
  CorridorTrackerProcess(const Config& config, Bus* bus);

 private:
  void OnInfo(const camera_info_t& message);
  void OnPose(const pose_t& message);
  void OnImage(const image_t& message);
  void SetCamera(const CameraDescription& camera);
  [[nodiscard]] CorridorEstimate EstimateOf(const cv::Mat1b& image,
                                            const ImageTags& tags,
                                            CorridorAnswer* answer);

  Config config_;
  Bus* bus_;
  std::string image_channel_;
  std::string info_channel_;
  std::vector<CorridorGeometry> corridors_;
  std::optional<CameraDescription> camera_;
  std::unique_ptr<CorridorTracker> tracker_;  // Of camera_, once it is used.
  PoseHistory history_;
  std::int64_t seq_ = 0;
};

}  // namespace waymark
