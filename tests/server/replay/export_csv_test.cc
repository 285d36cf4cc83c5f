// SPDX-License-Identifier: MIT
#include "server/replay/export_tables.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "export_fixture.h"
#include "server/record/sqlite_db.h"
#include "server/sensing/readings.h"
#include "tests/server/record/rechain.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ExportCsvTest : public ExportTest {
 protected:
  std::string Export(const ExportOptions& options = {}) {
    return ExportCsv(*Open(), options, File("run.csv"), nullptr);
  }
  Table Exported(const ExportOptions& options = {}) {
    EXPECT_EQ(Export(options), "");
    return Table(Text(File("run.csv")));
  }
};

TEST_F(ExportCsvTest, HeaderNamesRobotsThenThingsThatMoveThenTheHash) {
  Record({.what = {true, false, true, true}});
  EXPECT_THAT(
      Exported({.robots = std::vector<std::string>{"robot1"}}).names,
      ElementsAre("step", "time_s", "robot1.x_m", "robot1.y_m", "robot1.heading_rad",
                  "robot1.left_wheel_joint_rad", "robot1.right_wheel_joint_rad",
                  "robot1.left_wheel_joint_rad_s", "robot1.right_wheel_joint_rad_s", "robot1.red1_distance_m",
                  "robot1.red1_bearing_rad", "robot1.green1_distance_m", "robot1.green1_bearing_rad",
                  "robot1.red2_distance_m", "robot1.red2_bearing_rad",
                  "robot1.left_wheel_joint_setpoint_rad_s", "robot1.right_wheel_joint_setpoint_rad_s",
                  "BOX_1.x_m", "BOX_1.y_m", "BOX_1.z_m", "BOX_1.qw", "BOX_1.qx", "BOX_1.qy", "BOX_1.qz",
                  "BALL.x_m", "BALL.y_m", "BALL.z_m", "BALL.qw", "BALL.qx", "BALL.qy", "BALL.qz", "hash"));
}

TEST_F(ExportCsvTest, RowsAreTheFramesAsFarAsTheyAreRecorded) {
  const std::vector<FramePtr> frames = Record();
  const Table table = Exported();
  ASSERT_EQ(table.rows.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = *frames[i];
    EXPECT_EQ(table.Number(i, "step"), static_cast<double>(frame.step));
    EXPECT_EQ(table.Number(i, "time_s"), frame.time_s());
    EXPECT_EQ(table.rows[i].back(), HashText(StateHash(frame)));
    for (int robot = 0; robot < 2; ++robot) {
      const std::string name = robot == 0 ? "robot1." : "robot2.";
      const Pose X_WR = RobotPose(frame, robot);
      // Half a micrometre, and 1.4e-6 rad times the offset of the robot's frame from its body.
      EXPECT_NEAR(table.Number(i, name + "x_m"), X_WR.p.x(), 2e-6);
      EXPECT_NEAR(table.Number(i, name + "y_m"), X_WR.p.y(), 2e-6);
      EXPECT_NEAR(table.Number(i, name + "heading_rad"), Heading(X_WR.q), 4e-6);
      EXPECT_NEAR(table.Number(i, name + "left_wheel_joint_rad"), AnglesOf(frame, robot)[0], 0.5001e-5);
      EXPECT_NEAR(table.Number(i, name + "right_wheel_joint_rad"), AnglesOf(frame, robot)[1], 0.5001e-5);
      EXPECT_EQ(table.Number(i, name + "right_wheel_joint_rad_s"),
                static_cast<double>(static_cast<float>(SpeedsOf(frame, robot)[1])));
      const auto distances = Distances(frame, robot);
      for (std::size_t k = 0; k < distances.size(); ++k) {
        EXPECT_EQ(table.Number(i, name + "d" + std::to_string(k + 1) + "_m"),
                  static_cast<double>(static_cast<float>(distances[k])));
      }
      const std::vector<Sighting> seen = SeenTargets(frame, robot);
      ASSERT_EQ(seen.size(), 3U);
      EXPECT_EQ(table.Number(i, name + "red2_distance_m"),
                static_cast<double>(static_cast<float>(seen[2].distance_m)));
      EXPECT_EQ(table.Number(i, name + "green1_bearing_rad"),
                static_cast<double>(static_cast<float>(seen[1].bearing_rad)));
    }
    EXPECT_NEAR(table.Number(i, "BOX_1.x_m"), frame.bodies[0].p_WB.x(), 0.5001e-6);
    EXPECT_NEAR(table.Number(i, "BOX_1.qz"), frame.bodies[0].q_WB[3], 2e-6);
  }
  EXPECT_GT(std::abs(table.Number(frames.size() - 1, "robot1.x_m")), 0.02) << "the robot drove";
}

