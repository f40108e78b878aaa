// std::mutex with clang's thread-safety annotations (-Wthread-safety).
#pragma once

#include <mutex>

#if defined(__clang__)
#define WAYMARK_THREAD_ATTRIBUTE(x) __attribute__((x))
#else
#define WAYMARK_THREAD_ATTRIBUTE(x)
#endif
#define WAYMARK_GUARDED_BY(x) WAYMARK_THREAD_ATTRIBUTE(guarded_by(x))
#define WAYMARK_REQUIRES(x) WAYMARK_THREAD_ATTRIBUTE(requires_capability(x))

namespace waymark {

class WAYMARK_THREAD_ATTRIBUTE(capability("mutex")) Mutex {
 public:
  void Lock() WAYMARK_THREAD_ATTRIBUTE(acquire_capability()) { mutex_.lock(); }
  void Unlock() WAYMARK_THREAD_ATTRIBUTE(release_capability()) {
    mutex_.unlock();
  }

 private:
  std::mutex mutex_;
};

class WAYMARK_THREAD_ATTRIBUTE(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex* mutex)
      WAYMARK_THREAD_ATTRIBUTE(acquire_capability(mutex))
      : mutex_(mutex) {
    mutex_->Lock();
  }
  ~MutexLock() WAYMARK_THREAD_ATTRIBUTE(release_capability()) {
    mutex_->Unlock();
  }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex* mutex_;
};

}  // namespace waymark
