// SPDX-License-Identifier: MIT
// Many resets and returns to a saved state: the same steps follow, and nothing leaks.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "server/base/sanitizers.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kTimes = 1000, kTimesInChild = 50;  // each starts a process
#else
constexpr int kTimes = 1000, kTimesInChild = 300;
#endif
constexpr int kSteps = 3;

Swarm Samples() {
  Swarm swarm;
  int i = 0;
  for (const char* name : {"diffuse", "braitenberg", "aggregate", "flock", "attractor"}) {
    for (int k = 0; k < 4; ++k, ++i) swarm.Add(Sample(name));
  }
  return swarm.Mark(3, 1);
}

std::size_t OpenFiles() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

std::size_t Children() {
  std::ifstream stream("/proc/self/task/" + std::to_string(getpid()) + "/children");
  std::size_t count = 0;
  for (std::string pid; stream >> pid;) ++count;
  return count;
}

/// Memory that a process has written to, in kB. Clean pages of files are private or shared, depending on
/// other processes.
long MemoryOf(const std::string& pid) {
  std::ifstream stream("/proc/" + pid + "/smaps_rollup");
  long sum = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("Private_Dirty")) sum += std::stol(line.substr(line.find(':') + 1));
  }
  return sum;
}

double CpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Held {
  std::size_t files = 0, children = 0;
  long memory_kb = 0, child_kb = 0;
};

/// Calls `again`, which must restore the swarm's start, this number of times, and compares the steps that
/// follow.
void ExpectFlat(Driven& driven, int times, const std::function<void()>& again) {
  again();
  driven.Steps(kSteps);
  const std::vector<std::vector<WheelSpeeds>> expected(driven.run().setpoints.end() - kSteps,
                                                       driven.run().setpoints.end());
  const auto held = [&] {
    Held now{OpenFiles(), Children(), MemoryOf("self"), 0};
    const int child = driven.host().child_pid();
    if (child > 0) now.child_kb = MemoryOf(std::to_string(child));
    return now;
  };
  Held warm;
  std::vector<double> cpu_s;
  for (int k = 0; k < times; ++k) {
    const double began = CpuSeconds();
    again();
    cpu_s.push_back(CpuSeconds() - began);
    driven.Steps(kSteps);
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), driven.run().setpoints.end() - kSteps)) << k;
    driven.Forget();
    if (k == times / 10) warm = held();
  }
  ASSERT_TRUE(driven.run().stopped.empty());
  const Held end = held();
  EXPECT_EQ(end.files, warm.files);
  EXPECT_EQ(end.children, warm.children);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which keep freed memory for a while
  constexpr long kSlack_kb = 256;  // a leak of one page each time would be 3.6 MB
  EXPECT_LT(end.memory_kb, warm.memory_kb + kSlack_kb);
  EXPECT_LT(end.child_kb, warm.child_kb + kSlack_kb);
#endif
  // CPU time of this process; the minimum of the first and of the last tenth, because the machine is shared.
  const auto tenth = static_cast<std::ptrdiff_t>(times / 10);
  const double first = *std::min_element(cpu_s.begin(), cpu_s.begin() + tenth);
  const double last = *std::min_element(cpu_s.end() - tenth, cpu_s.end());
  EXPECT_LT(last, 2 * first + 1e-3);
  std::sort(cpu_s.begin(), cpu_s.end());
  testing::Test::RecordProperty("median_cpu_us", static_cast<int>(1e6 * cpu_s[cpu_s.size() / 2]));
}

class RepeatTest : public testing::TestWithParam<bool> {};

TEST_P(RepeatTest, ManyResetsLeaveNothingBehind) {
  Driven driven(Samples(), TestOptions(GetParam()));
  ExpectFlat(driven, GetParam() ? kTimes : kTimesInChild, [&] { driven.Start(); });
}

TEST_P(RepeatTest, ManyRestoresLeaveNothingBehind) {
  Driven driven(Samples(), TestOptions(GetParam()));
  driven.Start();
  driven.Steps(10);
  const FramePtr frame = driven.frame();
  const std::vector<std::byte> saved = driven.host().Save();
  ExpectFlat(driven, GetParam() ? kTimes : kTimesInChild, [&] {
    ASSERT_TRUE(driven.Restore(frame, saved));
    ASSERT_EQ(driven.host().Save(), saved);
  });
}

INSTANTIATE_TEST_SUITE_P(Backends, RepeatTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "InProcess" : "Child"; });

}  // namespace
}  // namespace coopdyn
