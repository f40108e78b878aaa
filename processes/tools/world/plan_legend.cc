#include "processes/tools/world/plan_legend.h"

#include <utility>

namespace waymark {
namespace {

constexpr double kUnit = PlanCanvas::kOversampling;
constexpr double kRow = 18.0 * kUnit;
constexpr double kSample = 22.0 * kUnit;
constexpr double kSign = 16.0 * kUnit;
constexpr double kText = 0.38;

}  // namespace

void PlanLegend::Add(Sign sign,
                     const cv::Scalar& color,
                     double pen,
                     std::string text) {
  entries_.push_back({sign, color, pen, std::move(text), {}});
}

double PlanLegend::Arrange(double width) {
  const double left = kUnit * PlanCanvas::kMargin / 2.0;
  cv::Point2d at(left, 0.0);
  for (Entry& entry : entries_) {
    const double needed =
        kSample + PlanCanvas::TextWidth(entry.text, kText) + kSample;
    if (at.x > left && at.x + needed > width - left) at = {left, at.y + kRow};
    entry.at = at;
    at.x += needed;
  }
  return entries_.empty() ? 0.0 : at.y + kRow;
}

void PlanLegend::Draw(PlanCanvas* canvas) const {
  const double top = canvas->foot_top() - 4.0 * kUnit;
  for (const Entry& entry : entries_) {
    const cv::Point2d a = entry.at + cv::Point2d(0.0, top);
    const cv::Point2d b = a + cv::Point2d(kSign, 0.0);
    const cv::Point2d half(0.0, kSign / 4.0);
    switch (entry.sign) {
      case Sign::kLine:
        canvas->PixelLine(a, b, entry.color, entry.pen);
        break;
      case Sign::kArea:
        canvas->PixelArea(a - half, b + half, entry.color);
        break;
      case Sign::kDisc:
        canvas->PixelDisc((a + b) / 2.0, kSign / 4.0, entry.color);
        break;
    }
    const double text_width = PlanCanvas::TextWidth(entry.text, kText);
    canvas->Text(entry.text,
                 a + cv::Point2d(kSample + text_width / 2.0, 0.0),
                 kText,
                 kPlanText);
  }
}

}  // namespace waymark
