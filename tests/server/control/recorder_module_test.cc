// SPDX-License-Identifier: MIT
// /recorder with its desks and real files.
#include "server/control/record_modules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <boost/json.hpp>
#include <fstream>
#include <future>
#include <optional>
#include <thread>

#include "server/record/run_reader.h"
#include "server/record/sqlite_db.h"
#include "tests/server/control/global_fixture.h"

namespace coopdyn {
namespace {

namespace json = boost::json;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto kNotPossible = static_cast<std::int32_t>(Error::kNotPossible);
constexpr std::time_t kMoonLanding = -14'182'940;  // 1969-07-20 20:17:40 UTC

class RecorderModuleTest : public GlobalModuleTest {
 protected:
  RecorderModuleTest() { Make({}); }

  void Make(RecordingOptions options) {
    client_.reset();
    module_.reset();
    runs_.reset();
    desk_.reset();
    options.folder = folder_;
    options.wall_clock = [] { return kMoonLanding; };
    desk_.emplace(std::move(options), edits_, run_, world_.frames, clock_, logger_);
    runs_.emplace(
        folder_, SearchPath{}, [this] { return desk_->status().file.file; }, logger_);
    module_.emplace(
        services_, *desk_, *runs_, [] { return "http://here:10001/"; }, thread_.poster());
    client_.emplace(*module_, 1);
  }
  Message Ask(const std::string& line) { return GlobalModuleTest::Ask(*client_, line); }
  json::array List() { return json::parse(Ask("list").text).as_array(); }
  RunToCopy Open(const std::string& name) {
    std::promise<RunToCopy> opened;
    runs_->Open(name, [&](const RunToCopy& run) { opened.set_value(run); });
    return opened.get_future().get();
  }

