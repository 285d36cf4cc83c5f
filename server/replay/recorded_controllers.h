// SPDX-License-Identifier: MIT
// Stands in for loaded controllers that are not to be had: a repetition with it takes the set-points and
// broadcasts of their robots from the recording, as it does for clients' robots. Holder of the step only.
#pragma once

#include <vector>

#include "server/state/controller_driver.h"

namespace coopdyn {

/// Leaves all set-points as they are given, sends nothing, saves nothing.
class RecordedControllers final : public ControllerDriver {
 public:
  void Check(const Scenario&, Diagnostics&) override {}
  void Configure(const FramePtr&) override {}
  void Step(const FramePtr&, std::span<Setpoint>, std::vector<SentMessage>&) override {}
  std::vector<std::byte> Save() const override { return {}; }
  bool Restore(const FramePtr&, std::span<const std::byte>) override { return true; }
  std::vector<int> Unloaded() const override { return {}; }
  void Stop(int, const std::string&) override {}
  void Unload(int) override {}
  std::vector<StoppedController> TakeStopped() override { return {}; }
  PhaseTimes times() const override { return {}; }
  double child_cpu_s() const override { return 0; }
};

}  // namespace coopdyn
