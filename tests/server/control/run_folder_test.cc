// SPDX-License-Identifier: MIT
// The list of recordings, and the files exported from them.
#include "server/control/run_folder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/json.hpp>
#include <filesystem>
#include <future>

#include "tests/server/replay/export_fixture.h"

namespace coopdyn {
namespace {

RunFile Readable(const std::string& name) {
  RunFile run;
  run.name = name;
  run.seconds = 1.5;
  run.steps = 150;
  return run;
}

boost::json::value UrlOf(const RunFile& run) {
  return boost::json::parse(RunsJson({run}, "http://127.0.0.1:8080/")).at(0).at("url");
}

TEST(RunsJson, ARecordingThatCanBeCopiedHasALink) {
  EXPECT_EQ(UrlOf(Readable("lesson1.run")), "http://127.0.0.1:8080/runs/lesson1.run");
}

TEST(RunsJson, InALinkANameIsPercentEncoded) {
  EXPECT_EQ(UrlOf(Readable("my lesson ü.run")), "http://127.0.0.1:8080/runs/my%20lesson%20%C3%BC.run");
}

TEST(RunsJson, WhatIsBeingRecordedHasNoLink) {
  RunFile run = Readable("lesson1.run");
  run.recording = true;
  EXPECT_TRUE(UrlOf(run).is_null());
}

TEST(RunFolder, WhenItHasStoppedNoAnswerComesAnyMore) {
  RunFolder folder(
      std::filesystem::temp_directory_path(), {}, [] { return ""; }, Logger());
  std::atomic<int> answers{0};
  for (int i = 0; i < 100; ++i) folder.Open("none.run", [&](const RunToCopy&) { ++answers; });
  folder.Stop();
  const int at_stop = answers;
  folder.Open("none.run", [&](const RunToCopy&) { ++answers; });
  folder.List([&](const std::vector<RunFile>&) { ++answers; });
  folder.Stop();
  EXPECT_EQ(answers, at_stop);
}

using RunFolderExportTest = ExportTest;

TEST_F(RunFolderExportTest, AMatFileIsForNobodyElsesEyesAndNothingOfItIsLeft) {
  namespace fs = std::filesystem;
  constexpr fs::perms kOthers = fs::perms::group_all | fs::perms::others_all;
  Record();
  fs::path folder_of_mat;
  {
    RunFolder folder(
        fs::path(File("run.run")).parent_path(), Path(), [] { return ""; }, Logger());
    for (int i = 0; i < 2; ++i) {
      std::promise<RunToCopy> made;
      folder.Open("run.mat", [&](const RunToCopy& run) { made.set_value(run); });
      const RunToCopy run = made.get_future().get();
      ASSERT_EQ(run.text, "");
      EXPECT_GT(fs::file_size(run.file), 100U);
      folder_of_mat = run.file.parent_path();
      EXPECT_EQ(fs::status(folder_of_mat).permissions() & kOthers, fs::perms::none);
      fs::remove(run.file);
    }
  }
  EXPECT_FALSE(fs::exists(folder_of_mat));
}

}  // namespace
}  // namespace coopdyn
