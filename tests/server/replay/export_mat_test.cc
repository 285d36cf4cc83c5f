// SPDX-License-Identifier: MIT
#include "server/replay/export_tables.h"

#include <gmock/gmock.h>
#include <matio.h>

#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "export_fixture.h"
#include "server/record/sqlite_db.h"
#include "server/replay/mat_value.h"
#include "tests/server/replay/replay_fixture.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The struct `run` of a MAT file.
class MatRun {
 public:
  explicit MatRun(const std::string& file) {
    mat_t* mat = Mat_Open(file.c_str(), MAT_ACC_RDONLY);
    if (mat == nullptr) return;
    version_ = Mat_GetVersion(mat);
    run_.reset(Mat_VarRead(mat, "run"));
    Mat_Close(mat);
  }
  bool is_level_5() const { return version_ == MAT_FT_MAT5; }
  const matvar_t* Field(const char* name) const { return Mat_VarGetStructFieldByName(run_.get(), name, 0); }
  /// Field `name` of element `index` of the struct array `list`.
  const matvar_t* Field(const char* list, std::size_t index, const char* name) const {
    return Mat_VarGetStructFieldByName(Mat_VarGetStructFieldByName(run_.get(), list, 0), name, index);
  }

 private:
  MatValue run_;
  mat_ft version_ = MAT_FT_UNDEFINED;
};

std::array<std::size_t, 2> Size(const matvar_t* value) {
  return {value->dims[0], value->dims[1]};
}

double Number(const matvar_t* value, std::size_t row = 0, std::size_t column = 0) {
  return static_cast<const double*>(value->data)[column * value->dims[0] + row];
}

std::string Characters(const matvar_t* value) {
  return {static_cast<const char*>(value->data), value->nbytes};
}

/// Bitwise equal; all nans are equal.
bool SameBits(double a, double b) {
  return (a != a && b != b) || std::memcmp(&a, &b, sizeof a) == 0;
}

class ExportMatTest : public ExportTest {
 protected:
  std::string Export(const ExportOptions& options = {}) {
    return ExportMat(*Open(), options, File("run.mat"), nullptr);
  }
  MatRun Exported(const ExportOptions& options = {}) {
    EXPECT_EQ(Export(options), "");
    return MatRun(File("run.mat"));
  }
};

TEST_F(ExportMatTest, HoldsTheSameBitsAsTheCsv) {
  Record();
  const ExportOptions options{.from_s = 0.05, .every_s = 0.02};
  ASSERT_EQ(ExportCsv(*Open(), options, File("run.csv"), nullptr), "");
  const Table table(Text(File("run.csv")));
  const MatRun run = Exported(options);
  ASSERT_TRUE(run.is_level_5());
  ASSERT_GT(table.rows.size(), 10U);
  const std::size_t k = table.rows.size();
  EXPECT_EQ(Size(run.Field("time")), (std::array<std::size_t, 2>{k, 1}));
  const auto same = [&](const std::string& column, const matvar_t* value, std::size_t place) {
    ASSERT_EQ(value->dims[0], k) << column;
    for (std::size_t i = 0; i < k; ++i)
      EXPECT_TRUE(SameBits(table.Number(i, column), Number(value, i, place))) << column << " row " << i;
  };
  same("step", run.Field("step"), 0);
  same("time_s", run.Field("time"), 0);
  for (std::size_t robot = 0; robot < 2; ++robot) {
    const std::string name = "robot" + std::to_string(robot + 1) + ".";
    const auto field = [&](const char* f) { return run.Field("robots", robot, f); };
    same(name + "x_m", field("pose"), 0);
    same(name + "y_m", field("pose_3d"), 1);
    same(name + "heading_rad", field("pose"), 2);
    same(name + "right_wheel_joint_rad", field("channels"), 1);
    same(name + "left_wheel_joint_rad_s", field("channels"), 2);
    same(name + "left_wheel_joint_setpoint_rad_s", field("setpoints"), 0);
    EXPECT_EQ(Size(field("modes")), (std::array<std::size_t, 2>{k, 2}));
    EXPECT_EQ(Number(field("modes"), k - 1, 1), static_cast<double>(ControlMode::kVelocity));
    same(name + "d11_m", field("distances"), 10);
    same(name + "green1_distance_m", field("targets"), 2);
    same(name + "red2_bearing_rad", field("targets"), 5);
  }
  for (std::size_t i = 0; i < 7; ++i)
    same(table.names[table.column_of.at("BALL.x_m") + i], run.Field("objects", 1, "pose_3d"), i);
}

