// SPDX-License-Identifier: MIT
// Assigns ports to modules: from the first on, always the lowest free one (docs/protocol.md). Pure; one
// thread.
#pragma once

#include <functional>
#include <set>

namespace coopdyn {

class PortPlan {
 public:
  static constexpr int kLast = 65535;

  /// `first`: the lowest port for modules (P + 2); 0: every module gets any free port. `is_foreign` reports
  /// that a port belongs to another program, e.g. a registered name or, with any_port(), any program; may be
  /// null.
  explicit PortPlan(int first, std::function<bool(int)> is_foreign = nullptr);

  bool any_port() const { return first_ == 0; }
  /// True if the port belongs to another program: Take() skips it.
  bool IsForeign(int port) const { return is_foreign_ && is_foreign_(port); }
  /// Reserves and returns the next port for a module; 0: any free one, or, unless any_port(), none is left.
  int Take();
  /// The system has chosen `port` for a 0 of Take(). With any_port(), the ports after it are tried first from
  /// then on: with thousands of ports in use, the system's search is slow.
  void NoteAny(int port) { next_any_ = port + 1; }
  /// Marks `port` as used by another part of this daemon; ignores 0.
  void Reserve(int port);
  /// The module on `port` is gone: frees the port.
  void Release(int port);

 private:
  int TakeAny();

  int first_;
  std::function<bool(int)> is_foreign_;
  std::set<int> taken_;
  int next_any_ = 0;  // 0: the system chooses
  int lowest_;        // all ports from first_ up to, but not including, this one are taken
};

}  // namespace coopdyn
