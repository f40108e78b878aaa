// Rendered frames of robots in corridors, with the truth, and how well answers
// match it.
#pragma once

#include "drivers/simulator/people.h"
#include "drivers/simulator/renderer.h"
#include "drivers/simulator/world.h"
#include "estimation/base/random.h"
#include "estimation/camera/image_remap.h"
#include "estimation/corridor/corridor_types.h"
#include "estimation/geometry/angle.h"
#include "processes/convert/camera_file.h"
#include "tests/bench/bench_report.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// With the least share of frames that is to be accepted, %.
struct CorridorWorld {
  const char* name;
  double least_accepted;
};
inline constexpr std::array kCorridorWorlds = {
    CorridorWorld{"corridor_plain", 90.0},
    CorridorWorld{"corridor_textured", 75.0},
    CorridorWorld{"corridor_office", 75.0},
    CorridorWorld{"corridor_mouth", 75.0},
    CorridorWorld{"t_corridors", 75.0}};

// 1 sigma of what is believed before; the truth is drawn from it.
struct PriorErrors {
  double x = 0.15;  // m.
  double y = 0.15;  // m.
  double heading = RadiansFromDegrees(5.0);
};
[[nodiscard]] CorridorPrior DrawPrior(const Pose2& X_LR,
                                      const PriorErrors& errors,
                                      Random* random);

struct CorridorPoseFrame {
  cv::Mat1b image;
  Pose2 X_LR;                 // True.
  CorridorGeometry corridor;  // L; of several in a world each in turn.
  CorridorPrior prior;
};

// One after the other, of one world: poses uniform over the corridor, turned by
// up to 25 degrees (or max_heading) from either direction, as far from ends,
// walls, furniture and people as a robot stands; 640 x 480, f 457 px.
// Deterministic.
class CorridorPoseFrames {
 public:
  CorridorPoseFrames(const std::string& world,
                     std::uint64_t seed,
                     double max_heading = RadiansFromDegrees(25.0));

  [[nodiscard]] CorridorPoseFrame Next();

  [[nodiscard]] const CameraDescription& camera() const { return camera_; }

 private:
  [[nodiscard]] Pose2 DrawPose(const CorridorGeometry& corridor);

  World world_;
  double max_heading_;
  std::vector<CorridorGeometry> corridors_;
  std::size_t next_ = 0;  // Of corridors_.
  CameraDescription camera_;
  Renderer renderer_;
  People people_;
  CameraRays rays_;
  Random random_;
};

// What came of frames.
struct PoseScore {
  int num_frames = 0;
  std::vector<double> y_errors;        // Of accepted frames, m.
  std::vector<double> heading_errors;  // rad.
  std::vector<double> worst_sigmas;    // Larger of both.
  // Squared error of (y, heading) by the stated covariance: of two normal
  // errors as stated, 2 in the mean and 1.39 in the median.
  std::vector<double> nees;
  std::vector<double> times_ms;  // Of all frames.

  void Add(const CorridorEstimate& found, const Pose2& X_LR, double time_ms);
  [[nodiscard]] double AcceptedPercent() const;
  // Of accepted frames.
  [[nodiscard]] double PercentBeyond(double sigmas) const;
};

}  // namespace waymark
