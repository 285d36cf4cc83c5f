// SPDX-License-Identifier: MIT
// A recorded lesson to verify, and to change before.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "server/replay/verify.h"
#include "tests/server/record/rechain.h"
#include "tests/server/replay/replay_fixture.h"

namespace coopdyn {

/// Two coopbots that meet, and a crate in between.
inline const char* const kLesson =
    "[CRATE_1]\ntype box\nsize 0.3 0.3 0.3\nposition 0.8 0\nmass 2\n"
    "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
    "[ROBOT_2]\ntype coopbot\nname robot2\nposition 1.6 0\norientation 180deg\n";

class VerifyTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name = "lesson1.run") const { return folder_.File(name); }

  static VerifyReport Repeat(const std::string& file, int threads = 1) {
    std::string error;
    const auto reader = RunReader::Open(file, error);
    EXPECT_NE(reader, nullptr) << error;
    const Repeating repeating(threads);
    return Verify(*reader, repeating.services, nullptr);
  }
  static void ExpectEqual(const std::string& file, std::uint64_t steps) {
    const VerifyReport report = Repeat(file);
    EXPECT_EQ(ToString(report), "equal, " + std::to_string(steps) + " steps\n");
  }
  static VerifyReport Against(const std::string& one, const std::string& other) {
    std::string error;
    const auto first = RunReader::Open(one, error), second = RunReader::Open(other, error);
    EXPECT_TRUE(first != nullptr && second != nullptr) << error;
    const Repeating repeating;
    return Compare(*first, *second, repeating.services, nullptr);
  }

  /// 120 steps with commands that change irregularly.
  void Drive(LiveRun& run, int steps = 120) {
    for (int k = 0; k < steps; ++k) {
      if (k % 7 == 0) run.Command("robot1", 3 + 0.1 * k, 3);
      if (k % 11 == 3) run.Command("robot2", 2, 2 - 0.05 * k);
      run.Step();
    }
  }
  void MakeLesson(const std::string& file) {
    LiveRun run(file, kLesson);
    Drive(run);
  }

  /// A bit past the head, in the middle of the first body's position.
  void FlipKeyframe(std::uint64_t step) {
    const std::string where = " WHERE step = " + std::to_string(step);
    Tamper(File()).FlipBit("SELECT state FROM keyframe" + where, "UPDATE keyframe SET state = ?1" + where,
                           8 * 63);
  }
  /// The repetition of a lesson changed by `sql`.
  VerifyReport Tampered(const std::string& sql) {
    MakeLesson(File());
    Tamper(File()).Run(sql);
    return Repeat(File());
  }
  /// The same for a lesson whose chains were recomputed after the change.
  VerifyReport RecordedAs(const std::string& sql) {
    MakeLesson(File());
    Tamper(File()).Run(sql);
    Rechain(File());
    return Repeat(File());
  }

  TempFolder folder_;
};

}  // namespace coopdyn
