#include "processes/tools/world/plan_canvas.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace waymark {
namespace {

const cv::Vec3b kGround(236, 238, 240);
constexpr int kShift = 4;  // Bits of a fraction of a pixel.
constexpr int kMaxPixels = 8000;
constexpr double kTextPen = 0.6;

cv::Point Fixed(const cv::Point2d& p) {
  return {static_cast<int>(std::lround(p.x * (1 << kShift))),
          static_cast<int>(std::lround(p.y * (1 << kShift)))};
}

int Pen(double pixels) {
  return std::max(
      1, static_cast<int>(std::lround(pixels * PlanCanvas::kOversampling)));
}

cv::Size SizeOfText(const std::string& text, double size) {
  int baseline = 0;
  return cv::getTextSize(text,
                         cv::FONT_HERSHEY_SIMPLEX,
                         size * PlanCanvas::kOversampling,
                         Pen(kTextPen),
                         &baseline);
}

}  // namespace

PlanCanvas::PlanCanvas(const Eigen::AlignedBox2d& box,
                       int pixels,
                       const std::function<double(double width)>& foot)
    : box_(box) {
  const double side = std::max(box_.sizes().maxCoeff(), 1.0);
  scale_ = kOversampling * (std::clamp(pixels, 200, kMaxPixels) - 2 * kMargin) /
           side;
  Eigen::Vector2d size =
      box_.sizes() * scale_ +
      Eigen::Vector2d::Constant(2.0 * kOversampling * kMargin);
  foot_height_ = foot(size.x());
  size.y() += foot_height_;
  image_ = cv::Mat3b(static_cast<int>(size.y()) & ~1,
                     static_cast<int>(size.x()) & ~1,
                     kGround);
}

cv::Point2d PlanCanvas::At(const Eigen::Vector2d& p) const {
  const double margin = kOversampling * kMargin;
  return {
      margin + (p.x() - box_.min().x()) * scale_,
      image_.rows - foot_height_ - margin - (p.y() - box_.min().y()) * scale_};
}

void PlanCanvas::Line(const Eigen::Vector2d& a,
                      const Eigen::Vector2d& b,
                      const cv::Scalar& color,
                      double pen) {
  PixelLine(At(a), At(b), color, pen);
}

void PlanCanvas::Fill(std::span<const Eigen::Vector2d> outline,
                      const cv::Scalar& color) {
  std::vector<cv::Point> points;
  for (const Eigen::Vector2d& p : outline) points.push_back(Fixed(At(p)));
  cv::fillPoly(image_,
               std::vector<std::vector<cv::Point>>{points},
               color,
               cv::LINE_AA,
               kShift);
}

void PlanCanvas::Outline(std::span<const Eigen::Vector2d> outline,
                         const cv::Scalar& color,
                         double pen) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    Line(outline[i], outline[(i + 1) % outline.size()], color, pen);
  }
}

void PlanCanvas::Disc(const Eigen::Vector2d& p,
                      double radius_px,
                      const cv::Scalar& color) {
  PixelDisc(At(p), radius_px, color);
}

void PlanCanvas::PixelLine(const cv::Point2d& a,
                           const cv::Point2d& b,
                           const cv::Scalar& color,
                           double pen) {
  cv::line(image_, Fixed(a), Fixed(b), color, Pen(pen), cv::LINE_AA, kShift);
}

void PlanCanvas::PixelArea(const cv::Point2d& a,
                           const cv::Point2d& b,
                           const cv::Scalar& color) {
  cv::rectangle(
      image_, Fixed(a), Fixed(b), color, cv::FILLED, cv::LINE_AA, kShift);
}

void PlanCanvas::PixelDisc(const cv::Point2d& middle,
                           double radius_px,
                           const cv::Scalar& color) {
  cv::circle(image_,
             Fixed(middle),
             static_cast<int>(std::lround(radius_px * (1 << kShift))),
             color,
             cv::FILLED,
             cv::LINE_AA,
             kShift);
}

void PlanCanvas::Text(const std::string& text,
                      const cv::Point2d& middle,
                      double size,
                      const cv::Scalar& color) {
  const cv::Size box = SizeOfText(text, size);
  const cv::Point origin(static_cast<int>(middle.x) - box.width / 2,
                         static_cast<int>(middle.y) + box.height / 2);
  // A rim of paper keeps it readable on whatever it covers.
  constexpr double kRimPen = 2.4;
  for (const auto& [ink, pen] :
       {std::pair(kPlanPaper, Pen(kRimPen)), std::pair(color, Pen(kTextPen))}) {
    cv::putText(image_,
                text,
                origin,
                cv::FONT_HERSHEY_SIMPLEX,
                size * kOversampling,
                ink,
                pen,
                cv::LINE_AA);
  }
}

double PlanCanvas::TextWidth(const std::string& text, double size) {
  return SizeOfText(text, size).width;
}

cv::Mat1b PlanCanvas::Paper() const {
  cv::Mat1b paper;
  cv::inRange(image_, kPlanPaper, kPlanPaper, paper);
  return paper;
}

void PlanCanvas::ClearOutside(const cv::Mat1b& paper) {
  image_.setTo(kGround, paper == 0);
}

cv::Mat3b PlanCanvas::Halved() const {
  cv::Mat3b small;
  cv::resize(image_,
             small,
             {},
             1.0 / kOversampling,
             1.0 / kOversampling,
             cv::INTER_AREA);
  return small;
}

}  // namespace waymark
