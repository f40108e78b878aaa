#include "processes/support/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace waymark {

Progress::Progress(std::string what, std::int64_t total)
    : what_(std::move(what)),
      total_(total),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      next_(std::chrono::steady_clock::now() + std::chrono::milliseconds(500)) {
}

Progress::~Progress() {
  Clear();
}

void Progress::Clear() {
  if (is_shown_) std::fprintf(stderr, "\r\033[K");
  is_shown_ = false;
}

void Progress::Show(std::int64_t done) {
  if (!is_terminal_ || total_ <= 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  is_shown_ = true;
  std::fprintf(stderr,
               "\r\033[K%s: %d %% of %.1f MB",
               what_.c_str(),
               static_cast<int>(100 * done / total_),
               static_cast<double>(total_) / 1e6);
  std::fflush(stderr);
}

}  // namespace waymark
