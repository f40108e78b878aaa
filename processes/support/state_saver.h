// Saves the state of a process without holding its loop.
#pragma once

#include "estimation/base/mutex.h"
#include "processes/support/state_file.h"

#include <functional>
#include <future>
#include <optional>
#include <string>

namespace waymark {

// Writes as SaveStateFile() does, in a thread of its own: a slow disk takes
// most of a second for that, in which a loop must go on. One write at a time;
// of what comes meanwhile only the newest text is written, after it.
class StateSaver {
 public:
  // As SaveStateFile(), which tests replace.
  using Write =
      std::function<void(const std::string& path, const std::string& text)>;

  // An offline run writes at once: the same files every time. Throws as
  // CheckStateFolder() does; with an empty path Save() does nothing.
  StateSaver(std::string path, bool is_offline, Write write = SaveStateFile);
  // Returns once everything is on disk, or has failed.
  ~StateSaver();
  StateSaver(const StateSaver&) = delete;
  StateSaver& operator=(const StateSaver&) = delete;

  void Save(std::string text);
  // Returns once everything is on disk, or has failed.
  void Flush();

  // One line why the last write failed; empty where it did not.
  [[nodiscard]] std::string fault() const;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void WriteAll();

  std::string path_;
  bool is_offline_;
  Write write_;
  mutable Mutex mutex_;
  std::optional<std::string> next_ WAYMARK_GUARDED_BY(mutex_);
  bool is_writing_ WAYMARK_GUARDED_BY(mutex_) = false;
  std::string fault_ WAYMARK_GUARDED_BY(mutex_);
  std::future<void> writing_;  // Last: its end may use all others.
};

}  // namespace waymark
