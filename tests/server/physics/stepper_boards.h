// SPDX-License-Identifier: MIT
// The boards that a stepper works on, and steppers on them, of scenarios with the shipped robots. One thread.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/model/readers.h"
#include "server/physics/stepper.h"
#include "tests/source_dir.h"

namespace coopdyn {

class StepperBoards : public testing::Test {
 protected:
  static std::shared_ptr<const Scenario> Read(const std::string& text) {
    static RobotLibrary robots(SearchPath{{SourceDir()}});
    Diagnostics diagnostics;
    auto scenario = ReadScenario(text, "test.scenario", robots, false, diagnostics);
    EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
    return scenario;
  }
  /// Not yet started. What it is given must outlive it.
  std::unique_ptr<Stepper> MakeStepper(const Clock& clock, const RunOptions& options,
                                       const StepHelpers& helpers = {}) {
    return std::make_unique<Stepper>(Stepper::Boards{frames_, board_, edits_, control_, bell_}, clock,
                                     NullLogger(), options, helpers);
  }

  Doorbell bell_;
  FrameBoard frames_;
  CommandBoard board_;
  EditQueue edits_{bell_};
  RunControl control_;
};

}  // namespace coopdyn
