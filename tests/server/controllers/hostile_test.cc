// SPDX-License-Identifier: MIT
// Whatever a controller does in the child, its robot stops with a reason, and nothing else changes. A
// supervisor that does such things stops alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/base/sanitizers.h"
#include "tests/server/controllers/plugins/deeds.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kVictim = 7;  // index of the robot that misbehaves

/// Samples of all kinds, with one robot among them whose controller does `deed` in step `at`.
Swarm SwarmWith(int deed, int at = 5) {
  Swarm swarm;
  swarm.Mark(3, 1);
  for (std::size_t i = 0; i < 40; ++i) {
    if (i == kVictim) {
      swarm.Add(TestPlugin("hostile"), {{"deed", deed}, {"at", at}});
    } else {
      swarm.Add(Sample(i % 3 == 0 ? "diffuse" : i % 3 == 1 ? "flock" : "braitenberg"));
    }
  }
  return swarm;
}

Record RunFor(const Swarm& swarm, const ControllerOptions& options, int steps = 20) {
  Driven driven(swarm, options);
  driven.Start();
  return driven.Steps(steps);
}

/// The run in which that robot's controller returns a non-finite number.
const Record& Mild() {
  static const Record record = RunFor(SwarmWith(kNotANumber), TestOptions(true));
  return record;
}

struct Case {
  int deed;
  const char* why;  // part of the text
};

class HostileStepTest : public testing::TestWithParam<Case> {};

TEST_P(HostileStepTest, StopsThatRobotOnly) {
  for (const int threads : {1, 3}) {
    ControllerOptions options = TestOptions(false, threads);
    const bool hangs = GetParam().deed == kSleep || GetParam().deed == kSpin;
    options.deadline = (hangs ? 1 : 600) * kNanosecondsPerSecond;  // no other deed must be late
    const Record record = RunFor(SwarmWith(GetParam().deed), options);
    EXPECT_TRUE(record.setpoints == Mild().setpoints) << threads << " threads";
    ASSERT_EQ(record.stopped.size(), 1u);
    EXPECT_EQ(record.stopped[0].robot, "robot8");
    EXPECT_THAT(record.stopped[0].why, HasSubstr("controller hostile "));
    EXPECT_THAT(record.stopped[0].why, HasSubstr(GetParam().why));
    EXPECT_EQ(record.setpoints[19][kVictim], WheelSpeeds{});
  }
}

INSTANTIATE_TEST_SUITE_P(
    Deeds, HostileStepTest,
    testing::Values(Case{kThrowError, "threw an exception in step() (no way??[31mout)"},
                    Case{kThrowInt, "threw an exception in step()"},
                    Case{kDivideByZero, "integer division by zero"}, Case{kNotANumber, "forward_m_s = nan"},
                    Case{kInfinity, "turn_rad_s = inf"},
                    Case{kNotANumberInMessage, "a number in message = nan"},
                    Case{kTooLongMessage, "message_count = 9: at most 8"},
                    Case{kSleep, "did not return within 1 s"}, Case{kSpin, "did not return within 1 s"},
                    Case{kWriteNowhere, "segmentation fault"}, Case{kWritePastCommand, "segmentation fault"},
                    Case{kWriteReadings, "segmentation fault"}, Case{kAbort, "abort"}, Case{kExit, "exit(3)"},
                    Case{kExitAtOnce, "exit(4)"}, Case{kOverflowStack, "segmentation fault"},
                    Case{kKillItself, "killed"}, Case{kSavePastState, "segmentation fault"},
                    Case{kThrowInSave, "threw an exception in save() (no room)"},
                    Case{kShrinkAreas, "forward_m_s = nan"}, Case{kGrowAreas, "forward_m_s = nan"},
                    Case{kWriteInputs, "forward_m_s = nan"}));

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
class LeakTest : public testing::TestWithParam<int> {};

TEST_P(LeakTest, MeetsALimitAndStopsThatRobotOnly) {
  for (const int threads : {1, 3}) {
    ControllerOptions options = TestOptions(false, threads);
    options.memory_bytes = 128u << 20;
    options.deadline = 600 * kNanosecondsPerSecond;
    const Record record = RunFor(SwarmWith(GetParam()), options);
    EXPECT_TRUE(record.setpoints == Mild().setpoints) << threads << " threads";
    ASSERT_EQ(record.stopped.size(), 1u);
    EXPECT_EQ(record.stopped[0].robot, "robot8");
    EXPECT_THAT(record.stopped[0].why, HasSubstr("controller hostile ran out of memory: "));
    EXPECT_THAT(record.stopped[0].why, HasSubstr("may use 128 MiB (serve --controller-memory MIB"));
  }
}

