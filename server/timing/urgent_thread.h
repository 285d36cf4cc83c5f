// SPDX-License-Identifier: MIT
// A thread that keeps time must not queue behind the other programs of a busy machine. One thread.
#pragma once

namespace coopdyn {

class UrgentThread {
 public:
  /// Of the calling thread, which makes all calls.
  UrgentThread();
  /// Set(false).
  ~UrgentThread() { Set(false); }
  UrgentThread(const UrgentThread&) = delete;
  UrgentThread& operator=(const UrgentThread&) = delete;

  /// Ahead of usual programs, or as before. False if the system refuses it; without a change nothing is
  /// asked.
  bool Set(bool urgent);

 private:
  const int usual_;  // nice value
  bool urgent_ = false;
};

}  // namespace coopdyn
