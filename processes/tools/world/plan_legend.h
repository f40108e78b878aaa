// What the signs of a plan mean, below it.
#pragma once

#include "processes/tools/world/plan_canvas.h"

#include <opencv2/core.hpp>

#include <string>
#include <vector>

namespace waymark {

class PlanLegend {
 public:
  enum class Sign { kLine, kArea, kDisc };

  // `pen`: of a line.
  void Add(Sign sign, const cv::Scalar& color, double pen, std::string text);

  // Puts the entries into rows of a picture so wide; returns their height.
  // Both in pixels of the canvas.
  double Arrange(double width);

  // At the canvas's foot, as arranged for its width.
  void Draw(PlanCanvas* canvas) const;

 private:
  struct Entry {
    Sign sign = Sign::kLine;
    cv::Scalar color;
    double pen = 0.0;
    std::string text;
    cv::Point2d at;  // Of its sign's left end, below the plan.
  };
  std::vector<Entry> entries_;
};

}  // namespace waymark
