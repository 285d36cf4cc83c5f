// SPDX-License-Identifier: MIT
// The recording that remains when the file may not grow or the process is killed.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <stdexcept>

#include "recorder_fixture.h"
#include "server/record/run_chain.h"
#include "server/record/run_reader.h"

namespace coopdyn {
namespace {

/// Whether this process has the file open.
bool IsOpen(const std::string& file) {
  for (const auto& descriptor : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (std::filesystem::read_symlink(descriptor, gone) == std::filesystem::path(file)) return true;
  }
  return false;
}

/// Runs `what` in a child process, whose files may not grow beyond 300 kB. Its exit code says what failed; 0:
/// nothing.
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
    const FramePtr frame = maker.Make(step);
    recorder.Step(frame, Mode::kLockstep, ExactIf(recorder.WantsKeyframe(step), frame, Mode::kLockstep), 0);
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
  // Committed data can be read.
  EXPECT_GT(Ask(file_, "SELECT count(*) FROM step"), 10);
  EXPECT_EQ(AskText(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(RecorderTest, WhatItsThreadThrowsEndsTheRecordingNotTheProcess) {
  RecorderOptions options = Options();
  class Thrower final : public Clock {
    Nanoseconds Now() const override { throw std::runtime_error("no more memory"); }
  } thrower;
  std::string told;
  options.on_failure = [&told](const std::string& text) { told = text; };
  Recorder recorder(options, thrower, NullLogger());
  recorder.Begin(maker_.Start());
  Steps(recorder, 1, 300, Mode::kLockstep);  // nobody waits for room
  recorder.Close();
  EXPECT_EQ(told.find("the recording ends: no more memory; "), 0u) << told;
  EXPECT_EQ(recorder.status().failure, told);
}

/// During its lifetime no file can grow beyond `bytes`, as on a full disk.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit before_{};
};

class FullDiskTest : public RecorderTest {
 protected:
  RecorderOptions Watched() {
    RecorderOptions options = Options();
    options.max_queue_bytes = std::size_t{1} << 16;
    options.free_bytes = [](const std::string&) { return std::uint64_t{1} << 40; };
    options.on_stall = [this](const std::string&) { ++stalls_; };
    options.on_room = [this](const std::string&) { ++rooms_; };
    options.on_failure = [this](const std::string&) { ++failures_; };
    return options;
  }
  /// Steps until the disk is full; returns the number of the last step.
  std::uint64_t StepUntilFull(Recorder& recorder, std::uint64_t step) {
    while (recorder.status().stall.empty()) Step(recorder, ++step, Mode::kLockstep);
    return step;
  }
  void AwaitRoom(Recorder& recorder) {
    const int before = rooms_;
    while (rooms_ == before) {
      clock_.Advance(kNanosecondsPerSecond);
      std::this_thread::yield();
    }
    EXPECT_EQ(recorder.status().stall, "");
  }
  /// Checks that the file has the written rows, and that missing ones were reported.
  void ExpectSound(const std::string& file) {
    std::string error, ends;
    const auto chain = RunChain::Open(file, error);
    ASSERT_NE(chain, nullptr) << error;
    EXPECT_EQ(chain->CheckHead(), "");
    EXPECT_FALSE(chain->CheckRest(ends)) << file;
    EXPECT_EQ(ends, "");
    EXPECT_EQ(Ask(file, "SELECT value FROM meta WHERE key = 'closed'"), 1);
    EXPECT_EQ(
        Ask(file, "SELECT max(step) - min(step) + 1 - count(*) FROM step"),
        Ask(file,
            "SELECT sum(CASE key WHEN 'lost' THEN value ELSE -value END) FROM meta WHERE key IN ('lost', "
            "'lost_after')"));
  }

  std::atomic<int> stalls_{0}, rooms_{0}, failures_{0};
};

TEST_F(FullDiskTest, TheRecordingGoesOnWhenThereIsRoomAgain) {
  Recorder recorder(Watched(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  std::uint64_t step = 0;
  {
    const SmallDisk full(300'000);
    step = StepUntilFull(recorder, step);
    Steps(recorder, step + 1, step + 20, Mode::kLockstep);  // nobody waits
    step += 20;
    recorder.Note({step, 0.01 * static_cast<double>(step), "note", "still here"});
  }
  EXPECT_GE(recorder.status().lost, 20U);
  AwaitRoom(recorder);
  Steps(recorder, step + 1, step + 30, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(stalls_, 1);
  EXPECT_EQ(failures_, 0);
  const RecorderStatus status = recorder.status();
  EXPECT_EQ(status.failure, "");
  ExpectSound(file_);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), static_cast<std::int64_t>(status.lost));
  EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), static_cast<std::int64_t>(step + 30));
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM keyframe WHERE step = " + std::to_string(step + 1)), 1)
      << "what follows can be verified";
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event WHERE text = 'still here'"), 1);
  EXPECT_EQ(AskText(file_, "SELECT text FROM event WHERE level = 'warning'"),
            std::to_string(status.lost) + " steps were not recorded: there was no room for them");
}

TEST_F(FullDiskTest, WhatWasLostAtTheEndIsSaidInTheFile) {
  Recorder recorder(Watched(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  {
    const SmallDisk full(300'000);
    const std::uint64_t step = StepUntilFull(recorder, 0);
    Steps(recorder, step + 1, step + 5, Mode::kLockstep);
    recorder.Close();
  }
  EXPECT_EQ(failures_, 1);
  const RecorderStatus status = recorder.status();
  EXPECT_NE(status.failure.find("the recording ends: "), std::string::npos) << status.failure;
  ExpectSound(file_);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost_after'"),
            static_cast<std::int64_t>(status.lost));
  std::string error;
  const auto reader = RunReader::Open(file_, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_EQ(reader->extent().lost_after, status.lost);
}

TEST_F(FullDiskTest, ARunThatBeginsAnewMeanwhileGetsItsFileLater) {
  Recorder recorder(Watched(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  {
    const SmallDisk full(300'000);
    const std::uint64_t step = StepUntilFull(recorder, 0);
    Steps(recorder, step + 1, step + 5, Mode::kLockstep);
    for (int again = 0; again < 3; ++again) {
      recorder.Begin(maker_.Start());
      Steps(recorder, 1, 10, Mode::kLockstep);
    }
  }
  AwaitRoom(recorder);
  Steps(recorder, 11, 20, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(failures_, 0);
  const std::string last = recorder.status().file;
  EXPECT_EQ(last, folder_.File("lesson1-4.run"));
  for (const std::string& file : {file_, last}) ExpectSound(file);
  EXPECT_GT(Ask(file_, "SELECT value FROM meta WHERE key = 'lost_after'"), 4);
  EXPECT_EQ(Ask(last, "SELECT value FROM meta WHERE key = 'lost'"), 10);
  EXPECT_EQ(Ask(last, "SELECT count(*) FROM step"), 11);
}

TEST_F(FullDiskTest, ItIsNotTriedBeforeTheDiskHasRoom) {
  RecorderOptions options = Watched();
  std::atomic<std::uint64_t> free{0};
  options.free_bytes = [&free](const std::string&) { return free.load(); };
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  std::uint64_t step = 0;
  {
    const SmallDisk full(300'000);
    step = StepUntilFull(recorder, 0);
  }
  for (int k = 0; k < 5; ++k) {
    clock_.Advance(kNanosecondsPerSecond);
    Step(recorder, ++step, Mode::kLockstep);
  }
  EXPECT_EQ(rooms_, 0);
  free = options.room_bytes;
  AwaitRoom(recorder);
  Step(recorder, ++step, Mode::kLockstep);
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), static_cast<std::int64_t>(step));
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
    Steps(recorder, 1, 30, Mode::kLockstep);
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