INSTANTIATE_TEST_SUITE_P(Deeds, LeakTest, testing::Values(kLeakWithNew, kLeakWithMalloc));
#endif

class HostileStartTest : public testing::TestWithParam<Case> {};

TEST_P(HostileStartTest, StopsThatRobotOnly) {
  ControllerOptions options = TestOptions();
  options.deadline = kNanosecondsPerSecond;
  const Record record = RunFor(SwarmWith(GetParam().deed), options);
  const Record expected = RunFor(SwarmWith(kRefuse), TestOptions(true));
  EXPECT_TRUE(record.setpoints == expected.setpoints);
  ASSERT_EQ(record.stopped.size(), 1u);
  EXPECT_EQ(record.stopped[0].robot, "robot8");
  EXPECT_THAT(record.stopped[0].why, HasSubstr(GetParam().why));
}

INSTANTIATE_TEST_SUITE_P(Deeds, HostileStartTest,
                         testing::Values(Case{kCrashInCreate, "segmentation fault"},
                                         Case{kThrowInCreate, "threw an exception in create() (no wheels)"},
                                         Case{kRefuse, "cannot drive it: it needs a hat"},
                                         Case{kRefuseSilently, "create() returned NULL"},
                                         Case{kHangInCreate, "did not return within 1 s"},
                                         Case{kCrashInReset, "segmentation fault"}));

TEST(HostileTest, InProcessExceptionsAndNumbersStopThatRobotToo) {
  for (const int deed : {kThrowError, kThrowInt, kInfinity, kTooLongMessage, kThrowInSave}) {
    const Record record = RunFor(SwarmWith(deed), TestOptions(true, 2));
    EXPECT_TRUE(record.setpoints == Mild().setpoints);
    EXPECT_EQ(record.stopped.size(), 1u);
  }
}

TEST(HostileTest, SeveralThatCrashInOneStepAreAllFound) {
  const auto swarm_of = [](int deed) {
    Swarm swarm;
    for (int i = 0; i < 60; ++i) {
      if (i % 10 == 4) {
        swarm.Add(TestPlugin("hostile"), {{"deed", deed}});
      } else {
        swarm.Add(Sample("diffuse"));
      }
    }
    return swarm;
  };
  const Record expected = RunFor(swarm_of(kNotANumber), TestOptions(true));
  ASSERT_EQ(expected.stopped.size(), 6u);
  for (const int threads : {1, 2, 4}) {
    const Record record = RunFor(swarm_of(kDivideByZero), TestOptions(false, threads));
    EXPECT_TRUE(record.setpoints == expected.setpoints) << threads << " threads";
    EXPECT_EQ(record.stopped.size(), 6u) << threads << " threads";
  }
}

TEST(HostileTest, OneThatCrashesOnAllRobotsIsGivenUpAfterSome) {
  for (const int deed : {kDivideByZero, kCrashInCreate}) {
    Swarm swarm;
    for (int i = 0; i < 100; ++i) swarm.Add(TestPlugin("hostile"), {{"deed", deed}});
    swarm.Add(Sample("diffuse"));
    const Record record = RunFor(swarm, TestOptions(false, 2), 10);
    ASSERT_EQ(record.stopped.size(), 100u);
    EXPECT_THAT(record.stopped.back().why, HasSubstr("is stopped on all robots: on 16 it crashed"));
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(record.setpoints[9][i], WheelSpeeds{});
    EXPECT_NE(record.setpoints[9][100], WheelSpeeds{});
  }
}

TEST(HostileTest, ACrashInRestoreStopsThatRobotToo) {
  for (const int deed : {kCrashInRestore, kThrowInRestore}) {
    Swarm swarm;
    for (int i = 0; i < 20; ++i) swarm.Add(Sample("diffuse"));
    swarm.Add(TestPlugin("hostile"), {{"deed", deed}}).Add(TestPlugin("hostile"), {{"deed", kAbort}});
    const Record record = RunFor(swarm, TestOptions());
    ASSERT_EQ(record.stopped.size(), 2u);
    EXPECT_NE(record.stopped[0].robot, record.stopped[1].robot);
    EXPECT_NE(record.setpoints[19][0], WheelSpeeds{});
  }
}

TEST(HostileTest, KilledFromOutsideBetweenStepsNothingIsLost) {
  const Record expected = RunFor(SwarmWith(kNone), TestOptions(true));
  Driven driven(SwarmWith(kNone), TestOptions(false, 2));
  driven.Start();
  for (const int steps : {5, 1, 1, 13}) {
    driven.Steps(steps);
    ASSERT_GT(driven.host().child_pid(), 0);
    kill(driven.host().child_pid(), SIGKILL);
  }
  EXPECT_TRUE(driven.run().setpoints == expected.setpoints);
  EXPECT_TRUE(driven.run().stopped.empty());
}

