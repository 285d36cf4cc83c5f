// SPDX-License-Identifier: MIT
// What ODE needs of the process and of each thread before anything else is called. Any thread.
#pragma once

#include <stdexcept>
#include <string>

namespace coopdyn {

/// An error inside ODE, which by itself would end the process.
class OdeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes ODE ready for the calling thread: the library once per process, its per-thread data once per thread.
/// From then on ODE's errors and failed assertions throw OdeError out of the ODE function that was called;
/// its messages (the solver's complaints about an ill-posed island) go nowhere: what they do to a body is
/// caught by its speed.
void EnsureOde();

}  // namespace coopdyn
