// A folder of images as a recording.
#pragma once

#include "drivers/video/played_frames.h"

#include <cstddef>
#include <string>
#include <vector>

namespace waymark {

// All .jpg, .jpeg, .png, .bmp, .pgm, .ppm, .tif and .tiff files of a folder, or
// what a pattern names. Their times come from
//   1. a times file, where one is given: a line per image, "time" or "time
//      name", in seconds, times increasing; "#" begins a comment, a comma
//      separates as well as blanks do. Without names there are as many lines as
//      images; with names, images that it does not name are left out.
//   2. their names, where all are whole numbers at least 0.1 ms apart when
//      taken for nanoseconds: 24062500000.jpg;
//   3. the rate, in the order of their names (numbers in names by value).
class ImageSequence final : public Recording {
 public:
  // Throws InputError with one line: no such folder, no images, times that are
  // none. rate_hz 0: 10 Hz.
  ImageSequence(const std::string& source,
                const std::string& times_file,
                double rate_hz);

  [[nodiscard]] std::optional<Duration> NextTime() override;
  // An image must decode as a whole: of JPEG files the end is looked for.
  [[nodiscard]] std::optional<cv::Mat> Read(std::string* error) override;
  void Rewind() override { next_ = 0; }

  struct Entry {
    std::string path;
    Duration time{0};  // Since the first.
  };
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
  std::size_t next_ = 0;
};

}  // namespace waymark