/// A crash outside of step, create and reset: in a thread started by a controller.
void Crash(Driven& driven) {
  ASSERT_GT(driven.host().child_pid(), 0);
  kill(driven.host().child_pid(), SIGSEGV);
}

TEST(HostileTest, CrashesOverAndOverWithNobodyToBlameStopAllInTheEnd) {
  Driven driven(SwarmWith(kNone), TestOptions(false, 2));
  driven.Start();
  for (int k = 0; k < 8; ++k) {
    driven.Steps(1);
    Crash(driven);
  }
  driven.Steps(1);
  EXPECT_TRUE(driven.run().stopped.empty());
  Crash(driven);
  driven.Steps(1);
  ASSERT_EQ(driven.run().stopped.size(), 40u);
  EXPECT_THAT(driven.run().stopped[0].why, HasSubstr("could not go on: its process crashed (segmentation"));
  EXPECT_THAT(driven.run().stopped[0].why, HasSubstr("9 times and no controller was to blame"));
  driven.Steps(3);
  EXPECT_EQ(driven.run().setpoints.back(), std::vector<WheelSpeeds>(40));
}

TEST(HostileTest, CrashesFarApartWithNobodyToBlameAreGotOver) {
  Driven driven(SwarmWith(kNone), TestOptions(false));
  driven.Start();
  for (int k = 0; k < 10; ++k) {
    driven.Steps(101);
    Crash(driven);
  }
  driven.Steps(1);
  EXPECT_TRUE(driven.run().stopped.empty());
}

TEST(HostileTest, KilledFromOutsideInAStepNothingIsLost) {
  const std::string marker = testing::TempDir() + "hostile_marker_" + std::to_string(getpid());
  setenv("HOSTILE_MARKER", marker.c_str(), 1);
  const Record expected = RunFor(SwarmWith(kNone), TestOptions(true));
  for (const int threads : {1, 4}) {
    std::ofstream(marker) << "not yet";
    const Record record = RunFor(SwarmWith(kKillOnce), TestOptions(false, threads));
    EXPECT_FALSE(std::ifstream(marker).good()) << "it was not killed";
    EXPECT_TRUE(record.setpoints == expected.setpoints);
    EXPECT_TRUE(record.stopped.empty());
  }
}

TEST(HostileTest, ItsCpuTimeCountsEvenWhenItIsDead) {
  Driven driven(SwarmWith(kNone));
  driven.Start();
  driven.Steps(5);
  const double before_s = driven.host().child_cpu_s();
  EXPECT_GT(before_s, 0);
  kill(driven.host().child_pid(), SIGKILL);
  driven.Steps(5);
  EXPECT_GT(driven.host().child_cpu_s(), before_s);
}

TEST(HostileTest, OneThatOverwritesItsOutputsWithoutEndIsStopped) {
  for (const int deed : {kOverwriteOutputs, kOverwriteOutputsBeside}) {
    for (const int threads : {1, 3}) {
      ControllerOptions options = TestOptions(false, threads);
      options.deadline = kNanosecondsPerSecond / 4;
      const Record record = RunFor(SwarmWith(deed), options);
      ASSERT_FALSE(record.stopped.empty());
      EXPECT_EQ(record.setpoints[19][kVictim], WheelSpeeds{});
      if (deed == kOverwriteOutputs) {
        EXPECT_THAT(record.stopped[0].why, HasSubstr("had its state overwritten by another controller"));
      }
    }
  }
}

TEST(HostileTest, ACopyOfTheProcessIsGoneBeforeItDoesAnything) {
  const Record record = RunFor(SwarmWith(kFork), TestOptions(false));
  EXPECT_TRUE(record.stopped.empty());
  EXPECT_TRUE(record.setpoints == RunFor(SwarmWith(kNone), TestOptions(false)).setpoints);
}

TEST(HostileTest, AnInterruptEndsTheWaitForOneThatHangs) {
  ControllerOptions options = TestOptions(false, 2);
  options.deadline = 0;  // none
  Driven driven(SwarmWith(kSpin, 2), options);
  driven.Start();
  driven.Steps(2);
  {
    std::jthread other([&driven] { driven.host().Interrupt(); });
    driven.Steps(1);
  }
  EXPECT_FALSE(driven.run().stopped.empty());
  EXPECT_EQ(driven.run().setpoints[2][kVictim], WheelSpeeds{});
}

