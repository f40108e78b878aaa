#include "drivers/video/played_frames.h"

#include <utility>

namespace waymark {

PlayedFrames::PlayedFrames(std::string name,
                           std::unique_ptr<Recording> recording,
                           bool loops)
    : name_(std::move(name)), recording_(std::move(recording)), loops_(loops) {}

bool PlayedFrames::Rewind() {
  if (!has_read_any_) fault_ = name_ + ": no image of it can be read";
  // A single image has no gap that says when it is due again.
  if (!loops_ || !has_read_any_ || gap_ <= Duration(0)) {
    has_ended_ = true;
    return false;
  }
  *start_ += last_ + gap_;
  last_ = Duration(0);
  has_read_any_ = false;
  recording_->Rewind();
  return true;
}

std::optional<Frame> PlayedFrames::Take(Time now) {
  if (has_ended_) return std::nullopt;
  if (!start_) start_ = now;
  std::optional<Frame> newest;
  while (true) {
    const std::optional<Duration> next = recording_->NextTime();
    if (!next) {
      if (Rewind()) continue;
      break;
    }
    const Time due = *start_ + *next;
    if (due > now) break;
    gap_ = *next > last_ ? *next - last_ : gap_;
    last_ = *next;
    std::string error;
    std::optional<cv::Mat> image = recording_->Read(&error);
    if (!image) {
      warnings_.push_back(std::move(error));
      continue;
    }
    has_read_any_ = true;
    if (newest) ++num_missed_;
    newest = Frame{std::move(*image), due};
  }
  return newest;
}

std::vector<std::string> PlayedFrames::TakeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace waymark
