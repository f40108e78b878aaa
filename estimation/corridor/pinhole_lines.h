// Lines of a camera's images, whatever its lens, in a pinhole view.
#pragma once

#include "estimation/camera/image_remap.h"
#include "estimation/lines/line_extractor.h"

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <optional>

namespace waymark {

// Throws std::invalid_argument where the camera does not see straight ahead, as
// lenses do and panoramas do not.
void CheckSeesAhead(const CameraModel& camera);

// Straight edges are straight in a pinhole's image alone: that of any other
// lens is first brought to a view which looks the same way, and sees 50 degrees
// to each side at most. Keeps its buffers.
class PinholeLines {
 public:
  // Throws std::invalid_argument as options.Check() and CheckSeesAhead() do.
  PinholeLines(const CameraView& camera, const LineExtractorOptions& options);

  // `image`: of the camera's size. Pixels of the result are those of view().
  // Lines along the border of what the lens sees are none.
  [[nodiscard]] LineSet Find(const cv::Mat1b& image);
  // Of a pixel of view(); nullopt where the camera does not see it.
  [[nodiscard]] std::optional<Eigen::Vector2d> CameraPixel(
      const Eigen::Vector2d& pixel) const;

  [[nodiscard]] const CameraView& view() const { return view_; }
  [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }

 private:
  CameraView camera_;
  Intrinsics intrinsics_;
  CameraView view_;
  std::optional<ImageRemap> remap_;  // Absent: the camera is a pinhole.
  cv::Mat1b rim_;  // Of what the lens sees of the view; empty: it sees all.
  LineExtractor extractor_;
};

}  // namespace waymark
