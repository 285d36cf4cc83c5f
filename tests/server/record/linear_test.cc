// SPDX-License-Identifier: MIT
// Recordings of eight times as many steps take about eight times as long to read.
#include <gtest/gtest.h>

#include <map>

#include "server/record/run_reader.h"
#include "server/record/sqlite_db.h"
#include "tests/cpu.h"
#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {
namespace {

constexpr std::size_t kSteps = 500;

class LinearRunTest : public testing::Test {
 protected:
  /// Fails unless the time of `read` is linear in the length of its recording.
  template <typename Read>
  void Expect(const Read& read) {
    std::map<std::size_t, std::string> files;
    for (const std::size_t steps : {kSteps, 8 * kSteps}) {
      files[steps] = folder_.File(std::to_string(steps) + ".run");
      sample_.Write(files[steps], {.steps = steps});
    }
    const auto open_and_read = [&](std::size_t steps) {
      std::string error;
      const auto reader = RunReader::Open(files[steps], error);
      ASSERT_NE(reader, nullptr) << error;
      Diagnostics diagnostics;
      ASSERT_NE(reader->LoadScenario(SourcePath(), diagnostics), nullptr);
      read(*reader, steps);
      EXPECT_EQ(reader->error(), "");
    };
    ExpectLinear(open_and_read, kSteps);
  }

  TempFolder folder_;
  SampleRun sample_;
};

TEST_F(LinearRunTest, OverallNumbers) {
  Expect([](RunReader& reader, std::size_t steps) {
    EXPECT_EQ(reader.extent().steps, steps);
    EXPECT_TRUE(reader.Contents());
    EXPECT_TRUE(reader.CountCommands());
    reader.Keyframes();
    reader.Events();
  });
}

TEST_F(LinearRunTest, AllStepsInTurn) {
  Expect([](RunReader& reader, std::size_t steps) {
    std::size_t count = 0;
    EXPECT_TRUE(reader.ForEach(0, steps, false, [&](const RecordedStep&) { return ++count > 0; }));
    EXPECT_EQ(count, steps + 1);
  });
}

TEST_F(LinearRunTest, EachStepByItself) {
  Expect([](RunReader& reader, std::size_t steps) {
    for (std::size_t step = 0; step <= steps; ++step) EXPECT_TRUE(reader.Read(step));
  });
}

TEST_F(LinearRunTest, StepsAtTimes) {
  Expect([](RunReader& reader, std::size_t steps) {
    for (std::size_t step = 0; step <= steps; ++step) {
      EXPECT_TRUE(reader.StepAt(static_cast<Nanoseconds>(step) * SampleRun::kStep, true));
      reader.NextShown(step, false);
      reader.Keyframe(step);
      reader.Inputs(step, step);
    }
  });
}

TEST_F(LinearRunTest, AHeaderWithManyLibraries) {
  constexpr std::size_t kLibraries = 20000;
  const auto file = [this](std::size_t count) { return folder_.File(std::to_string(count) + ".run"); };
  for (const std::size_t count : {kLibraries, 8 * kLibraries}) {
    sample_.Write(file(count), {.steps = 1});
    std::string error;
    Database::Open(file(count), Database::Access::kReadWrite, error)
        ->Run("INSERT OR REPLACE INTO meta VALUES('libraries', replace(hex(zeroblob(" +
              std::to_string(count) + ")), '00', ', l 0'))");
  }
  ExpectLinear(
      [&](std::size_t count) {
        std::string error;
        const auto reader = RunReader::Open(file(count), error);
        ASSERT_NE(reader, nullptr) << error;
        EXPECT_EQ(reader->header().libraries.size(), count);
      },
      kLibraries);
}

}  // namespace
}  // namespace coopdyn