TEST(HostileTest, WhatEndsWithTheDaemonHasNotFailed) {
  ControllerOptions options = TestOptions(false, 2);
  options.deadline = 0;  // none
  Driven driven(SwarmWith(kSpin, 0), options);
  driven.Start();
  driven.host().Interrupt();
  driven.Steps(1);
  ASSERT_FALSE(driven.run().stopped.empty());
  for (const StoppedController& stopped : driven.run().stopped) EXPECT_TRUE(stopped.with_daemon);
}

TEST(HostileTest, WhatFailsBeforeTheDaemonEndsHasFailed) {
  const Record record = RunFor(SwarmWith(kNotANumber), TestOptions());
  ASSERT_FALSE(record.stopped.empty());
  EXPECT_FALSE(record.stopped[0].with_daemon);
}

TEST(HostileTest, AProcessThatOnlyKeepsSilentIsNotSaidToHaveMissedADeadline) {
  std::ostringstream said;
  auto logger =
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(said));
  ControllerOptions options = TestOptions();
  options.silence = 2 * kNanosecondsPerSecond;
  Driven driven(SwarmWith(kNone), options, logger);
  driven.Start();
  kill(driven.host().child_pid(), SIGSTOP);
  driven.Steps(1);
  EXPECT_TRUE(driven.run().stopped.empty());
  EXPECT_THAT(said.str(), HasSubstr("gave no answer for 2 s"));
  EXPECT_THAT(said.str(), Not(HasSubstr("did not return")));
}

TEST(HostileTest, SignalsToAllProcessesOfAJobAreLeftToTheDaemon) {
  Driven driven(SwarmWith(kNone), TestOptions());
  driven.Start();
  const int pid = driven.host().child_pid();
  for (const int signal : {SIGUSR1, SIGINT, SIGHUP, SIGTERM}) {
    kill(pid, signal);
    driven.Steps(1);
  }
  EXPECT_EQ(driven.host().child_pid(), pid);
  EXPECT_TRUE(driven.run().stopped.empty());
}

TEST(HostileTest, AHangInDestroyDoesNotHoldUpTheEnd) {
  Driven driven(SwarmWith(kHangInDestroy));
  driven.Start();
  driven.Steps(2);
  driven.Start();  // ends the first process, and at the end of this scope the second
  EXPECT_TRUE(driven.run().stopped.empty());
}

struct SupervisorCase {
  int deed;
  const char* why;  // part of the text
};

class HostileSupervisorTest : public testing::TestWithParam<SupervisorCase> {};

TEST_P(HostileSupervisorTest, StopsAloneAndTheRobotsGoOn) {
  const Record expected = [] {
    Driven driven(Supervised(kWatches));
    driven.Start();
    return driven.Steps(10);
  }();
  ControllerOptions options = TestOptions();
  options.deadline = kNanosecondsPerSecond;
  Driven driven(Supervised(GetParam().deed, 4), options);
  driven.Start();
  const Record& run = driven.Steps(10);
  EXPECT_TRUE(run.setpoints == expected.setpoints);
  ASSERT_EQ(run.stopped.size(), 1u);
  EXPECT_EQ(run.stopped[0].robot, "supervisor overseer");
  EXPECT_THAT(run.stopped[0].why, HasSubstr("controller overseer "));
  EXPECT_THAT(run.stopped[0].why, HasSubstr(GetParam().why));
  for (const Supervision& supervision : run.supervision) EXPECT_TRUE(supervision.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Deeds, HostileSupervisorTest,
    testing::Values(SupervisorCase{kMovesTooMany, "moves 4097 things in one step: at most 4096"},
                    SupervisorCase{kMovesToNowhere, "to nan 0 0"},
                    SupervisorCase{kTurnsWrongly, "a quaternion has length 1"},
                    SupervisorCase{kLogsTooMuch, "logged 17 numbers in one step: at most 16"},
                    SupervisorCase{kLogsNotANumber, "logged energy = nan: it must be a finite number"},
                    SupervisorCase{kLogsUnderABadName, "logged 'my energy': a name is a letter"},
                    SupervisorCase{kLogsUnderALongName, "at most 63"},
                    SupervisorCase{kOtherSupervision, "changed a pointer"},
                    SupervisorCase{kOtherMoves, "changed a pointer"},
                    SupervisorCase{kOtherLogs, "changed a pointer"},
                    SupervisorCase{kWritesPastMoves, "segmentation fault"},
                    SupervisorCase{kWritesPastLogs, "segmentation fault"},
                    SupervisorCase{kWritesWorld, "segmentation fault"},
                    SupervisorCase{kOverseerThrows, "threw an exception in step() (no whistle)"},
                    SupervisorCase{kOverseerCrashes, "abort"},
                    SupervisorCase{kOverseerHangs, "did not return within 1 s"}));

}  // namespace
}  // namespace coopdyn
