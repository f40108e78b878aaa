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
// A leaf, with its lower edge on the floor.
void PaintDoor(const std::optional<cv::Vec3b>& wood,
               double pixels_per_metre,
               std::uint64_t seed,
               bool has_handle_left,
               cv::Mat3b* image);
// Papers stuck to a door at the height of the eyes and below.
void PaintNotices(double pixels_per_metre,
                  std::uint64_t seed,
                  cv::Mat3b* image);

}  // namespace waymark
