#include "processes/support/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace waymark {

std::string TimeLeftText(std::chrono::duration<double> passed,
                         std::int64_t done,
                         std::int64_t total) {
  if (done <= 0) return "";
  const double seconds = passed.count() * static_cast<double>(total - done) /
                         static_cast<double>(done);
  char text[40];
  if (seconds < 100.0) {
    std::snprintf(text, sizeof(text), "%.0f s left", std::ceil(seconds));
  } else if (seconds < 6000.0) {
    std::snprintf(text, sizeof(text), "%.0f min left", seconds / 60.0);
  } else {
    std::snprintf(text, sizeof(text), "%.1f h left", seconds / 3600.0);
  }
  return text;
}

std::string RunsText(const std::string& what,
                     std::chrono::duration<double> passed,
                     std::int64_t already,
                     std::int64_t done,
                     std::int64_t total) {
  const std::string left =
      TimeLeftText(passed, done - already, total - already);
  return what + ": " + std::to_string(done) + " of " + std::to_string(total) +
         (left.empty() ? "" : ", " + left);
}

Progress::Progress(std::string what,
                   std::int64_t total,
                   ProgressUnit unit,
                   std::int64_t already)
    : what_(std::move(what)),
      total_(total),
      already_(already),
      unit_(unit),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      next_(start_ + std::chrono::milliseconds(500)) {}

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
  if (unit_ == ProgressUnit::kBytes) {
    std::fprintf(stderr,
                 "\r\033[K%s: %d %% of %.1f MB",
                 what_.c_str(),
                 static_cast<int>(100 * done / total_),
                 static_cast<double>(total_) / 1e6);
  } else {
    std::fprintf(stderr,
                 "\r\033[K%s",
                 RunsText(what_, now - start_, already_, done, total_).c_str());
  }
  std::fflush(stderr);
}

}  // namespace waymark
