// SPDX-License-Identifier: MIT
// Where controllers run: in this process or in a child. The stepping thread (holder of the baton) only.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/controllers/shared_layout.h"

namespace coopdyn {

/// An item that took its process with it.
struct Casualty {
  std::uint32_t item = 0;  // robot; of kLoad: file
  std::string why;         // follows "controller NAME "
};

class Backend {
 public:
  virtual ~Backend() = default;
  /// Does the operation, whose serial is in the header, to its end. Items that are not casualties then have
  /// their result in the `out` area. kCreate and kStep may bring casualties that are not among the items.
  virtual std::vector<Casualty> Run(Operation operation, std::span<const std::uint32_t> items) = 0;
  /// No step follows at once: lets go what is held for the next one.
  virtual void Rest() {}
  /// The robot's controller is not needed any more.
  virtual void Drop(std::uint32_t /*robot*/) {}
  /// CPU time used outside this process, s.
  virtual double child_cpu_s() const { return 0; }
  /// The process in which the controllers run; -1: this one, or none now.
  virtual int child_pid() const { return -1; }
};

}  // namespace coopdyn
