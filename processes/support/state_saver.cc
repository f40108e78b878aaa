#include "processes/support/state_saver.h"

#include "estimation/base/input_error.h"
#include "processes/support/state_file.h"

#include <utility>

namespace waymark {

StateSaver::StateSaver(std::string path, bool is_offline)
    : path_(std::move(path)), is_offline_(is_offline) {
  if (!path_.empty()) CheckStateFolder(path_);
}

StateSaver::~StateSaver() {
  Flush();
}

void StateSaver::Save(std::string text) {
  if (path_.empty()) return;
  {
    const MutexLock lock(&mutex_);
    next_ = std::move(text);
    if (is_writing_) return;  // Who writes sees it.
    is_writing_ = true;
  }
  if (is_offline_) {
    WriteAll();
  } else {
    writing_ = std::async(std::launch::async, [this] { WriteAll(); });
  }
}

void StateSaver::Flush() {
  if (writing_.valid()) writing_.get();
}

void StateSaver::WriteAll() {
  for (;;) {
    std::string text;
    {
      const MutexLock lock(&mutex_);
      if (!next_) {
        is_writing_ = false;
        return;
      }
      text = *std::exchange(next_, std::nullopt);
    }
    std::string fault;
    try {
      SaveStateFile(path_, text);
    } catch (const InputError& error) {
      fault = error.what();
    }
    const MutexLock lock(&mutex_);
    fault_ = std::move(fault);
  }
}

std::string StateSaver::fault() const {
  const MutexLock lock(&mutex_);
  return fault_;
}

}  // namespace waymark
