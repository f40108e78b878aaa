// Images and videos that tests write and recognise again.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>

namespace waymark {

// Colour, 64 x 48 px, with the number in its mean gray: 8 levels each, so that
// JPEG does not hide it. Numbers 0 to 29.
[[nodiscard]] cv::Mat NumberedImage(int number);
[[nodiscard]] int NumberOf(const cv::Mat& image);

void WriteImage(const std::string& path, const cv::Mat& image);
// Motion JPEG in AVI: NumberedImage(0), (1), ...
void WriteNumberedVideo(const std::string& path, int num_frames, double hz);

}  // namespace waymark
