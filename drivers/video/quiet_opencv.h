// Keeps OpenCV from writing to stderr what our own errors say in one line.
#pragma once

#include <opencv2/core/utils/logger.hpp>

namespace waymark {

// For as long as one exists. The level is OpenCV's own and of the process.
class QuietOpenCv {
 public:
  QuietOpenCv()
      : before_(cv::utils::logging::setLogLevel(
            cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

}  // namespace waymark
