// SPDX-License-Identifier: MIT
#include "server/record/recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <atomic>
#include <future>

#include "record_fixture.h"
#include "server/record/state_codec.h"

namespace coopdyn {
namespace {

/// The recorder asks for the time after each step that it writes: a closed gate holds it there.
class GateClock final : public Clock {
 public:
  Nanoseconds Now() const override {
    const MutexLock lock(mutex_);
    ++waiting_;
    changed_.NotifyAll();
    while (closed_) changed_.Wait(mutex_);
    --waiting_;
    return now_;
  }
  void CloseGate() {
    const MutexLock lock(mutex_);
    closed_ = true;
  }
  void OpenGate() {
    const MutexLock lock(mutex_);
    closed_ = false;
    changed_.NotifyAll();
  }
  /// Returns when somebody stands at the closed gate.
  void AwaitWaiter() {
    const MutexLock lock(mutex_);
    while (waiting_ == 0) changed_.Wait(mutex_);
  }
  void Advance(Nanoseconds by) {
    const MutexLock lock(mutex_);
    now_ += by;
  }

 private:
  mutable Mutex mutex_;
  mutable ConditionVariable changed_;
  mutable int waiting_ GUARDED_BY(mutex_) = 0;
  bool closed_ GUARDED_BY(mutex_) = false;
  Nanoseconds now_ GUARDED_BY(mutex_) = 0;
};

class RecorderTest : public testing::Test {
 protected:
  RecorderOptions Options() {
    RecorderOptions options;
    options.file = file_;
    options.version = "1.2.3";
    options.what = RecordWhat();
    options.commit_every = 0;  // at once
    return options;
  }
  /// As the stepping thread does.
  void Step(Recorder& recorder, std::uint64_t step, Mode mode) {
    recorder.Step(maker_.Make(step), mode, recorder.WantsKeyframe(step), {});
  }
  /// Begins a run, writes step 1, and holds the recorder there: what comes now waits in the queue.
  void BeginAndHold(Recorder& recorder, Mode mode) {
    clock_.CloseGate();
    recorder.Begin(maker_.Start());
    while (recorder.status().file.empty()) std::this_thread::yield();
    Step(recorder, 1, mode);
    clock_.AwaitWaiter();
  }
  /// Bytes of a queue with room for so many steps.
  std::size_t RoomFor(std::size_t steps) {
    const auto frame = maker_.Make(0);
    const std::size_t bytes =
        sizeof(Frame) + frame->bodies.size() * sizeof(BodyState) + frame->robots.size() * sizeof(RobotState);
    return steps * bytes + bytes / 2;
  }

  TestFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  FrameMaker maker_{RecordScene()};
  GateClock clock_;
};

TEST_F(RecorderTest, ARunIsRecordedFromBeginToClose) {
  Recorder recorder(Options(), clock_, NullLogger());
  EXPECT_EQ(recorder.Check(), "");
  recorder.Begin(maker_.Start());
  for (std::uint64_t step = 1; step <= 100; ++step) Step(recorder, step, Mode::kLockstep);
  recorder.Input({100, "stop_all", ""});
  recorder.Note({100, 1.0, "note", "here it is"});
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 101);
  EXPECT_EQ(Ask(file_, "SELECT step FROM input WHERE action = 'stop_all'"), 100);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event WHERE level = 'note'"), "here it is");
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
  EXPECT_EQ(AskText(file_, "SELECT value FROM meta WHERE key = 'build'").size(), 16U);
  const RecorderStatus status = recorder.status();
  EXPECT_EQ(status.file, file_);
  EXPECT_EQ(status.steps, 100U);
  EXPECT_EQ(status.lost, 0U);
  EXPECT_EQ(status.begin, 0);
  EXPECT_EQ(status.end, 1'000'000'000);
  EXPECT_EQ(status.bytes, std::filesystem::file_size(file_));
  EXPECT_EQ(status.failure, "");
  EXPECT_GT(status.cpu_s, 0);
}

TEST_F(RecorderTest, WithoutBeginNothingIsWritten) {
  {
    Recorder recorder(Options(), clock_, NullLogger());
    EXPECT_FALSE(recorder.WantsKeyframe(1));
    recorder.Step(maker_.Make(1), Mode::kLockstep, false, {});
    recorder.Note({1, 0.01, "info", "nobody hears"});
  }
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(RecorderTest, KeyframesComeAtTheStartAndEverySoManySteps) {
  RecorderOptions options = Options();
  options.keyframe_steps = 50;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start(7));
  for (std::uint64_t step = 8; step <= 157; ++step) Step(recorder, step, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM keyframe"), "7,57,107,157");
}

TEST_F(RecorderTest, AKeyframeHasTheControllersAndTheMode) {
  RecorderOptions options = Options();
  options.keyframe_steps = 1;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  const auto frame = maker_.Make(1);
  ASSERT_TRUE(recorder.WantsKeyframe(1));
  recorder.Step(frame, Mode::kFree, true, {std::byte{42}});
  recorder.Close();
  std::string error;
  const auto database = Database::Open(file_, Database::Access::kReadOnly, error);
  Statement row = database->Prepare("SELECT state FROM keyframe WHERE step = 1");
  ASSERT_EQ(row.Step(), Statement::Result::kRow);
  const SavedStatePtr state = DecodeState(row.blob(0), maker_.scene());
  ASSERT_NE(state, nullptr);
  EXPECT_EQ(state->controllers, std::vector<std::byte>{std::byte{42}});
  EXPECT_EQ(state->mode, Mode::kFree);
  EXPECT_EQ(StateHash(*state->frame), StateHash(*frame));
}

TEST_F(RecorderTest, EachLaterBeginGoesOnInANumberedFile) {
  Recorder recorder(Options(), clock_, NullLogger());
  for (int run = 0; run < 3; ++run) {
    recorder.Begin(maker_.Start());
    for (int step = 1; step <= run + 1; ++step) {
      Step(recorder, static_cast<std::uint64_t>(step), Mode::kRealtime);
    }
  }
  recorder.Close();
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-3.run"));
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_EQ(Ask(folder_.File("lesson1-2.run"), "SELECT count(*) FROM step"), 3);
  EXPECT_EQ(Ask(folder_.File("lesson1-3.run"), "SELECT count(*) FROM step"), 4);
  EXPECT_EQ(Ask(folder_.File("lesson1-2.run"), "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

TEST_F(RecorderTest, NumbersThatAreTakenAreLeftAlone) {
  const std::string taken = folder_.File("lesson1-2.run");
  { const auto old = MakeWriter(taken, *maker_.Start(100)); }
  Recorder recorder(Options(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kLockstep);
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-3.run"));
  EXPECT_EQ(Ask(taken, "SELECT step FROM step"), 100);
}

TEST_F(RecorderTest, APartSaysWhereTheRunGoesOn) {
  Recorder recorder(Options(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kLockstep);
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event WHERE text LIKE '%begins anew in %lesson1-2.run'"), 1);
}

TEST_F(RecorderTest, APartWithoutStepsGivesItsNameToTheNext) {
  Recorder recorder(Options(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(recorder.status().file, file_);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("lesson1-2.run")));
}

TEST_F(RecorderTest, ANoteIsNotDroppedWithAPartWithoutSteps) {
  Recorder recorder(Options(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  recorder.Note({0, 0, "note", "look here"});
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event WHERE level = 'note'"), 1);
}

TEST_F(RecorderTest, AFileThatAnotherProgramRecordsIsNotOverwritten) {
  const auto other = MakeWriter(file_, *maker_.Start());
  ASSERT_TRUE(other->Commit());
  RecorderOptions options = Options();
  options.overwrite = true;
  std::string said;
  options.on_failure = [&said](const std::string& text) { said = text; };
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_NE(said.find("is being recorded by another program"), std::string::npos) << said;
}

TEST_F(RecorderTest, AnExistingFileIsToldBeforeTheRun) {
  { const auto old = MakeWriter(file_, *maker_.Start()); }
  EXPECT_EQ(Recorder(Options(), clock_, NullLogger()).Check(),
            file_ + " exists: choose another name, or --force");
  RecorderOptions options = Options();
  options.overwrite = true;
  EXPECT_EQ(Recorder(options, clock_, NullLogger()).Check(), "");
  options.file = folder_.File("nowhere/lesson1.run");
  EXPECT_EQ(Recorder(options, clock_, NullLogger()).Check(),
            "cannot make " + options.file + ": No such file or directory");
}

TEST_F(RecorderTest, InLockstepAFullQueueSlowsTheRunAndNothingIsLost) {
  RecorderOptions options = Options();
  options.max_queue_bytes = RoomFor(3);
  Recorder recorder(options, clock_, NullLogger());
  BeginAndHold(recorder, Mode::kLockstep);
  std::atomic<std::uint64_t> stepped{1};
  std::promise<void> full;
  auto run = std::async(std::launch::async, [&] {
    for (std::uint64_t step = 2; step <= 50; ++step) {
      Step(recorder, step, Mode::kLockstep);
      stepped = step;
      if (step == 4) full.set_value();
    }
  });
  full.get_future().wait();
  EXPECT_LE(stepped, 4U);  // the fifth waits for room
  clock_.OpenGate();
  run.get();
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 51);
  EXPECT_EQ(recorder.status().lost, 0U);
}

TEST_F(RecorderTest, InRealTimeAFullQueueLosesStepsAndTheNextIsAKeyframe) {
  RecorderOptions options = Options();
  options.max_queue_bytes = RoomFor(4);
  Recorder recorder(options, clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  for (std::uint64_t step = 2; step <= 11; ++step) Step(recorder, step, Mode::kRealtime);
  EXPECT_EQ(recorder.status().lost, 6U);
  EXPECT_FALSE(recorder.WantsKeyframe(12));  // there is no room for it yet
  recorder.Input({11, "stop_all", ""});      // is never lost
  clock_.OpenGate();
  while (!recorder.WantsKeyframe(12)) std::this_thread::yield();
  Step(recorder, 12, Mode::kRealtime);
  Step(recorder, 13, Mode::kRealtime);
  recorder.Close();
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM step"), "0,1,2,3,4,5,12,13");
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM keyframe"), "0,12");
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), 6);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event WHERE level = 'warning' AND step = 12"),
            "6 steps were not recorded: the disk did not keep up");
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM input"), 1);
}

TEST_F(RecorderTest, StepsLostAtTheEndAreSaidToo) {
  RecorderOptions options = Options();
  options.max_queue_bytes = RoomFor(1);
  Recorder recorder(options, clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  for (std::uint64_t step = 2; step <= 3; ++step) Step(recorder, step, Mode::kRealtime);
  clock_.OpenGate();
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), 1);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event"), "1 step was not recorded: the disk did not keep up");
}

TEST_F(RecorderTest, WhatIsOlderThanTheCommitIntervalIsSafe) {
  RecorderOptions options = Options();
  options.commit_every = 200'000'000;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kRealtime);
  while (recorder.status().steps < 1) std::this_thread::yield();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 1);
  clock_.Advance(200'000'000);  // nothing more comes: the recorder looks at the clock by itself
  while (Ask(file_, "SELECT count(*) FROM step") < 2) std::this_thread::yield();
  recorder.Close();
}

TEST_F(RecorderTest, ALockstepRunWaitingForRoomIsReleasedByAFailure) {
  // The second file cannot be made: its name is that of a folder.
  RecorderOptions options = Options();
  options.overwrite = true;
  options.max_queue_bytes = RoomFor(1);
  std::atomic<int> failures{0};
  std::string said;
  options.on_failure = [&](const std::string& text) {
    said = text;
    ++failures;
  };
  std::filesystem::create_directory(folder_.File("lesson1-2.run"));
  Recorder recorder(options, clock_, NullLogger());
  BeginAndHold(recorder, Mode::kLockstep);
  auto run = std::async(std::launch::async, [&] {
    recorder.Begin(maker_.Start());
    for (std::uint64_t step = 1; step <= 50; ++step) Step(recorder, step, Mode::kLockstep);
  });
  clock_.OpenGate();
  run.get();
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(failures, 1);
  EXPECT_NE(said.find("lesson1-2.run is no file: choose another name"), std::string::npos) << said;
  EXPECT_EQ(recorder.status().failure, said);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

/// This process has it open.
bool IsOpen(const std::string& file) {
  for (const auto& descriptor : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (std::filesystem::read_symlink(descriptor, gone) == std::filesystem::path(file)) return true;
  }
  return false;
}

/// In a child process, whose files may not grow beyond 300 kB. Its exit code is what failed; 0: nothing.
int RecordWithinLimit(const RecorderOptions& base, FrameMaker& maker) {
  const rlimit limit{300'000, 300'000};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
  RecorderOptions options = base;
  std::atomic<int> failures{0};
  std::atomic<bool> told_before_close{false};
  options.on_failure = [&](const std::string&) {
    ++failures;
    told_before_close = IsOpen(options.file);
  };
  const SteadyClock clock;
  Recorder recorder(options, clock, NullLogger());
  recorder.Begin(maker.Start());
  for (std::uint64_t step = 1; step <= 5000; ++step) {
    recorder.Step(maker.Make(step), Mode::kLockstep, recorder.WantsKeyframe(step), {});
  }
  recorder.Close();
  const std::string failure = recorder.status().failure;
  if (failures != 1) return 3;
  if (!told_before_close) return 6;
  if (failure.find("(File too large); ") == std::string::npos) return 4;
  if (failure.find("lesson1.run holds the run up to ") == std::string::npos) return 5;
  return 0;
}

TEST_F(RecorderTest, AFileThatMayNotGrowEndsTheRecordingNotTheProcess) {
  const RecorderOptions options = Options();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(RecordWithinLimit(options, maker_));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  // What was committed can be read.
  EXPECT_GT(Ask(file_, "SELECT count(*) FROM step"), 10);
  EXPECT_EQ(AskText(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(RecorderTest, AKilledProcessLeavesWhatWasCommitted) {
  const RecorderOptions options = Options();
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const SteadyClock clock;
    Recorder recorder(options, clock, NullLogger());
    recorder.Begin(maker_.Start());
    for (std::uint64_t step = 1; step <= 30; ++step) Step(recorder, step, Mode::kLockstep);
    while (recorder.status().steps < 29) std::this_thread::yield();
    const char done = 1;
    if (::write(pipe[1], &done, 1) != 1) ::_exit(1);
    for (std::uint64_t step = 31;; ++step) Step(recorder, step, Mode::kLockstep);
  }
  char done = 0;
  ASSERT_EQ(::read(pipe[0], &done, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ::close(pipe[0]);
  ::close(pipe[1]);
  EXPECT_GE(Ask(file_, "SELECT count(*) FROM step"), 29);
  EXPECT_EQ(AskText(file_, "PRAGMA integrity_check"), "ok");
}

}  // namespace
}  // namespace coopdyn