  std::optional<RecordingDesk> desk_;
  std::optional<RunFolder> runs_;
  std::optional<RecorderModule> module_;
  std::optional<FakeClient> client_;
};

TEST_F(RecorderModuleTest, RecordsFromStartToStop) {
  EXPECT_EQ(Ask("get_recording").text, "");
  EXPECT_THAT(client_->received.back().params, ElementsAre(0));
  const Message started = Ask("start lesson1");
  ASSERT_EQ(started.error, 0) << started.text;
  EXPECT_EQ(started.text, "lesson1.run");
  EXPECT_EQ(desk_->recording(), "lesson1.run");
  for (int i = 0; i < 10; ++i) Step();
  EXPECT_THAT(Ask("get_recording").params, ElementsAre(1));
  const Message stopped = Ask("stop");
  EXPECT_EQ(stopped.text, "lesson1.run http://here:10001/runs/lesson1.run");
  EXPECT_EQ(StepOf(stopped), 10);
  EXPECT_EQ(journal_, nullptr);
  EXPECT_EQ(desk_->recording(), "");

  std::string error;
  const auto reader = RunReader::Open((folder_ / "lesson1.run").string(), error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_EQ(reader->extent().steps, 10u);
  EXPECT_EQ(reader->header().started, "1969-07-20T20:17:40Z");
}

TEST_F(RecorderModuleTest, WithoutANameItIsTheDateAndTime) {
  EXPECT_EQ(Ask("start").text, "run-19690720-201740.run");
  Ask("stop");
  EXPECT_EQ(Ask("start").text, "run-19690720-201740_2.run");
}

TEST_F(RecorderModuleTest, OnlyOneRecordingAtATime) {
  EXPECT_EQ(Ask("stop").error, kNotPossible);
  EXPECT_EQ(Ask("note here").error, kNotPossible);
  Ask("start lesson1");
  const Message again = Ask("start lesson2");
  EXPECT_EQ(again.error, kNotPossible);
  EXPECT_THAT(again.text, HasSubstr("stop ends it"));
  Ask("stop");
  EXPECT_EQ(Ask("start lesson2").error, 0);
}

TEST_F(RecorderModuleTest, NothingIsOverwrittenAndNothingElseIsReached) {
  std::ofstream(folder_ / "lesson1.run") << "mine";
  const Message there = Ask("start lesson1");
  EXPECT_EQ(there.error, kNotPossible);
  EXPECT_THAT(there.text, HasSubstr("there already"));
  for (const char* name : {"../lesson2", "/tmp/lesson2", ".hidden", "-x", "a\\nb"}) {
    EXPECT_EQ(Ask(std::string("start \"") + name + "\"").error, static_cast<std::int32_t>(Error::kOutOfRange))
        << name;
  }
  EXPECT_EQ(Ask("start " + std::string(201, 'a')).error, static_cast<std::int32_t>(Error::kOutOfRange));
  EXPECT_THAT(Ask("start .hidden").text, HasSubstr("begins with neither '.' nor '-'"));
  EXPECT_TRUE(applied_.empty());
}

TEST_F(RecorderModuleTest, NamesMayHaveBlanksAndLettersOfAnyLanguageButAddressesHaveNone) {
  EXPECT_EQ(Ask("start \"my lesson ü\"").text, "my lesson ü.run");
  Step();
  EXPECT_EQ(Ask("stop").text, "my lesson ü.run http://here:10001/runs/my%20lesson%20%C3%BC.run");
  EXPECT_EQ(Open("my lesson ü.run").file, folder_ / "my lesson ü.run");
}

TEST_F(RecorderModuleTest, AFileThatIsNotListedHasNoAddress) {
  EXPECT_EQ(desk_->StartFile((folder_ / "night.db").string(), false), "");
  ApplyEdits();
  EXPECT_EQ(Ask("stop").text, "night.db");
}

TEST_F(RecorderModuleTest, TheCommandLinesFileHasANameThatCanBeServed) {
  for (const char* name : {".hidden", "-x.run", "a\nb.run"}) {
    EXPECT_THAT(desk_->StartFile((folder_ / name).string(), true), HasSubstr("for example lesson1")) << name;
  }
  EXPECT_TRUE(applied_.empty());
}

TEST_F(RecorderModuleTest, ARecordingIsRenamedAndDeleted) {
  Ask("start lesson1");
  Step();
  EXPECT_THAT(Ask("delete lesson1").text, HasSubstr("stop the recording first"));
  EXPECT_EQ(Ask("rename lesson1/lesson2").error, kNotPossible);
  Ask("stop");
  EXPECT_EQ(Ask("rename lesson1/reached the target").text, "reached the target.run");
  EXPECT_EQ(Open("reached the target.run").error, Error::kOk);
  EXPECT_EQ(Ask("delete reached the target.run").error, 0);
  EXPECT_TRUE(List().empty());
}

TEST_F(RecorderModuleTest, RenamingOverwritesNothing) {
  for (const char* name : {"one", "two"}) {
    Ask(std::string("start ") + name);
    Step();
    Ask("stop");
  }
  EXPECT_THAT(Ask("rename one/two").text, HasSubstr("two.run is there already"));
  EXPECT_EQ(List().size(), 2u);
}

TEST_F(RecorderModuleTest, NothingOutsideTheFolderIsDeletedOrNamed) {
  std::ofstream(folder_ / "notes.txt") << "mine";
  std::ofstream(folder_.parent_path() / "outer.run") << "mine";
  for (const char* line :
       {"delete ../outer", "delete notes.txt", "delete none", "rename ../outer/x", "rename none/x"}) {
    EXPECT_EQ(Ask(line).error, kNotPossible) << line;
  }
  EXPECT_EQ(Ask("rename one").error, static_cast<std::int32_t>(Error::kOutOfRange));
  EXPECT_TRUE(std::filesystem::remove(folder_.parent_path() / "outer.run"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "notes.txt"));
}

TEST_F(RecorderModuleTest, WhatCannotBeReadCanBeDeleted) {
  std::ofstream(folder_ / "torn.run") << "no recording";
  EXPECT_EQ(Ask("delete torn").error, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "torn.run"));
}

TEST_F(RecorderModuleTest, ANoteStandsAtItsStep) {
  Ask("start lesson1");
  for (int i = 0; i < 3; ++i) Step();
  EXPECT_EQ(Ask("note the robots meet").error, 0);
  Step();
  Ask("stop");
  std::string error;
  const auto reader = RunReader::Open((folder_ / "lesson1.run").string(), error);
  ASSERT_NE(reader, nullptr) << error;
  const std::vector<Event> events = reader->Events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].step, 3u);
  EXPECT_EQ(events[0].level, "note");
  EXPECT_EQ(events[0].text, "the robots meet");
}