TEST_F(ExportMatTest, SaysWhatTheRunIs) {
  Record({.steps = 3});
  const MatRun run = Exported();
  EXPECT_EQ(Characters(run.Field("version")), "0.1.0");
  EXPECT_EQ(Characters(run.Field("file")), File("run.run"));
  EXPECT_EQ(*static_cast<const std::uint64_t*>(run.Field("seed")->data), 1U);
  EXPECT_EQ(Characters(Mat_VarGetCell(const_cast<matvar_t*>(run.Field("names")), 1)), "robot2");
  EXPECT_EQ(Characters(run.Field("robots", 1, "type")), "coopbot");
  auto* joints = const_cast<matvar_t*>(run.Field("robots", 1, "joints"));
  EXPECT_EQ(Characters(Mat_VarGetCell(joints, 1)), "right_wheel_joint");
  EXPECT_EQ(Characters(run.Field("targets", 1, "color")), "green");
  EXPECT_EQ(Number(run.Field("targets", 1, "y")), -2);
  EXPECT_EQ(Size(run.Field("targets")), (std::array<std::size_t, 2>{1, 3}));
}

TEST_F(ExportMatTest, HashesAreRowsOf16Digits) {
  const std::vector<FramePtr> frames = Record({.steps = 3});
  const MatRun run = Exported();
  const matvar_t* hash = run.Field("hash");
  ASSERT_EQ(Size(hash), (std::array<std::size_t, 2>{4, 16}));
  const std::string by_column = Characters(hash);
  std::string last;
  for (std::size_t c = 0; c < 16; ++c) last += by_column[c * 4 + 3];
  EXPECT_EQ(last, HashText(StateHash(*frames.back())));
}

TEST_F(ExportMatTest, CommandsAreThoseThatCameInForce) {
  Record();
  const MatRun run = Exported({.from_s = 0.05, .until_s = 0.25});
  const matvar_t* commands = run.Field("robots", 1, "commands");
  ASSERT_EQ(Size(commands), (std::array<std::size_t, 2>{2, 6}));
  EXPECT_EQ(Number(commands, 0, 0), 10);
  EXPECT_EQ(Number(commands, 1, 1), 0.2);
  EXPECT_EQ(Number(commands, 1, 2), SetpointAt(20, 1)[0]);
  EXPECT_EQ(Number(commands, 1, 3), SetpointAt(20, 1)[1]);
  EXPECT_EQ(Number(commands, 1, 5), static_cast<double>(ControlMode::kVelocity));
}

TEST_F(ExportMatTest, WhatWasNotRecordedIsEmpty) {
  Record({.steps = 3, .what = {}});
  const MatRun run = Exported({.objects = std::vector<std::string>{}});
  for (const char* field : {"channels", "distances", "targets"})
    EXPECT_EQ(run.Field("robots", 0, field)->nbytes, 0U) << field;
  EXPECT_EQ(Size(run.Field("objects")), (std::array<std::size_t, 2>{1, 0}));
  EXPECT_EQ(Size(run.Field("events")), (std::array<std::size_t, 2>{1, 0}));
}

TEST_F(ExportMatTest, OfAControllerThatWasNotRecordedThereAreOnlyCommandsOfClients) {
  std::string scenario = "[ROBOT]\ntype minibot\nname robot1\nposition 2 2\n";
  for (const char* name : {"m1", "m2"}) {
    scenario += std::string("[ROBOT_") + name + "]\ntype minibot\nname " + name + "\nposition 0 " +
                (name + 1) + "\ncontroller diffuse\n";
  }
  {
    LiveRun run(File("run.run"), scenario, {.what = {}});
    run.Step(10);
    run.Apply(edit::UnloadController{"m2"});
    run.Command("m2", 4, 5);
    run.Step(10);
  }
  const MatRun run = Exported();
  const auto commands = [&run](std::size_t robot) { return run.Field("robots", robot, "commands"); };
  EXPECT_EQ(Size(commands(0)), (std::array<std::size_t, 2>{1, 6})) << "before the first step";
  EXPECT_EQ(Size(commands(1)), (std::array<std::size_t, 2>{0, 6}));
  ASSERT_EQ(Size(commands(2)), (std::array<std::size_t, 2>{1, 6}));
  EXPECT_EQ(Number(commands(2), 0, 0), 11);
  EXPECT_EQ(Number(commands(2), 0, 3), 5);
}

TEST_F(ExportMatTest, EventsAreAStructArray) {
  Record({.steps = 3, .events = {{1, 0.01, "note", "Anfang"}, {2, 0.02, "warning", ""}}});
  const MatRun run = Exported();
  ASSERT_EQ(Size(run.Field("events")), (std::array<std::size_t, 2>{1, 2}));
  EXPECT_EQ(Characters(run.Field("events", 0, "text")), "Anfang");
  EXPECT_EQ(Number(run.Field("events", 1, "time_s")), 0.02);
}

