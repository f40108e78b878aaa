#include "processes/tools/calibrate/calibrate_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

namespace waymark {

std::string CalibrationTable(const CameraCalibration& calibration,
                             const std::vector<BoardImage>& images,
                             const CalibrationOptions& options) {
  std::string text = fmt::format("{} camera, {} x {} px\n",
                                 NameOf(options.kind),
                                 options.size.width,
                                 options.size.height);
  const std::vector<std::string>& names = ParameterNames(options.kind);
  const Eigen::VectorXd values = ParametersOf(calibration.camera);
  text += fmt::format("  {:<10}{:>14}{:>12}\n", "", "value", "sigma");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double sigma = calibration.sigma(k);
    text += fmt::format("  {:<10}{:>14.6g}{:>12}\n",
                        names[i],
                        values(k),
                        sigma > 0.0 ? fmt::format("{:.2g}", sigma) : "fixed");
  }
  text += fmt::format("  {:<40}{:>9}{:>10}{:>10}{:>10}\n",
                      "image",
                      "corners",
                      "left out",
                      "RMS, px",
                      "worst, px");
  for (std::size_t i = 0; i < images.size(); ++i) {
    const ViewCalibration& view = calibration.views[i];
    text +=
        fmt::format("  {:<40}{:>9}{:>10}{:>10.3f}{:>10.3f}\n",
                    images[i].path.substr(images[i].path.find_last_of('/') + 1),
                    view.num_used,
                    view.num_left_out,
                    view.rms_px,
                    view.max_px);
  }
  text += fmt::format(
      "reprojection error: {:.3f} px RMS of distances; a corner is known to "
      "{:.3f} px in x and y each\n",
      calibration.rms_px,
      calibration.sigma_px);
  return text;
}

std::string CalibrationJson(const CameraCalibration& calibration,
                            const std::vector<BoardImage>& images,
                            const CalibrationOptions& options) {
  nlohmann::json json;
  json["model"] = NameOf(options.kind);
  json["width"] = options.size.width;
  json["height"] = options.size.height;
  const std::vector<std::string>& names = ParameterNames(options.kind);
  const Eigen::VectorXd values = ParametersOf(calibration.camera);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    json["parameters"][names[i]] = {{"value", values(k)},
                                    {"sigma", calibration.sigma(k)}};
  }
  json["rms_px"] = calibration.rms_px;
  json["sigma_px"] = calibration.sigma_px;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const ViewCalibration& view = calibration.views[i];
    json["images"].push_back({{"path", images[i].path},
                              {"num_used", view.num_used},
                              {"num_left_out", view.num_left_out},
                              {"rms_px", view.rms_px},
                              {"max_px", view.max_px}});
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

cv::Mat DrawResiduals(const cv::Mat& image,
                      const BoardView& view,
                      const ViewCalibration& result,
                      const CameraModel& camera) {
  constexpr double kEnlarged = 50.0;
  // Eighths of a pixel.
  constexpr int kShift = 3;
  const auto point = [](const Eigen::Vector2d& p) {
    return cv::Point(cvRound(p.x() * (1 << kShift)),
                     cvRound(p.y() * (1 << kShift)));
  };
  cv::Mat picture;
  cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  const cv::Scalar green(80, 220, 80);
  const cv::Scalar red(60, 60, 255);
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector2d& pixel = view.pixels[i];
    cv::circle(
        picture, point(pixel), 4 << kShift, green, 1, cv::LINE_AA, kShift);
    const auto seen = PixelFromRay(
        camera,
        result.X_CB *
            Eigen::Vector3d(view.points_B[i].x(), view.points_B[i].y(), 0.0));
    if (!seen) continue;
    const Eigen::Vector2d end = pixel + kEnlarged * (seen->pixel - pixel);
    cv::line(picture, point(pixel), point(end), red, 1, cv::LINE_AA, kShift);
  }
  return picture;
}

}  // namespace waymark
