// The newest image of a camera, from a thread that waits for it.
#pragma once

#include "drivers/video/camera_device.h"
#include "drivers/video/frame_source.h"
#include "estimation/base/mutex.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace waymark {

struct LiveFramesOptions {
  std::string name;        // Of the camera, for errors.
  double retry_s = 1.0;    // Between attempts to open it.
  double silence_s = 2.0;  // Without an image for this long it has a fault.
};

// One thread opens the device, again where it is lost, and reads it into a
// mailbox that holds the newest image only.
class LiveFrames final : public FrameSource {
 public:
  // Returns null and sets *error where the camera cannot be opened.
  using Opener =
      std::function<std::unique_ptr<CameraDevice>(std::string* error)>;

  // `open` and `clock` are called in the thread only, and `clock` right after
  // an image has come.
  LiveFrames(const LiveFramesOptions& options,
             Opener open,
             std::function<Time()> clock);
  // Waits for the device to finish its read.
  ~LiveFrames() override;
  LiveFrames(const LiveFrames&) = delete;
  LiveFrames& operator=(const LiveFrames&) = delete;

  [[nodiscard]] std::optional<Frame> Take(Time now) override;
  [[nodiscard]] std::string Fault() const override;
  [[nodiscard]] std::vector<std::string> TakeWarnings() override { return {}; }
  [[nodiscard]] bool has_ended() const override { return false; }
  [[nodiscard]] std::int64_t num_missed() const override;

 private:
  void Run();
  // Reads until the camera is gone or the end; what became of it.
  void ReadAll(CameraDevice* camera);
  void SetFault(const std::string& fault);
  // False: the end.
  [[nodiscard]] bool WaitToRetry();

  LiveFramesOptions options_;
  Opener open_;
  std::function<Time()> clock_;
  std::optional<Time> heard_;  // Of Take(): the last image, or the first call.
  bool is_silent_ = false;

  mutable Mutex mutex_;
  std::optional<Frame> newest_ WAYMARK_GUARDED_BY(mutex_);
  std::string fault_ WAYMARK_GUARDED_BY(mutex_);
  std::int64_t num_missed_ WAYMARK_GUARDED_BY(mutex_) = 0;

  std::mutex end_mutex_;
  std::condition_variable end_condition_;
  bool must_end_ = false;  // Under end_mutex_.
  std::thread thread_;
};

}  // namespace waymark