TEST_F(ExportMatTest, NothingIsOverwrittenUnasked) {
  Record({.steps = 2});
  Put("run.mat", "mine");
  EXPECT_THAT(Export(), HasSubstr("run.mat is there already"));
  EXPECT_EQ(Text(File("run.mat")), "mine");
  EXPECT_EQ(Export({.overwrite = true}), "");
  EXPECT_THAT(Files(), ElementsAre("run.mat", "run.run"));
}

TEST_F(ExportMatTest, ARecordingIsNeverOverwritten) {
  Record({.steps = 2});
  std::filesystem::copy(File("run.run"), File("other"));
  const std::string before = Text(File("other"));
  for (const bool force : {true, false}) {
    EXPECT_EQ(ExportMat(*Open(), {.overwrite = force}, File("other"), nullptr),
              File("other") + " is a recording, which export never overwrites: choose another --out");
  }
  EXPECT_EQ(Text(File("other")), before);
  Put("begun.run", "");  // of a recorder before the end of the first step
  Put("begun.run-journal", "pages");
  EXPECT_THAT(ExportMat(*Open(), {.overwrite = true}, File("begun.run"), nullptr),
              HasSubstr("begun.run is a recording"));
  EXPECT_THAT(Files(), ElementsAre("begun.run", "begun.run-journal", "other", "run.run"));
}

TEST_F(ExportMatTest, AScenarioIsNeverOverwritten) {
  Record({.steps = 2});
  for (const char* name : {"mix.scenario", "hall.world", "robot.sdf"}) {
    Put(name, "mine");
    const std::string error = ExportMat(*Open(), {.overwrite = true}, File(name), nullptr);
    EXPECT_THAT(error, HasSubstr(std::string(name) + " is a "));
    EXPECT_THAT(error, HasSubstr(", which export never overwrites: choose another --out"));
    EXPECT_EQ(Text(File(name)), "mine");
  }
}

TEST_F(ExportMatTest, AFullDiskLeavesNothing) {
  Record({.steps = 100});
  const auto reader = Open();
  std::string error;
  {
    const SmallDisk disk(5000);
    error = ExportMat(*reader, {}, File("run.mat"), nullptr);
  }
  EXPECT_THAT(error, HasSubstr("run.mat cannot be written: the disk may be full"));
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST_F(ExportMatTest, MoreThanAFileHoldsIsRefusedAtOnce) {
  Record({.scenario = "[SWARM_1]\ntype minibot\nname mini\ncount 60\n", .steps = 2});
  std::string error;
  const auto database = Database::Open(File("run.run"), Database::Access::kReadWrite, error);
  ASSERT_NE(database, nullptr) << error;
  ASSERT_TRUE(database->Try(
      "INSERT INTO step(step, time_ns, hash, scene) WITH RECURSIVE n(i) AS (VALUES (3) UNION ALL SELECT i + "
      "1 "
      "FROM n WHERE i < 200000) SELECT i, i * 10000000, 0, (SELECT max(scene) FROM step) FROM n"));
  EXPECT_THAT(Export(), HasSubstr(" GB of numbers, a MAT file holds 2.1: choose robots with --robots"));
  EXPECT_EQ(Export({.until_s = 0.01}), "") << "less of it fits";
}

TEST_F(ExportMatTest, StoppedItLeavesNothing) {
  Record({.steps = 100});
  EXPECT_EQ(ExportMat(*Open(), {}, File("run.mat"), [](double) { return false; }), kExportStopped);
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST(MatMatrix, GrowsAndShrinksWithItsRows) {
  MatMatrix matrix(2, 1);
  for (int i = 0; i < 100; ++i) matrix.Append(std::array{static_cast<double>(i), -static_cast<double>(i)});
  const MatValue view = matrix.View();
  ASSERT_EQ(view->dims[0], 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(Number(view.get(), i, 0), static_cast<double>(i));
    EXPECT_EQ(Number(view.get(), i, 1), -static_cast<double>(i));
  }
}

TEST(MatText, IsUtf16UnlessItIsAscii) {
  EXPECT_EQ(Characters(MatText("abc").get()), "abc");
  const auto units = [](const std::string& text) {
    const MatValue value = MatText(text);
    const auto* data = static_cast<const std::uint16_t*>(value->data);
    return std::vector<int>(data, data + value->dims[1]);
  };
  EXPECT_THAT(units("ä€"), ElementsAre(0xE4, 0x20AC));
  EXPECT_THAT(units("\xF0\x9F\xA4\x96"), ElementsAre(0xD83E, 0xDD16));
  EXPECT_THAT(units("caf\xE9"), ElementsAre('c', 'a', 'f', 0xE9)) << "Latin-1";
}

}  // namespace
}  // namespace coopdyn
