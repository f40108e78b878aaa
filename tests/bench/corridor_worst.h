// The worst answers of a benchmark's frames, to look at.
#pragma once

#include "estimation/corridor/corridor_types.h"
#include "processes/convert/camera_file.h"
#include "tests/bench/corridor_pose_frames.h"

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace waymark {

// Keeps those of the accepted answers that are farthest from the truth, in
// parts of 3 cm or 0.5 degrees, whichever is worse.
class WorstFrames {
 public:
  explicit WorstFrames(std::size_t num_kept) : num_kept_(num_kept) {}

  // `name`: of the world, and which frame.
  void Add(const std::string& name,
           const CorridorPoseFrame& frame,
           const CorridorEstimate& found,
           const CorridorGeometry& corridor,
           const CameraDescription& camera);

  // One page with the pictures, lines as they were used drawn in, and of each
  // edge how far beside it what was taken for it lies. Folders are made. Throws
  // std::runtime_error where it cannot be written.
  void Write(const std::string& path) const;

 private:
  struct Kept {
    double badness = 0.0;
    std::string caption;
    cv::Mat3b picture;
  };

  std::size_t num_kept_;
  std::vector<Kept> kept_;  // The worst first.
};

}  // namespace waymark
