// SPDX-License-Identifier: MIT
// The files that a recorder makes, and those that it leaves alone.
#include <fstream>

#include "recorder_fixture.h"

namespace coopdyn {
namespace {

TEST_F(RecorderTest, EachLaterBeginGoesOnInANumberedFile) {
  Recorder recorder(Options(), clock_, NullLogger());
  for (std::uint64_t run = 1; run <= 3; ++run) {
    recorder.Begin(maker_.Start());
    Steps(recorder, 1, run, Mode::kRealtime);
  }
  recorder.Close();
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-3.run"));
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_EQ(Ask(folder_.File("lesson1-2.run"), "SELECT count(*) FROM step"), 3);
  EXPECT_EQ(Ask(folder_.File("lesson1-3.run"), "SELECT count(*) FROM step"), 4);
  EXPECT_EQ(Ask(folder_.File("lesson1-2.run"), "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

TEST_F(RecorderTest, NumbersThatAreTakenAreLeftAloneEvenIfTheFirstFileIsReplaced) {
  const std::string taken = folder_.File("lesson1-2.run");
  { const auto old = MakeWriter(taken, *maker_.Start(100)); }
  { const auto old = MakeWriter(file_, *maker_.Start(100)); }
  std::filesystem::create_directory(folder_.File("lesson1-3.run"));
  RecorderOptions options = Options();
  options.overwrite = true;
  Recorder recorder(options, clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kLockstep);
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(recorder.status().failure, "");
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-4.run"));
  EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), 1);
  EXPECT_EQ(Ask(taken, "SELECT step FROM step"), 100);
}

TEST_F(RecorderTest, ANameThatIsTakenInTheLastMomentIsLeftAlone) {
  Recorder recorder(Options(), clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  recorder.Begin(maker_.Start());
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-2.run"));
  std::ofstream(folder_.File("lesson1-2.run")) << "mine";
  clock_.OpenGate();
  recorder.Close();
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-3.run"));
  EXPECT_EQ(std::filesystem::file_size(folder_.File("lesson1-2.run")), 4U);
}

TEST_F(RecorderTest, TheStatusIsOfTheNewFileAtOnceWhileTheOldOneIsWritten) {
  Recorder recorder(Options(), clock_, NullLogger());
  BeginAndHold(recorder, Mode::kRealtime);
  for (std::uint64_t run = 2; run <= 4; ++run) {
    recorder.Begin(maker_.Start(10 * run, Mode::kRealtime));
    const RecorderStatus status = recorder.status();
    EXPECT_EQ(status.file, folder_.File("lesson1-" + std::to_string(run) + ".run"));
    EXPECT_EQ(status.steps, 0U);
    EXPECT_EQ(status.begin, static_cast<Nanoseconds>(run) * 100'000'000);
    Step(recorder, 10 * run + 1, Mode::kRealtime);
  }
  clock_.OpenGate();
  recorder.Close();
  EXPECT_EQ(recorder.status().file, folder_.File("lesson1-4.run"));
  EXPECT_EQ(recorder.status().steps, 1U);
  EXPECT_EQ(Ask(folder_.File("lesson1-3.run"), "SELECT max(step) FROM step"), 31);
}

TEST_F(RecorderTest, APartSaysWhereTheRunGoesOn) {
  Recorder recorder(Options(), clock_, NullLogger());
  recorder.Begin(maker_.Start());
  Step(recorder, 1, Mode::kLockstep);
  recorder.Begin(maker_.Start());
  recorder.Close();
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event WHERE text LIKE '%starts again in %lesson1-2.run'"), 1);
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
  EXPECT_EQ(recorder.Check(), file_ + " is being recorded by another program: choose another name");
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

}  // namespace
}  // namespace coopdyn
