// What the lines of an image were taken for, drawn into it.
#pragma once

#include "estimation/camera/camera_model.h"
#include "estimation/corridor/corridor_types.h"

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <optional>

namespace waymark {

// Through what a corridor was seen.
struct CorridorScene {
  CameraModel camera = PerspectiveCamera(Intrinsics{});
  Eigen::Isometry3d X_RC = Eigen::Isometry3d::Identity();
  std::optional<CorridorGeometry> corridor;  // Absent: not known.
};

enum class LineUse : std::uint8_t {
  kAlong,   // Along the corridor, by the estimate itself.
  kAcross,  // Horizontal, at a right angle to it.
  kVertical,
  kOther,
};
inline constexpr int kNumLineUses = 4;
// Their colours, and that of where the corridor's edges should be: red, green
// and blue.
using PictureColor = std::array<std::uint8_t, 3>;
[[nodiscard]] PictureColor ColorOf(LineUse use);
inline constexpr PictureColor kPredictedColor{255, 214, 10};
inline constexpr PictureColor kVanishingColor{216, 27, 96};

// What is not along the corridor is across it or vertical where the plane of
// its sight holds that direction within 1 degree; across it only where the
// heading is known.
[[nodiscard]] LineUse UseOf(const CorridorLine& line,
                            const CorridorScene& scene,
                            const std::optional<double>& heading);

// The image in colour and somewhat darker, on it the lines by their use, those
// that support the position thick; where the horizon is, where the axis
// vanishes (beside the image: a wedge at its border), and, where position and
// corridor are known, a broad pale stroke where each of its edges should be.
// What is straight in the world bends as the lens does.
//
//   image      8 bits, one channel or three (BGR), not empty.
//   estimate   Pixels are those of the image.
[[nodiscard]] cv::Mat3b DrawCorridor(const cv::Mat& image,
                                     const CorridorEstimate& estimate,
                                     const CorridorScene& scene);

}  // namespace waymark