TEST_F(RecorderModuleTest, WhatIsPlayedIsNotRecordedAgain) {
  run_.SetPlayback(PlaybackStatus{});
  EXPECT_THAT(Ask("start lesson1").text, HasSubstr("playing a recording"));
  EXPECT_TRUE(applied_.empty());
}

TEST_F(RecorderModuleTest, WhoeverStepsMayRefuse) {
  next_result_.error = Error::kNotPossible;
  next_result_.text = "playing a recording";
  EXPECT_EQ(Ask("start lesson1").text, "playing a recording");
  EXPECT_EQ(desk_->recording(), "");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "lesson1.run"));
  next_result_ = {};
  EXPECT_EQ(Ask("start lesson1").error, 0);
}

TEST_F(RecorderModuleTest, ListTellsTheNewestFirstAndWhatCannotBeRead) {
  Ask("start old");
  Step();
  Ask("stop");
  std::ofstream(folder_ / "foreign.run") << "no recording";
  std::ofstream(folder_ / "notes.txt") << "no recording";
  const auto now = std::filesystem::last_write_time(folder_ / "old.run");
  std::filesystem::last_write_time(folder_ / "foreign.run", now - std::chrono::hours(1));
  Ask("start new");
  Step();
  while (desk_->status().file.bytes == 0) std::this_thread::yield();  // until it has been made
  const json::array list = List();
  ASSERT_EQ(list.size(), 3u);
  const auto named = [&](const char* name) -> const json::object& {
    return std::find_if(list.begin(), list.end(), [&](const auto& run) { return run.at("name") == name; })
        ->as_object();
  };
  EXPECT_EQ(list.back().at("name"), "foreign.run");
  EXPECT_TRUE(list.back().at("steps").is_null());
  EXPECT_TRUE(list.back().at("url").is_null());
  EXPECT_EQ(named("old.run").at("steps"), 1);
  EXPECT_DOUBLE_EQ(named("old.run").at("seconds").to_number<double>(), 0.01);
  EXPECT_EQ(named("old.run").at("recording"), false);
  EXPECT_EQ(named("old.run").at("url"), "http://here:10001/runs/old.run");
  EXPECT_EQ(named("new.run").at("recording"), true);
  EXPECT_TRUE(named("new.run").at("url").is_null());
}

TEST_F(RecorderModuleTest, OnlyClosedRecordingsOfTheFolderAreHandedOut) {
  Ask("start lesson1");
  Step();
  EXPECT_EQ(Open("lesson1.run").error, Error::kNotPossible);
  EXPECT_THAT(Open("lesson1.run").text, HasSubstr("stop the recording first"));
  Ask("stop");
  EXPECT_EQ(Open("lesson1.run").file, folder_ / "lesson1.run");
  std::ofstream(folder_ / "secret.txt") << "x";
  std::filesystem::copy_file(folder_ / "lesson1.run", folder_ / ".hidden.run");
  for (const char* name :
       {"lesson2.run", "secret.txt", "../lesson1.run", "", ".run", ".mat", "/etc/passwd", ".hidden.run"}) {
    EXPECT_EQ(Open(name).error, Error::kNoSuchName) << name;
  }
  EXPECT_EQ(List().size(), 1u);
}

