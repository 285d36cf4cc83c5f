// SPDX-License-Identifier: MIT
// Runs controllers, in this process or in a child. Used only by the stepping thread (the holder of the
// baton).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/controllers/shared_layout.h"

namespace coopdyn {

/// An item whose controller failed.
struct Casualty {
  std::uint32_t item = 0;  // robot; for kLoad: file
  std::string why;         // follows "controller NAME "
};

class Backend {
 public:
  virtual ~Backend() = default;
  /// Runs the operation, whose serial is in the header, to its end. Then all items except casualties have
  /// their result in the `out` area. kCreate and kStep may return casualties that are not among the items.
  virtual std::vector<Casualty> Run(Operation operation, std::span<const std::uint32_t> items) = 0;
  /// No step follows immediately: releases the resources held for the next one.
  virtual void Rest() {}
  /// The robot's controller is no longer needed.
  virtual void Drop(std::uint32_t /*robot*/) {}
  /// CPU time used outside this process, s.
  virtual double child_cpu_s() const { return 0; }
  /// The process in which the controllers run; -1: this process, or none.
  virtual int child_pid() const { return -1; }
};

}  // namespace coopdyn
