// Recorded images, played at the speed at which they were taken.
#pragma once

#include "drivers/video/frame_source.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace waymark {

// Images in the order of their times.
class Recording {
 public:
  virtual ~Recording() = default;
  // Time of the next image since that of the first; nullopt: there is none.
  [[nodiscard]] virtual std::optional<Duration> NextTime() = 0;
  // The next image, and on to the one behind it; nullopt, with *error in one
  // line, where it cannot be read.
  [[nodiscard]] virtual std::optional<cv::Mat> Read(std::string* error) = 0;
  virtual void Rewind() = 0;
};

// The first image is due at the first Take(), the others as far behind it as
// they were taken; each is stamped with the time at which it was due. Where it
// loops, the first follows the last as the last followed the one before. A
// recording without any image that can be read ends with a fault.
class PlayedFrames final : public FrameSource {
 public:
  // `name` is the recording's in messages.
  PlayedFrames(std::string name,
               std::unique_ptr<Recording> recording,
               bool loops);

  [[nodiscard]] std::optional<Frame> Take(Time now) override;
  [[nodiscard]] std::string Fault() const override { return fault_; }
  [[nodiscard]] std::vector<std::string> TakeWarnings() override;
  [[nodiscard]] bool has_ended() const override { return has_ended_; }
  [[nodiscard]] std::int64_t num_missed() const override { return num_missed_; }

 private:
  // At the end: begins anew, or ends. False: it has ended.
  bool Rewind();

  std::string name_;
  std::unique_ptr<Recording> recording_;
  bool loops_;
  std::optional<Time> start_;  // When the first image was, or is, due.
  Duration last_{0};           // Of the image read last.
  Duration gap_{0};            // Between it and the one before.
  bool has_read_any_ = false;  // In this pass.
  bool has_ended_ = false;
  std::int64_t num_missed_ = 0;
  std::string fault_;
  std::vector<std::string> warnings_;
};

}  // namespace waymark
