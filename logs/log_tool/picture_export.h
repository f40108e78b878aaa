// A log's images as files.
#pragma once

#include "processes/support/output_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace waymark {

struct PictureOptions {
  std::string channel{};       // One alone; empty: all of images.
  std::int64_t max_files = 0;  // Of all channels together.
  IfExists if_exists = IfExists::kFail;
};

struct PictureReport {
  struct Channel {
    std::string name;
    std::int64_t num_files = 0;
    std::int64_t num_bad = 0;  // Images that nothing can be made of,
    std::string reason;        // and why of the first.
  };
  std::vector<Channel> channels;  // By name.
  std::int64_t num_left_out = 0;  // Beyond max_files.
};

// Writes <folder>/<channel>_<utime>.jpg for each image_t that is a JPEG, with
// its own bytes, and .png for each that is raw; a channel's second image of the
// same utime gets "_2" behind it. Makes the folder if it is missing.
//
// Throws InputError where reading or writing fails, a file exists (kFail), or
// the log, or the channel, has no image.
PictureReport ExportPictures(const std::string& log,
                             const std::string& folder,
                             const PictureOptions& options);

}  // namespace waymark