TEST_F(ExportCsvTest, ChosenSensorsShowWhatTheyShowedThen) {
  const std::vector<FramePtr> frames = Record();
  const Table table =
      Exported({.robots = std::vector<std::string>{"robot2"}, .readings = {"pose", "distance"}});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const PlaneMotion motion = MotionOf(*frames[i], 1);
    EXPECT_NEAR(table.Number(i, "robot2.pose_y_m"), motion.y_m, 2e-6);
    // A difference of two recorded positions.
    EXPECT_NEAR(table.Number(i, "robot2.pose_forward_m_s"), motion.forward_m_s, 2e-3) << i;
    const double range_m = Distances(*frames[i], 1)[2];
    const double shown_m = table.Number(i, "robot2.distance_range3_m");
    EXPECT_TRUE(shown_m == range_m || std::abs(shown_m - range_m) < 1e-4) << shown_m << " " << range_m;
  }
}

TEST_F(ExportCsvTest, ASensorThatNoRobotHasIsToldWithTheNearest) {
  Record();
  EXPECT_THAT(Export({.readings = {"distence"}}), HasSubstr("did you mean 'distance'?"));
}

TEST_F(ExportCsvTest, SetPointsAreThoseInForceAlsoWhenTheRangeBeginsBetweenKeyframes) {
  Record();
  for (const double from_s : {0.0, 0.155, 0.24}) {
    const Table table = Exported({.from_s = from_s, .overwrite = true});
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const auto step = static_cast<std::uint64_t>(table.Number(i, "step"));
      const WheelSpeeds expected = step < 10 ? WheelSpeeds{} : ExportTest::SetpointAt(step, 1);
      EXPECT_EQ(table.Number(i, "robot2.left_wheel_joint_setpoint_rad_s"), expected[0])
          << "step " << step << " from " << from_s;
      EXPECT_EQ(table.Number(i, "robot2.right_wheel_joint_setpoint_rad_s"), expected[1]) << "step " << step;
    }
  }
}

TEST_F(ExportCsvTest, TimeRangeHoldsBothEnds) {
  Record();
  const Table table = Exported({.from_s = 0.1, .until_s = 0.2});
  ASSERT_EQ(table.rows.size(), 11U);
  EXPECT_EQ(table.rows.front().front(), "10");
  EXPECT_EQ(table.rows.back().front(), "20");
}

TEST_F(ExportCsvTest, EveryTakesOneRowOfEachInterval) {
  Record();
  const Table table = Exported({.from_s = 0.05, .every_s = 0.1});
  std::vector<std::string> steps;
  for (const auto& row : table.rows) steps.push_back(row.front());
  EXPECT_THAT(steps, ElementsAre("5", "15", "25", "35"));
}

TEST_F(ExportCsvTest, StepsRecordedWithoutPosesAreLeftOut) {
  Record({.pose_every = 100'000'000});
  const Table table = Exported();
  std::vector<std::string> steps;
  for (const auto& row : table.rows) steps.push_back(row.front());
  EXPECT_THAT(steps, ElementsAre("0", "10", "20", "30", "40"));
  EXPECT_EQ(table.Number(2, "robot1.left_wheel_joint_setpoint_rad_s"), SetpointAt(20, 0)[0]);
}