TEST_F(RecorderModuleTest, AFileWithoutItsLogIsNotHandedOut) {
  Ask("start lesson1");
  Step();
  Ask("stop");
  std::string error;
  std::unique_ptr<Database> other =
      Database::Open((folder_ / "lesson1.run").string(), Database::Access::kReadWrite, error);
  ASSERT_NE(other, nullptr) << error;
  ASSERT_TRUE(other->Try("PRAGMA journal_mode = WAL; PRAGMA user_version = 2")) << other->error();
  const RunToCopy refused = Open("lesson1.run");
  EXPECT_EQ(refused.error, Error::kNotPossible);
  EXPECT_THAT(refused.text, HasSubstr("its log lesson1.run-wal could not be made part of it"));
  EXPECT_THAT(refused.text, HasSubstr("copy lesson1.run and lesson1.run-wal together"));
  EXPECT_EQ(List()[0].at("steps"), 1);
  EXPECT_TRUE(List()[0].at("url").is_null());

  other.reset();  // closing the last handle merges the log
  EXPECT_EQ(Open("lesson1.run").error, Error::kOk);
  EXPECT_EQ(List()[0].at("url"), "http://here:10001/runs/lesson1.run");
}

TEST_F(RecorderModuleTest, StrangersLookButChangeOnlyWithTheToken) {
  FakeClient stranger(*module_, 2, false);
  EXPECT_EQ(GlobalModuleTest::Ask(stranger, "list").error, 0);
  EXPECT_EQ(stranger.Ask("get_recording").error, 0);
  for (const char* line : {"start", "stop", "note x"}) {
    EXPECT_EQ(stranger.Ask(line).error, static_cast<std::int32_t>(Error::kNotAllowed)) << line;
  }
  stranger.Ask("hello ana secret");
  EXPECT_EQ(GlobalModuleTest::Ask(stranger, "start lesson1").error, 0);
}

TEST_F(RecorderModuleTest, TheCommandLinesFileIsRecordedFromTheFirstStep) {
  const std::string file = (folder_ / "sub" / "night").string();
  EXPECT_THAT(desk_->StartFile(file, false), HasSubstr("cannot make"));
  std::filesystem::create_directory(folder_ / "sub");
  EXPECT_EQ(desk_->StartFile(file, false), "");
  ApplyEdits();
  Step();
  // The file is not in the folder, so the page cannot offer it.
  EXPECT_EQ(Ask("stop").text, "night.run");
  EXPECT_THAT(desk_->StartFile(file, false), HasSubstr("--force"));
  EXPECT_EQ(desk_->StartFile(file, true), "");
}

TEST_F(RecorderModuleTest, CloseEndsARecordingThatIsUnderWay) {
  Ask("start lesson1");
  for (int i = 0; i < 5; ++i) Step();
  edits_.Close();
  desk_->Close();
  EXPECT_EQ(Open("lesson1.run").error, Error::kOk);
  EXPECT_EQ(Ask("start lesson2").error, kNotPossible);
  EXPECT_FALSE(desk_->failed());
}

TEST_F(RecorderModuleTest, ARunThatCannotFitIsRefused) {
  RecordingOptions options;
  options.duration_s = 1e12;
  Make(std::move(options));
  const Message reply = Ask("start lesson1");
  EXPECT_EQ(reply.error, kNotPossible);
  EXPECT_THAT(reply.text, HasSubstr("cannot fit"));
  EXPECT_EQ(desk_->StartFile((folder_ / "lesson1").string(), true), "");
}

/// During its lifetime files cannot grow beyond this number of bytes.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limited = before_;
    limited.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

TEST_F(RecorderModuleTest, ADiskThatIsFullHoldsTheRecordingUpUntilThereIsRoom) {
  const auto told = [&](const char* text) {
    const std::vector<Event> events = run_.events();
    return std::any_of(events.begin(), events.end(),
                       [text](const Event& event) { return event.text.find(text) != std::string::npos; });
  };
  const auto step_until_told = [&](const char* text) {
    while (!told(text)) {
      Step();
      clock_.Advance(1'000'000'000);
    }
  };
  Make({});
  {
    const FileLimit limit(200'000);
    ASSERT_EQ(Ask("start lesson1").error, 0);
    step_until_told("nothing is recorded for now");
  }
  step_until_told("there is room again");
  EXPECT_FALSE(desk_->failed());
  EXPECT_TRUE(desk_->status().recording);
}

}  // namespace
}  // namespace coopdyn
