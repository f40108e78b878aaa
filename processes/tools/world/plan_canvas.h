// What a plan is drawn on: metres in, pixels out.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <functional>
#include <span>
#include <string>

namespace waymark {

inline const cv::Scalar kPlanPaper(255, 255, 255);
inline const cv::Scalar kPlanText(70, 64, 60);

// Drawn twice as large, then halved: OpenCV smooths lines but no areas. North
// is up. Pens are in pixels of the result, pixels those of the large image.
class PlanCanvas {
 public:
  static constexpr int kOversampling = 2;
  static constexpr int kMargin = 70;

  // `box`: what is to be seen, m; `pixels`: of the longer side of the result;
  // foot(width): height of what goes below it, in pixels.
  PlanCanvas(const Eigen::AlignedBox2d& box,
             int pixels,
             const std::function<double(double width)>& foot);

  [[nodiscard]] cv::Point2d At(const Eigen::Vector2d& p) const;

  void Line(const Eigen::Vector2d& a,
            const Eigen::Vector2d& b,
            const cv::Scalar& color,
            double pen);
  void Fill(std::span<const Eigen::Vector2d> outline, const cv::Scalar& color);
  void Outline(std::span<const Eigen::Vector2d> outline,
               const cv::Scalar& color,
               double pen);
  void Disc(const Eigen::Vector2d& p,
            double radius_px,
            const cv::Scalar& color);

  // At pixels.
  void PixelLine(const cv::Point2d& a,
                 const cv::Point2d& b,
                 const cv::Scalar& color,
                 double pen);
  void PixelArea(const cv::Point2d& a,
                 const cv::Point2d& b,
                 const cv::Scalar& color);
  void PixelDisc(const cv::Point2d& middle,
                 double radius_px,
                 const cv::Scalar& color);
  // Centred.
  void Text(const std::string& text,
            const cv::Point2d& middle,
            double size,
            const cv::Scalar& color);
  [[nodiscard]] static double TextWidth(const std::string& text, double size);

  // 255 where it shows kPlanPaper and nothing else so far.
  [[nodiscard]] cv::Mat1b Paper() const;
  // What is 0 in such a mask becomes the ground around the plan.
  void ClearOutside(const cv::Mat1b& paper);
  [[nodiscard]] cv::Mat3b Halved() const;

  [[nodiscard]] const Eigen::AlignedBox2d& box() const { return box_; }
  [[nodiscard]] double scale() const { return scale_; }  // Pixels per metre.
  [[nodiscard]] double width() const { return image_.cols; }
  [[nodiscard]] double foot_top() const { return image_.rows - foot_height_; }

 private:
  Eigen::AlignedBox2d box_;
  double scale_ = 1.0;
  double foot_height_ = 0.0;
  cv::Mat3b image_;
};

}  // namespace waymark
