#include "tests/support/test_video.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <stdexcept>

namespace waymark {

cv::Mat NumberedImage(int number) {
  return {48, 64, CV_8UC3, cv::Scalar::all(8 + 8 * number)};
}

int NumberOf(const cv::Mat& image) {
  return static_cast<int>(std::lround((cv::mean(image)[0] - 8.0) / 8.0));
}

void WriteImage(const std::string& path, const cv::Mat& image) {
  if (!cv::imwrite(path, image)) throw std::runtime_error("cannot write");
}

void WriteNumberedVideo(const std::string& path, int num_frames, double hz) {
  cv::VideoWriter writer(path,
                         cv::CAP_OPENCV_MJPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                         hz,
                         {64, 48});
  if (!writer.isOpened()) throw std::runtime_error("cannot write " + path);
  for (int i = 0; i < num_frames; ++i) writer.write(NumberedImage(i));
}

}  // namespace waymark
