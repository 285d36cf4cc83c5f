// SPDX-License-Identifier: MIT
// Which port a module gets: from the first on, each the lowest that is free (docs/protocol.md). Pure; one
// thread.
#pragma once

#include <functional>
#include <set>

namespace coopdyn {

class PortPlan {
 public:
  static constexpr int kLast = 65535;

  /// `first`: the lowest port for modules (P + 2); 0: every module gets any free port.
  /// `is_foreign` says that a port belongs to somebody else, e.g. a registered name or, with any_port(), any
  /// program; may be null.
  explicit PortPlan(int first, std::function<bool(int)> is_foreign = nullptr);

  bool any_port() const { return first_ == 0; }
  /// It belongs to somebody else: Take() leaves it out.
  bool IsForeign(int port) const { return is_foreign_ && is_foreign_(port); }
  /// The next port for a module, which is then taken; 0: any free one, or (any_port() is false) none is left.
  int Take();
  /// The system has chosen `port` for a 0 of Take(). With any_port() the next ones are tried first then: with
  /// thousands of ports in use, the system searches long for each.
  void NoteAny(int port) { next_any_ = port + 1; }
  /// Says that `port` is used by something else in this daemon; 0 says nothing.
  void Reserve(int port);
  /// The module on `port` is gone.
  void Release(int port);

 private:
  int TakeAny();

  int first_;
  std::function<bool(int)> is_foreign_;
  std::set<int> taken_;
  int next_any_ = 0;  // 0: the system chooses
  int lowest_;        // all ports from first_ up to here, not including it, are taken
};

}  // namespace coopdyn