TEST_F(ExportCsvTest, AfterLostStepsTheKeyframeThatFollowsTellsTheSetPoints) {
  Record();
  std::string error;
  const auto database = Database::Open(File("run.run"), Database::Access::kReadWrite, error);
  ASSERT_NE(database, nullptr) << error;
  ASSERT_TRUE(database->Try("DELETE FROM step WHERE step BETWEEN 9 AND 15"));  // with a command
  Rechain(File("run.run"));
  const Table table = Exported();
  ASSERT_EQ(table.rows.size(), 34U);
  EXPECT_EQ(table.rows[9].front(), "16");
  EXPECT_EQ(table.Number(8, "robot1.left_wheel_joint_setpoint_rad_s"), 0);
  EXPECT_EQ(table.Number(9, "robot1.left_wheel_joint_setpoint_rad_s"), SetpointAt(10, 0)[0]);
}

TEST_F(ExportCsvTest, ModesAreThereIfTheyDifferFromVelocity) {
  Record();
  std::string error;
  const auto database = Database::Open(File("run.run"), Database::Access::kReadWrite, error);
  ASSERT_NE(database, nullptr) << error;
  // Robot 1: the left joint has a position from step 20 on, the right one always an effort.
  ASSERT_TRUE(database->Try(
      "UPDATE step SET commands = CAST(substr(commands, 1, 4) || CASE WHEN step < 20 THEN x'03' ELSE x'01' "
      "END"
      " || substr(commands, 6, 12) || x'04' || substr(commands, 19) AS BLOB) WHERE commands IS NOT NULL"));
  Rechain(File("run.run"));
  const Table table = Exported({.from_s = 0.1});
  EXPECT_EQ(table.column_of.count("robot1.left_wheel_joint_setpoint_rad_s"), 0U);
  EXPECT_EQ(table.Number(0, "robot1.left_wheel_joint_setpoint"), SetpointAt(10, 0)[0]);
  EXPECT_EQ(table.Number(0, "robot1.left_wheel_joint_mode"), static_cast<double>(ControlMode::kVelocity));
  EXPECT_EQ(table.Number(10, "robot1.left_wheel_joint_mode"), static_cast<double>(ControlMode::kPosition));
  EXPECT_EQ(table.Number(10, "robot1.right_wheel_joint_mode"), static_cast<double>(ControlMode::kEffort));
  EXPECT_EQ(table.column_of.count("robot2.left_wheel_joint_mode"), 0U);
}

TEST_F(ExportCsvTest, RobotsAndThingsAreChosenByName) {
  Record();
  ExportOptions options;
  options.robots = std::vector<std::string>{"robot2"};
  options.objects = std::vector<std::string>{};
  const Table table = Exported(options);
  EXPECT_EQ(table.column_of.count("robot2.x_m"), 1U);
  EXPECT_EQ(table.column_of.count("robot1.x_m"), 0U);
  EXPECT_EQ(table.column_of.count("BOX_1.x_m"), 0U);
}

TEST_F(ExportCsvTest, NoRobotsAndNoThingsLeaveTimeAndHash) {
  Record();
  ExportOptions options;
  options.robots = options.objects = std::vector<std::string>{};
  EXPECT_THAT(Exported(options).names, ElementsAre("step", "time_s", "hash"));
}

TEST_F(ExportCsvTest, ASwarmIsAllItsRobots) {
  Record({.scenario = "[SWARM_1]\ntype minibot\nname mini\ncount 3\n[ROBOT_1]\ntype coopbot\nname leader\n"
                      "position 2 2\n",
          .steps = 2});
  const Table table = Exported({.robots = std::vector<std::string>{"mini"}});
  EXPECT_EQ(table.column_of.count("mini_1.x_m") + table.column_of.count("mini_3.x_m"), 2U);
  EXPECT_EQ(table.column_of.count("leader.x_m"), 0U);
}

