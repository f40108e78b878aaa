#include "processes/support/state_saver.h"

#include "estimation/base/input_error.h"

#include <exception>
#include <system_error>
#include <utility>

namespace waymark {

StateSaver::StateSaver(std::string path, bool is_offline, Write write)
    : path_(std::move(path)),
      is_offline_(is_offline),
      write_(std::move(write)) {
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
  if (!is_offline_) {
    try {
      writing_ = std::async(std::launch::async, [this] { WriteAll(); });
      return;
    } catch (const std::system_error&) {  // No thread is to be had.
    }
  }
  WriteAll();
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
      write_(path_, text);
    } catch (const InputError& error) {
      fault = error.what();
    } catch (const std::exception& error) {
      // Such as no memory. Whatever it is, the next text is tried again.
      fault = path_ + ": cannot be written: " + error.what();
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
