// Noticeboards, signs and doors: one piece each.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace waymark {

void PaintNoticeboard(const std::optional<cv::Vec3b>& frame,
                      double pixels_per_metre,
                      std::uint64_t seed,
                      cv::Mat3b* image);
// Lines of text, split at '\n', on a plate.
void PaintSign(const std::optional<cv::Vec3b>& plate,
               const std::string& text,
               cv::Mat3b* image);
// A leaf with its hinges on the left.
void PaintDoor(const std::optional<cv::Vec3b>& wood,
               double pixels_per_metre,
               std::uint64_t seed,
               cv::Mat3b* image);

}  // namespace waymark
