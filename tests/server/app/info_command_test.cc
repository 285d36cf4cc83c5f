// SPDX-License-Identifier: MIT
// The output of coopdyn info.
#include "server/app/info_command.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <fstream>
#include <sstream>
#include <utility>

#include "server/app/commands.h"
#include "server/model/readers.h"
#include "server/record/run_writer.h"
#include "server/record/sqlite_db.h"
#include "tests/server/base/temp_folder.h"
#include "tests/server/record/page_damage.h"
#include "tests/server/record/rechain.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

class InfoCommandTest : public testing::Test {
 protected:
  /// Four steps of 10 ms of `robots` robots; step 3 is lost.
  std::unique_ptr<RunWriter> Record(int robots = 1) {
    SearchPath path;
    path.folders.emplace_back(SourceDir());
    static RobotLibrary library(path);
    std::string text;
    for (int i = 1; i <= robots; ++i) {
      const std::string number = std::to_string(i);
      text += "[ROBOT_" + number + "]\ntype coopbot\nname robot" + number + "\nposition 0 " + number + "\n";
    }
    Diagnostics diagnostics;
    const auto scenario = ReadScenario(text, "lesson.scenario", library, false, diagnostics);
    EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
    const auto scene = MakeScene(scenario);
    SavedState state;
    RunWriterOptions options;
    std::unique_ptr<RunWriter> writer;
    for (const std::uint64_t step : {0, 1, 2, 4}) {
      auto frame = std::make_shared<Frame>();
      frame->step = step;
      frame->time = static_cast<Nanoseconds>(step) * kDefaultStep;
      frame->scene = scene;
      frame->bodies.resize(scene->body_ids.size());
      frame->channels.resize(scene->channels.size());
      frame->commanded.resize(scene->actuators.size());
      frame->channels[0].setpoint = {static_cast<double>(step)};
      state.frame = frame;
      last_hash_ = HashText(StateHash(*frame));
      if (step == 0) {
        options.header = HeaderOf(*frame, Mode::kFree, {true, false, false, true}, 0);
        options.header.version = "1.2.3";
        options.header.build = "00ff";
        std::string error;
        writer = RunWriter::Create(file_, options, state, error);
        EXPECT_NE(writer, nullptr) << error;
      } else {
        if (step == 4) writer->AddLost(1);
        writer->AddStep(*frame);
        if (step == 4) writer->AddKeyframe(state);
      }
    }
    writer->AddInput({2, edit::Pause{}});
    writer->AddEvent({1, 0.01, "note", "look here"});
    writer->AddEvent({2, 0.02, "warning", "robot1 has left the floor"});
    EXPECT_TRUE(writer->Commit());
    return writer;
  }
  void RecordAndClose(int robots = 1) {
    std::string remark;
    ASSERT_TRUE(Record(robots)->Close(remark));
  }
  int Run(InfoOptions options = {}) {
    if (options.files.empty()) options.files = {file_};
    out_.str("");
    errors_.str("");
    return Info(options, out_, errors_);
  }
  static InfoOptions Json() {
    InfoOptions options;
    options.json = true;
    return options;
  }
  static InfoOptions AllEvents() {
    InfoOptions options;
    options.events = true;
    return options;
  }
  static InfoOptions Of(std::vector<std::string> files) {
    InfoOptions options;
    options.files = std::move(files);
    return options;
  }
  void ExpectLine(const std::string& line) {
    EXPECT_NE(out_.str().find(line), std::string::npos) << line << "\nis not in\n" << out_.str();
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  std::string last_hash_;
  std::ostringstream out_, errors_;
};

TEST_F(InfoCommandTest, LinesOfANoteStandBelowEachOtherAndDoNotDriveTheTerminal) {
  const auto writer = Record();
  writer->AddEvent({4, 0.04, "note", "first\nsecond\x1b[2J\r"});
  EXPECT_TRUE(writer->Commit());
  EXPECT_EQ(Run(), kExitOk) << errors_.str();
  ExpectLine("0.040 s  note    first\n                          second?[2J?\n");
}

TEST_F(InfoCommandTest, SaysWhatTheRecordingHolds) {
  RecordAndClose();
  EXPECT_EQ(Run(), kExitOk) << errors_.str();
  ExpectLine(file_ + ": 0.04 s, 3 steps, 1 robot\n");
  ExpectLine("time      0 to 0.04 s, steps 0 to 4\n");
  ExpectLine("scenario  lesson, seed 1, free, steps of 10 ms\n");
  ExpectLine("robots    robot1 (coopbot)\n");
  ExpectLine("recorded  poses,channels,controllers\n");
  ExpectLine("2 keyframes\n");
  ExpectLine("inputs    3 commands, 1 other input\n");
  ExpectLine("lost      1 step\n");
  ExpectLine("made by   coopdyn 1.2.3 (build 00ff)");
  ExpectLine("last hash " + last_hash_ + "\n");
  ExpectLine("events    2, 1 note; --events lists them all\n");
}

TEST_F(InfoCommandTest, NotesAreAlwaysListedOtherEventsWhenAskedFor) {
  RecordAndClose();
  Run();
  ExpectLine("0.010 s  note    look here\n");
  EXPECT_EQ(out_.str().find("has left the floor"), std::string::npos);
  Run(AllEvents());
  ExpectLine("0.020 s  warning robot1 has left the floor\n");
  EXPECT_EQ(out_.str().find("--events"), std::string::npos);
}

TEST_F(InfoCommandTest, NamesTenRobotsAtMost) {
  RecordAndClose(12);
  Run();
  ExpectLine("robot10 (coopbot), and 2 more\n");
}

TEST_F(InfoCommandTest, MendsWhatACrashHasLeftAndSaysSo) {
  Record().reset();
  EXPECT_EQ(Run(), kExitOk) << errors_.str();
  ExpectLine("mended: the recording had not been closed\n");
  Run();
  EXPECT_EQ(out_.str().find("mended"), std::string::npos);
}

TEST_F(InfoCommandTest, SaysThatItIsBeingRecorded) {
  const auto writer = Record();
  EXPECT_EQ(Run(), kExitOk) << errors_.str();
  ExpectLine("it is being recorded at this moment\n");
}

TEST_F(InfoCommandTest, NamesTheLogThatIsNotPartOfTheFile) {
  std::string remark, error;
  const auto writer = Record();
  const auto other = Database::Open(file_, Database::Access::kReadOnly, error);
  ASSERT_TRUE(other->Try("BEGIN; SELECT * FROM step"));
  ASSERT_TRUE(writer->Close(remark));
  EXPECT_EQ(Run(), kExitOk) << errors_.str();
  ExpectLine("  log       " + file_ +
             "-wal is not part of the file yet (another program reads it): copy both\n");
  Run(Json());
  ExpectLine("\"log\":\"" + file_ + "-wal\",\"log_reason\":\"another program reads it\"");
}

TEST_F(InfoCommandTest, OneFileHasNoLog) {
  RecordAndClose();
  Run();
  EXPECT_EQ(out_.str().find("  log "), std::string::npos);
  Run(Json());
  ExpectLine("\"log\":null,\"log_reason\":null");
}

TEST_F(InfoCommandTest, JsonHasTheSameAsText) {
  RecordAndClose();
  EXPECT_EQ(Run(Json()), kExitOk);
  const boost::json::value value = boost::json::parse(out_.str());
  ASSERT_EQ(value.as_array().size(), 1u);
  const boost::json::object& run = value.as_array()[0].as_object();
  EXPECT_EQ(run.at("file").as_string(), file_);
  EXPECT_EQ(run.at("steps").to_number<int>(), 3);
  EXPECT_EQ(run.at("lost").to_number<int>(), 1);
  EXPECT_DOUBLE_EQ(run.at("end_s").to_number<double>(), 0.04);
  EXPECT_EQ(run.at("last_hash").as_string(), last_hash_);
  EXPECT_EQ(run.at("commands").to_number<int>(), 3);
  EXPECT_EQ(run.at("robots").as_array()[0].as_object().at("type").as_string(), "coopbot");
  EXPECT_EQ(run.at("events").as_array().size(), 2u);
}

TEST_F(InfoCommandTest, StepsThatWereCutOffTheEndAreMissing) {
  RecordAndClose();
  Run();
  EXPECT_EQ(out_.str().find("missing"), std::string::npos);
  {
    std::string error;
    const auto database = Database::Open(file_, Database::Access::kReadWrite, error);
    ASSERT_TRUE(database != nullptr && database->Try("DELETE FROM step WHERE step > 1")) << error;
  }
  EXPECT_EQ(Run(), kExitErrors) << errors_.str();
  ExpectLine("missing   3 steps at the end: the file is damaged\n");
  EXPECT_NE(out_.str().find("  damaged   " + file_), std::string::npos) << out_.str();
  Run(Json());
  const boost::json::value value = boost::json::parse(out_.str());
  EXPECT_EQ(value.as_array()[0].as_object().at("missing").to_number<int>(), 3);
}

TEST_F(InfoCommandTest, ADamagedPageIsToldOrDoesNoHarm) {
  RecordAndClose(2);
  ASSERT_EQ(Run(), kExitOk);
  const std::string whole = out_.str();
  std::ifstream stream(file_, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  int damaged = 0;
  ForEachDamage(bytes, file_, [&](const std::string& what) {
    if (Run() == kExitOk) {
      EXPECT_EQ(out_.str(), whole) << what;
      return;
    }
    ++damaged;
    EXPECT_NE((out_.str() + errors_.str()).find(file_), std::string::npos) << what;
  });
  EXPECT_GT(damaged, 50);
}

TEST_F(InfoCommandTest, PluginsAndLibrariesAreToldWithTheirHashes) {
  RecordAndClose();
  {
    std::string error;
    const auto database = Database::Open(file_, Database::Access::kReadWrite, error);
    ASSERT_TRUE(database->Try("INSERT INTO meta VALUES('controllers', 'a b 0123456789abcdef, flock 00ff')"));
    ASSERT_TRUE(database->Try("INSERT OR REPLACE INTO meta VALUES('libraries', 'libode.so.7 00ee')"));
  }
  Rechain(file_);
  EXPECT_EQ(Run(), kExitOk) << errors_.str() << out_.str();
  ExpectLine("plug-ins  a b (hash 0123456789abcdef), flock (hash 00ff)\n");
  ExpectLine("libraries libode.so.7 (hash 00ee)\n");
  Run(Json());
  const boost::json::value value = boost::json::parse(out_.str());
  EXPECT_EQ(value.as_array()[0].as_object().at("controllers").at("flock").as_string(), "00ff");
}

TEST_F(InfoCommandTest, ABadFileIsAnErrorAndTheOthersAreToldOf) {
  RecordAndClose();
  const std::string bad = folder_.File("bad.run");
  std::ofstream(bad) << std::string(2000, 'x');
  EXPECT_EQ(Run(Of({bad, file_})), kExitErrors);
  EXPECT_NE(errors_.str().find("coopdyn: " + bad + " is not a recording of coopdyn"), std::string::npos);
  ExpectLine(file_ + ": 0.04 s");
}

}  // namespace
}  // namespace coopdyn