TEST_F(ExportCsvTest, UnknownNamesSayWhatIsNear) {
  Record({.steps = 2});
  EXPECT_EQ(Export({.robots = std::vector<std::string>{"robt1"}}),
            "there is no robot 'robt1' in this part of the run; did you mean 'robot1'?");
  EXPECT_EQ(Export({.robots = std::vector<std::string>{"xyz"}}),
            "there is no robot 'xyz' in this part of the run: there are robot1 and robot2");
  EXPECT_EQ(Export({.objects = std::vector<std::string>{"BALLL"}}),
            "there is no thing 'BALLL' that moves in this part of the run; did you mean 'BALL'?");
  EXPECT_EQ(Export({.objects = std::vector<std::string>{"WALL_1"}}),
            "'WALL_1' never moves: there are BOX_1 and BALL");
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST_F(ExportCsvTest, RangesOutsideTheRunSayHowLongItLasts) {
  Record();
  EXPECT_EQ(Export({.from_s = 7}), "--from 7: the run lasts from 0 to 0.4 s");
  EXPECT_EQ(Export({.until_s = -1}), "--until -1: the run lasts from 0 to 0.4 s");
  EXPECT_EQ(Export({.from_s = 0.3, .until_s = 0.2}), "--from 0.3 is after --until 0.2");
  EXPECT_EQ(Export({.from_s = std::nan("")}), "--from: write simulated seconds, e.g. 12.5");
  EXPECT_EQ(Export({.every_s = -1}), "--every: write a time above 0, e.g. 0.1");
  EXPECT_EQ(Export({.from_s = 0.201, .until_s = 0.209}), "there is no recorded step from 0.201 to 0.209 s");
}

TEST_F(ExportCsvTest, EventsStandBesideItQuoted) {
  Record({.events = {{5, 0.05, "note", "he said \"go\", then\nleft"}, {30, 0.3, "warning", "late"}}});
  ASSERT_EQ(Export({.until_s = 0.2}), "");
  EXPECT_EQ(Text(File("run-events.csv")),
            "step,time_s,level,text\n5,0.05,note,\"he said \"\"go\"\", then\nleft\"\n");
}

TEST_F(ExportCsvTest, NothingIsOverwrittenUnasked) {
  Record({.steps = 2});
  Put("run.csv", "mine");
  EXPECT_THAT(Export(), HasSubstr("run.csv is there already: --force overwrites it"));
  EXPECT_EQ(Text(File("run.csv")), "mine");
  std::filesystem::remove(File("run.csv"));
  Put("run-events.csv", "mine");
  EXPECT_THAT(Export(), HasSubstr("run-events.csv is there already"));
  EXPECT_THAT(Files(), ElementsAre("run-events.csv", "run.run"));
  EXPECT_EQ(Export({.overwrite = true}), "");
  EXPECT_THAT(Text(File("run-events.csv")), HasSubstr("step,time_s,level,text"));
}

TEST_F(ExportCsvTest, AFolderThatIsNotThereIsSaid) {
  Record({.steps = 2});
  EXPECT_THAT(ExportCsv(*Open(), {}, File("none/run.csv"), nullptr),
              HasSubstr("none/run.csv cannot be written: No such file or directory"));
}

TEST_F(ExportCsvTest, AFullDiskLeavesNothing) {
  Record({.steps = 400});
  const auto reader = Open();
  std::string error;
  {
    const SmallDisk disk(100'000);
    error = ExportCsv(*reader, {}, File("run.csv"), nullptr);
  }
  EXPECT_THAT(error, HasSubstr("run.csv cannot be written: File too large"));
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST_F(ExportCsvTest, StoppedItLeavesNothing) {
  Record({.steps = 100});
  double seen = 0;
  const auto stop = [&seen](double share) {
    seen = share;
    return share < 0.5;
  };
  EXPECT_EQ(ExportCsv(*Open(), {}, File("run.csv"), stop), kExportStopped);
  EXPECT_GE(seen, 0.5);
  EXPECT_LT(seen, 1);
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST(CsvNumber, ReadsAsTheSameDouble) {
  for (const double value : {0.1, -1e-300, 1e22, 123456789.123456789, 5e-324, -0.0}) {
    std::string text;
    AppendNumber(value, text);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
  }
}

TEST(CsvNumber, WhatIsNotFiniteIsAWord) {
  std::string text;
  for (const double value : {std::nan(""), -std::nan(""), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
    AppendNumber(value, text);
    text += ' ';
  }
  EXPECT_EQ(text, "nan nan inf -inf ");
}

}  // namespace
}  // namespace coopdyn
