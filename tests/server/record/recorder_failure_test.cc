// SPDX-License-Identifier: MIT
// What is left of a recording when the file may not grow or the process is killed.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

#include "recorder_fixture.h"

namespace coopdyn {
namespace {

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
