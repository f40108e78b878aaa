#include "drivers/video/live_frames.h"

#include <chrono>
#include <utility>

namespace waymark {

LiveFrames::LiveFrames(const LiveFramesOptions& options,
                       Opener open,
                       std::function<Time()> clock)
    : options_(options),
      open_(std::move(open)),
      clock_(std::move(clock)),
      thread_([this] { Run(); }) {}

LiveFrames::~LiveFrames() {
  {
    const std::lock_guard lock(end_mutex_);
    must_end_ = true;
  }
  end_condition_.notify_all();
  thread_.join();
}

bool LiveFrames::WaitToRetry() {
  std::unique_lock lock(end_mutex_);
  const auto pause = std::chrono::duration<double>(options_.retry_s);
  return !end_condition_.wait_for(lock, pause, [this] { return must_end_; });
}

void LiveFrames::SetFault(const std::string& fault) {
  const MutexLock lock(&mutex_);
  fault_ = fault;
}

void LiveFrames::Run() {
  do {
    std::string error;
    const std::unique_ptr<CameraDevice> camera = open_(&error);
    if (camera) {
      ReadAll(camera.get());
    } else {
      SetFault(error);
    }
  } while (WaitToRetry());
}

void LiveFrames::ReadAll(CameraDevice* camera) {
  while (true) {
    {
      const std::lock_guard lock(end_mutex_);
      if (must_end_) return;
    }
    // A new one each time: the one before may be in use.
    cv::Mat image;
    if (!camera->Read(&image)) {
      SetFault(options_.name + ": gives no more images");
      return;
    }
    const Time time = clock_();
    const MutexLock lock(&mutex_);
    fault_.clear();
    if (newest_) ++num_missed_;
    newest_ = Frame{std::move(image), time};
  }
}

std::optional<Frame> LiveFrames::Take(Time now) {
  std::optional<Frame> frame;
  {
    const MutexLock lock(&mutex_);
    frame = std::exchange(newest_, std::nullopt);
  }
  if (frame || !heard_) heard_ = now;
  is_silent_ = now - *heard_ > DurationFromSeconds(options_.silence_s);
  return frame;
}

std::string LiveFrames::Fault() const {
  const MutexLock lock(&mutex_);
  if (fault_.empty() && is_silent_) return options_.name + ": gives no images";
  return fault_;
}

std::int64_t LiveFrames::num_missed() const {
  const MutexLock lock(&mutex_);
  return num_missed_;
}

}  // namespace waymark
