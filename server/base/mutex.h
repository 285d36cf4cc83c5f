// SPDX-License-Identifier: MIT
// std::mutex and a scoped lock with clang's thread-safety annotations, so that the compiler checks
// `GUARDED_BY`. Locks are leaves: no code holds two.
#pragma once

#include <condition_variable>
#include <mutex>

#if defined(__clang__)
#define COOPDYN_ATTRIBUTE(x) __attribute__((x))
#else
#define COOPDYN_ATTRIBUTE(x)
#endif
#define CAPABILITY(x) COOPDYN_ATTRIBUTE(capability(x))
#define SCOPED_CAPABILITY COOPDYN_ATTRIBUTE(scoped_lockable)
#define GUARDED_BY(x) COOPDYN_ATTRIBUTE(guarded_by(x))
#define REQUIRES(...) COOPDYN_ATTRIBUTE(requires_capability(__VA_ARGS__))
#define EXCLUDES(...) COOPDYN_ATTRIBUTE(locks_excluded(__VA_ARGS__))
#define ACQUIRE(...) COOPDYN_ATTRIBUTE(acquire_capability(__VA_ARGS__))
#define RELEASE(...) COOPDYN_ATTRIBUTE(release_capability(__VA_ARGS__))
#define TRY_ACQUIRE(...) COOPDYN_ATTRIBUTE(try_acquire_capability(__VA_ARGS__))
#define NO_THREAD_SAFETY_ANALYSIS COOPDYN_ATTRIBUTE(no_thread_safety_analysis)

namespace coopdyn {

class CAPABILITY("mutex") Mutex {
 public:
  void lock() ACQUIRE() { mutex_.lock(); }
  void unlock() RELEASE() { mutex_.unlock(); }
  bool try_lock() TRY_ACQUIRE(true) { return mutex_.try_lock(); }

 private:
  std::mutex mutex_;
};

class SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  ~MutexLock() RELEASE() { mutex_.unlock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex& mutex_;
};

/// A condition variable for Mutex. Write waits as `while (!condition) cv.Wait(mutex_);`.
class ConditionVariable {
 public:
  void Wait(Mutex& mutex) REQUIRES(mutex) { condition_.wait(mutex); }
  /// Returns false if `deadline` passed first.
  template <typename TimePoint>
  bool WaitUntil(Mutex& mutex, const TimePoint& deadline) REQUIRES(mutex) {
    return condition_.wait_until(mutex, deadline) == std::cv_status::no_timeout;
  }
  void NotifyOne() { condition_.notify_one(); }
  void NotifyAll() { condition_.notify_all(); }

 private:
  std::condition_variable_any condition_;
};

}  // namespace coopdyn
