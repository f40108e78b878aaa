#include "estimation/corridor/pinhole_lines.h"

#include "estimation/geometry/angle.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

namespace waymark {
namespace {

// The pinhole view of a lens that sees more than one can: so far to each side.
const double kHalfView = RadiansFromDegrees(50.0);

Intrinsics PinholeOf(const CameraView& camera) {
  if (const auto* lens = std::get_if<PerspectiveCamera>(&camera.model)) {
    return lens->intrinsics();
  }
  CheckSeesAhead(camera.model);
  const double f = 0.5 * camera.size.width / std::tan(kHalfView);
  return {f, f, 0.5 * (camera.size.width - 1), 0.5 * (camera.size.height - 1)};
}

bool IsPinhole(const CameraView& camera) {
  const auto* lens = std::get_if<PerspectiveCamera>(&camera.model);
  return lens != nullptr && lens->distortion() == LensDistortion{};
}

// 255 in and beside what the lens does not see: the border there is as sharp as
// any edge. Empty where it sees all.
cv::Mat1b RimOf(const cv::Mat1b& seen) {
  if (cv::countNonZero(seen) == static_cast<int>(seen.total())) return {};
  constexpr int kBesidePx = 3;  // Beyond smoothing and the fit to crests.
  cv::Mat1b rim;
  cv::dilate(seen == 0,
             rim,
             cv::getStructuringElement(cv::MORPH_RECT,
                                       {2 * kBesidePx + 1, 2 * kBesidePx + 1}));
  return rim;
}

// Whether half of a line or more lies on the rim.
bool IsAlong(const cv::Mat1b& rim, const LineSegment& line) {
  constexpr int kNumPlaces = 9;
  int num_on = 0;
  for (int i = 0; i < kNumPlaces; ++i) {
    const Eigen::Vector2d p =
        line.a + static_cast<double>(i) / (kNumPlaces - 1) * (line.b - line.a);
    const int x =
        std::clamp(static_cast<int>(std::lround(p.x())), 0, rim.cols - 1);
    const int y =
        std::clamp(static_cast<int>(std::lround(p.y())), 0, rim.rows - 1);
    num_on += rim(y, x) != 0 ? 1 : 0;
  }
  return 2 * num_on >= kNumPlaces;
}

}  // namespace

void CheckSeesAhead(const CameraModel& camera) {
  const auto straight = PixelFromRay(camera, Eigen::Vector3d(0.0, 0.0, 1.0));
  if (std::holds_alternative<PanoramaCamera>(camera) || !straight) {
    throw std::invalid_argument(
        "camera: must see straight ahead, as lenses do and panoramas do not");
  }
}

PinholeLines::PinholeLines(const CameraView& camera,
                           const LineExtractorOptions& options)
    : camera_(camera),
      intrinsics_(PinholeOf(camera)),
      view_{PerspectiveCamera(intrinsics_), camera.size},
      extractor_(options) {
  if (IsPinhole(camera)) return;
  remap_.emplace(view_, camera_, Eigen::Matrix3d::Identity());
  rim_ = RimOf(remap_->seen());
}

LineSet PinholeLines::Find(const cv::Mat1b& image) {
  const cv::Mat1b seen = remap_ ? cv::Mat1b(remap_->Apply(image)) : image;
  LineSet lines = extractor_.Extract(seen);
  if (!rim_.empty()) {
    std::erase_if(lines.segments, [this](const LineSegment& line) {
      return IsAlong(rim_, line);
    });
  }
  return lines;
}

std::optional<Eigen::Vector2d> PinholeLines::CameraPixel(
    const Eigen::Vector2d& pixel) const {
  if (!remap_) return pixel;
  const auto ray = RayFromPixel(view_.model, pixel);
  const auto seen = ray ? PixelFromRay(camera_.model, ray->ray) : std::nullopt;
  return seen ? std::optional(seen->pixel) : std::nullopt;
}

}  // namespace waymark
