#include "tests/bench/opencv_cameras.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>

#include <array>
#include <cmath>
#include <numeric>
#include <variant>

namespace waymark {
namespace {

cv::Matx33d MatrixOf(const Intrinsics& k) {
  return {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0};
}

Intrinsics IntrinsicsOf(const cv::Mat& matrix) {
  const cv::Matx33d k = matrix;
  return {k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
}

cv::Mat Points3(const BoardView& view) {
  cv::Mat points(1, static_cast<int>(view.points_B.size()), CV_64FC3);
  for (int i = 0; i < points.cols; ++i) {
    const Eigen::Vector2d& p = view.points_B[static_cast<std::size_t>(i)];
    points.at<cv::Vec3d>(i) = {p.x(), p.y(), 0.0};
  }
  return points;
}

cv::Mat Points2(std::span<const Eigen::Vector2d> pixels) {
  cv::Mat points(1, static_cast<int>(pixels.size()), CV_64FC2);
  for (int i = 0; i < points.cols; ++i) {
    const Eigen::Vector2d& p = pixels[static_cast<std::size_t>(i)];
    points.at<cv::Vec2d>(i) = {p.x(), p.y()};
  }
  return points;
}

std::vector<int> AllOf(std::size_t num_views) {
  std::vector<int> all(num_views);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

struct Input {
  std::vector<cv::Mat> points;
  std::vector<cv::Mat> pixels;
  cv::Size size;
};

OpenCvCalibration Perspective(const Input& input, int num_distortion) {
  // k1, k2, p1, p2, k3; OpenCV's calibration takes single precision only.
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (std::size_t v = 0; v < input.points.size(); ++v) {
    points.emplace_back(input.points[v].begin<cv::Vec3d>(),
                        input.points[v].end<cv::Vec3d>());
    pixels.emplace_back(input.pixels[v].begin<cv::Vec2d>(),
                        input.pixels[v].end<cv::Vec2d>());
  }
  int flags = 0;
  if (num_distortion < 5) flags |= cv::CALIB_FIX_K3;
  if (num_distortion < 4) flags |= cv::CALIB_ZERO_TANGENT_DIST;
  if (num_distortion < 2) flags |= cv::CALIB_FIX_K2;
  if (num_distortion < 1) flags |= cv::CALIB_FIX_K1;
  cv::Mat matrix;
  cv::Mat lens;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  const double rms = cv::calibrateCamera(
      points, pixels, input.size, matrix, lens, turns, shifts, flags);
  const auto at = [&lens](int i) { return lens.at<double>(i); };
  return {PerspectiveCamera(IntrinsicsOf(matrix),
                            {at(0), at(1), at(2), at(3), at(4)}),
          rms,
          AllOf(points.size())};
}

OpenCvCalibration Fisheye(const Input& input, int num_distortion) {
  constexpr std::array kFixed{cv::fisheye::CALIB_FIX_K1,
                              cv::fisheye::CALIB_FIX_K2,
                              cv::fisheye::CALIB_FIX_K3,
                              cv::fisheye::CALIB_FIX_K4};
  int flags =
      cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW;
  for (std::size_t i = static_cast<std::size_t>(num_distortion); i < 4; ++i) {
    flags |= kFixed[i];
  }
  cv::Mat matrix;
  cv::Mat lens;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  const double rms = cv::fisheye::calibrate(input.points,
                                            input.pixels,
                                            input.size,
                                            matrix,
                                            lens,
                                            turns,
                                            shifts,
                                            flags);
  const auto at = [&lens](int i) { return lens.at<double>(i); };
  return {FisheyeCamera(IntrinsicsOf(matrix), {at(0), at(1), at(2), at(3)}),
          rms,
          AllOf(input.points.size())};
}

OpenCvCalibration Sphere(const Input& input,
                         const CalibrationOptions& options) {
  int flags = cv::omnidir::CALIB_FIX_SKEW;
  if (options.xi) flags |= cv::omnidir::CALIB_FIX_XI;
  if (options.num_distortion < 4) {
    flags |= cv::omnidir::CALIB_FIX_P1 | cv::omnidir::CALIB_FIX_P2;
  }
  if (options.num_distortion < 2) flags |= cv::omnidir::CALIB_FIX_K2;
  if (options.num_distortion < 1) flags |= cv::omnidir::CALIB_FIX_K1;
  cv::Mat matrix;
  cv::Mat xi;
  cv::Mat lens;
  cv::Mat used;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  // Its documentation's example takes as many steps and as small a change.
  const double rms = cv::omnidir::calibrate(
      input.points,
      input.pixels,
      input.size,
      matrix,
      xi,
      lens,
      turns,
      shifts,
      flags,
      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-8},
      used);
  Intrinsics k = IntrinsicsOf(matrix);
  LensDistortion d{lens.at<double>(0),
                   lens.at<double>(1),
                   lens.at<double>(2),
                   lens.at<double>(3)};
  if (options.is_mirrored) {
    // It takes the board to be seen from behind: y the other way round.
    k.fy = -k.fy;
    d.p1 = -d.p1;
  }
  return {SphereCamera(xi.at<double>(0), k, d),
          rms,
          {used.begin<int>(), used.end<int>()}};
}

}  // namespace

std::optional<OpenCvCalibration> CalibrateWithOpenCv(
    std::span<const BoardView> views, const CalibrationOptions& options) {
  Input input;
  input.size = {options.size.width, options.size.height};
  for (const BoardView& view : views) {
    input.points.push_back(Points3(view));
    input.pixels.push_back(Points2(view.pixels));
  }
  try {
    OpenCvCalibration result;
    switch (options.kind) {
      case CameraKind::kPerspective:
        result = Perspective(input, options.num_distortion);
        break;
      case CameraKind::kFisheye:
        result = Fisheye(input, options.num_distortion);
        break;
      case CameraKind::kSphere:
        result = Sphere(input, options);
        break;
      case CameraKind::kPanorama:
        return std::nullopt;
    }
    if (!std::isfinite(result.rms_px)) return std::nullopt;
    return result;
  } catch (const std::exception&) {  // cv::Exception, or not finite.
    return std::nullopt;
  }
}

std::vector<Eigen::Vector2d> ProjectWithOpenCv(
    const CameraModel& camera, std::span<const Eigen::Vector3d> points) {
  const cv::Mat from(1,
                     static_cast<int>(points.size()),
                     CV_64FC3,
                     const_cast<double*>(points.data()->data()));
  std::vector<Eigen::Vector2d> pixels(points.size());
  cv::Mat to(1, from.cols, CV_64FC2, pixels.data()->data());
  const cv::Vec3d zero = cv::Vec3d::all(0.0);
  if (const auto* c = std::get_if<PerspectiveCamera>(&camera)) {
    const LensDistortion& d = c->distortion();
    const cv::Mat lens =
        (cv::Mat_<double>(1, 5) << d.k1, d.k2, d.p1, d.p2, d.k3);
    cv::projectPoints(from, zero, zero, MatrixOf(c->intrinsics()), lens, to);
  } else if (const auto* f = std::get_if<FisheyeCamera>(&camera)) {
    const auto& k = f->coefficients();
    cv::fisheye::projectPoints(from,
                               to,
                               zero,
                               zero,
                               MatrixOf(f->intrinsics()),
                               cv::Vec4d(k[0], k[1], k[2], k[3]));
  } else if (const auto* s = std::get_if<SphereCamera>(&camera)) {
    const LensDistortion& d = s->distortion();
    cv::omnidir::projectPoints(from,
                               to,
                               zero,
                               zero,
                               MatrixOf(s->intrinsics()),
                               s->xi(),
                               cv::Vec4d(d.k1, d.k2, d.p1, d.p2));
  }
  return pixels;
}

std::vector<Eigen::Vector2d> UndistortWithOpenCv(
    const CameraModel& camera,
    std::span<const Eigen::Vector2d> pixels,
    int num_steps) {
  const cv::Mat from(1,
                     static_cast<int>(pixels.size()),
                     CV_64FC2,
                     const_cast<double*>(pixels.data()->data()));
  std::vector<Eigen::Vector2d> plane(pixels.size());
  cv::Mat to(1, from.cols, CV_64FC2, plane.data()->data());
  const cv::Matx33d one = cv::Matx33d::eye();
  if (const auto* c = std::get_if<PerspectiveCamera>(&camera)) {
    const LensDistortion& d = c->distortion();
    const cv::Mat lens =
        (cv::Mat_<double>(1, 5) << d.k1, d.k2, d.p1, d.p2, d.k3);
    cv::undistortPoints(from,
                        to,
                        MatrixOf(c->intrinsics()),
                        lens,
                        one,
                        one,
                        {cv::TermCriteria::COUNT, num_steps, 0.0});
  } else if (const auto* f = std::get_if<FisheyeCamera>(&camera)) {
    const auto& k = f->coefficients();
    cv::fisheye::undistortPoints(
        from, to, MatrixOf(f->intrinsics()), cv::Vec4d(k[0], k[1], k[2], k[3]));
  } else if (const auto* s = std::get_if<SphereCamera>(&camera)) {
    const LensDistortion& d = s->distortion();
    cv::omnidir::undistortPoints(from,
                                 to,
                                 MatrixOf(s->intrinsics()),
                                 cv::Vec4d(d.k1, d.k2, d.p1, d.p2),
                                 cv::Mat(1, 1, CV_64F, cv::Scalar(s->xi())),
                                 cv::Mat::eye(3, 3, CV_64F));
  }
  return plane;
}

}  // namespace waymark
