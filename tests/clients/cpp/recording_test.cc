// SPDX-License-Identifier: MIT
// Recording, downloading, reading, playing and branching from C++, against the real daemon and hand-written
// files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/run_file.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"
#include "tests/source_dir.h"

namespace coopdyn::client {
namespace {

namespace fs = std::filesystem;

constexpr int kSteps = 60;

/// A folder for one test.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("coopdyn-runs-" + std::to_string(getpid()))) {
    fs::create_directory(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The hash after each step; commands depend only on the step.
std::vector<std::string> Drive(Simulation& sim, Robot& robot, int steps) {
  std::vector<std::string> hashes;
  for (int i = 0; i < steps; ++i) {
    robot.set_velocity(0.2, std::sin(0.1 * static_cast<double>(sim.steps())));
    sim.step(1, 60);
    hashes.push_back(sim.hash());
  }
  return hashes;
}

/// Records kSteps of one robot in lockstep to `folder`/lesson1.run, downloaded from the daemon; returns their
/// hashes.
std::vector<std::string> Record(const Folder& folder) {
  fs::create_directory(folder.path() / "daemon");
  const auto daemon =
      ServerProcess::Real("classroom", {"--mode", "lockstep", "--recordings", folder / "daemon", "--set",
                                        "SCORE_1.kind=time", "--set", "SCORE_2.kind=distance"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  EXPECT_FALSE(sim.recording());
  EXPECT_EQ(sim.record("lesson1"), "lesson1.run");
  EXPECT_EQ(sim.recording()->name, "lesson1.run");
  std::vector<std::string> hashes = Drive(sim, robot, kSteps);
  sim.note("the end");
  const Recorded recorded = sim.stop_recording();
  EXPECT_EQ(recorded.name, "lesson1.run");
  EXPECT_TRUE(recorded.url.starts_with("http://127.0.0.1:")) << recorded.url;
  const std::vector<RunFile> files = sim.recordings();
  EXPECT_EQ(files.size(), 1u);
  EXPECT_EQ(files.at(0).steps, kSteps);
  EXPECT_EQ(files.at(0).url, recorded.url);
  EXPECT_FALSE(files.at(0).recording);
  EXPECT_EQ(sim.fetch_run("lesson1", folder / "lesson1.run"), folder / "lesson1.run");
  EXPECT_EQ(fs::file_size(folder / "lesson1.run"), static_cast<std::uintmax_t>(files.at(0).bytes));
  const Error never = ErrorOf([&] { sim.fetch_run("never", folder / "x.run"); });
  EXPECT_EQ(never.code(), 10);
  EXPECT_TRUE(never.text().starts_with("there is no recording never.run; there are: ")) << never.text();
  EXPECT_EQ(ErrorOf([&] { sim.fetch_run("lesson1", folder / "none/x.run"); }).code(), 5);
  EXPECT_FALSE(fs::exists(folder / "x.run"));
  EXPECT_EQ(ErrorOf([&] { sim.record("lesson1"); }).code(), 5);  // nothing is overwritten
  EXPECT_EQ(ErrorOf([&] { sim.record("no/name"); }).code(), 4);
  EXPECT_EQ(ErrorOf([&] { sim.playback(); }).code(), 5);
  return hashes;
}

/// The columns of a CSV file by name, without texts.
std::map<std::string, std::vector<double>> ReadCsv(const std::string& file) {
  std::ifstream in(file);
  std::string line, word;
  std::vector<std::string> names;
  std::getline(in, line);
  for (std::istringstream words(line); std::getline(words, word, ',');) names.push_back(word);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    for (std::size_t i = 0; std::getline(words, word, ','); ++i) {
      if (names.at(i) != "hash") columns[names.at(i)].push_back(std::strtod(word.c_str(), nullptr));
    }
  }
  return columns;
}

std::vector<double> Column(const RunRows& rows, std::size_t j) {
  std::vector<double> column;
  for (std::size_t i = 0; i < rows.size(); ++i) column.push_back(rows[i][j]);
  return column;
}

TEST(Recording, EveryNumberOfARunIsThatOfTheCsvExport) {
  const Folder folder;
  const std::vector<std::string> hashes = Record(folder);
  const auto run = read_run(folder / "lesson1.run");
  EXPECT_EQ(run.names(), std::vector<std::string>{"robot1"});
  EXPECT_EQ(run.steps().size(), kSteps + 1u);
  EXPECT_EQ(run.info().at("mode"), "lockstep");
  EXPECT_NE(run.scenario().find("[ROBOT"), std::string::npos);
  const std::vector<std::string> recorded = run.hash();
  EXPECT_EQ(std::vector<std::string>(recorded.begin() + 1, recorded.end()), hashes);
  EXPECT_EQ(run.events().back().text, "the end");
  EXPECT_EQ(run.events().back().step, kSteps);

  const std::string command = std::string(std::getenv("COOPDYN_BINARY")) + " export " +
                              (folder / "lesson1.run") + " --to csv --out " + (folder / "a.csv") +
                              " > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  auto csv = ReadCsv(folder / "a.csv");
  EXPECT_EQ(csv.at("time_s"), run.time());
  const RunRows pose = run.pose("robot1"), ball = run.pose_3d("BALL_1");
  const RunRows distances = run.reading("robot1", "distances"), targets = run.reading("robot1", "targets");
  const RunRows channels = run.reading("robot1", "channels"), commands = run.commands("robot1");
  EXPECT_EQ(csv.at("robot1.x_m"), Column(pose, 0));
  EXPECT_EQ(csv.at("robot1.y_m"), Column(pose, 1));
  const std::vector<double> headings = Column(pose, 2);
  ASSERT_EQ(csv.at("robot1.heading_rad").size(), headings.size());
  for (std::size_t i = 0; i < headings.size(); ++i)
    EXPECT_DOUBLE_EQ(csv.at("robot1.heading_rad")[i], headings[i]) << "by another arc tangent";
  EXPECT_EQ(csv.at("BALL_1.x_m"), Column(ball, 0));
  EXPECT_EQ(csv.at("BALL_1.qz"), Column(ball, 6));
  const std::vector<std::string> joints = run.joints("robot1");
  ASSERT_EQ(joints, (std::vector<std::string>{"left_wheel_joint", "right_wheel_joint"}));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    EXPECT_EQ(csv.at("robot1." + joints[i] + "_rad"), Column(channels, i));
    EXPECT_EQ(csv.at("robot1." + joints[i] + "_rad_s"), Column(channels, 2 + i));
    EXPECT_EQ(csv.at("robot1." + joints[i] + "_setpoint_rad_s"), Column(commands, 2 + i));
    EXPECT_EQ(Column(commands, 4 + i), std::vector<double>(kSteps + 1, 3)) << "velocities";
  }
  for (std::size_t i = 0; i < 11; ++i)
    EXPECT_EQ(csv.at("robot1.d" + std::to_string(i + 1) + "_m"), Column(distances, i));
  EXPECT_EQ(csv.at("robot1.red1_distance_m"), Column(targets, 0));
  EXPECT_EQ(csv.at("robot1.red1_bearing_rad"), Column(targets, 1));
  const RunRows way = run.score("distance");
  EXPECT_EQ(csv.at("time_s"), Column(way, 0));
  EXPECT_EQ(csv.at("score.distance_m"), Column(way, 1));
  EXPECT_GT(way[kSteps][1], 0.05);
  EXPECT_EQ(run.scores(),
            (std::map<std::string, double>{{"time", run.time().back()}, {"distance", way[kSteps][1]}}));
  EXPECT_TRUE(
      ErrorOf([&] { run.score("way"); }).text().ends_with("has no score way; there are time, distance"));
  ASSERT_EQ(commands.size(), kSteps + 1u);  // the start, and one with each step
  EXPECT_EQ(csv.at("step"), Column(commands, 0));
  EXPECT_EQ(csv.at("time_s"), Column(commands, 1));

  ASSERT_EQ(std::system((std::string(CLIENT_PLOT_RUN) + " " + (folder / "lesson1.run") + " robot1 > " +
                         (folder / "path.svg"))
                            .c_str()),
            0);
  std::ifstream svg(folder / "path.svg");
  const std::string drawn(std::istreambuf_iterator<char>(svg), {});
  EXPECT_NE(drawn.find("-1.5000,0.5000 "), std::string::npos) << drawn.substr(0, 300);
}

TEST(Recording, ATeamReadsARecordingAndDrivesAfterABranch) {
  const Folder folder;
  Record(folder);
  const auto daemon = ServerProcess::Command({"play", folder / "lesson1.run", "--paused"});
  auto sim = connect(daemon.server());
  auto all = sim.team();
  EXPECT_EQ(all.names(), std::vector<std::string>{"robot1"});
  all.close();
  auto team = sim.team(std::vector<std::string>{"robot1"});
  const auto run = read_run(folder / "lesson1.run");
  const auto pose = run.pose("robot1"), distances = run.reading("robot1", "distances");
  EXPECT_TRUE(Says(ErrorOf([&] { run.pose("Robot1"); }), "did you mean robot1? there are: robot1"));
  fs::copy_file(folder / "lesson1.run", folder / "lesson1.mat");
  const Error mat = ErrorOf([&] { read_run(folder / "lesson1.mat"); });
  EXPECT_TRUE(Says(mat, "MATLAB") && Says(mat, "lesson1.run")) << mat.text();
  for (const std::size_t k : {10, 40}) {
    sim.seek(0.01 * static_cast<double>(k));
    const TeamReading s = team.read();
    EXPECT_EQ(s.step, static_cast<std::int64_t>(k));
    ASSERT_EQ(s.distances.columns(), distances.columns());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(s.pose[0][i], pose[k][i], 1e-9);
    EXPECT_EQ(std::isinf(s.distances[0][5]), std::isinf(distances[k][5]));
  }
  const std::vector<double> v = {0.3, 0.0};
  for (const auto& drive : std::vector<std::function<void()>>{
           [&] { team.step(v); }, [&] { team.step_wheels(v); }, [&] { team.stop(); }}) {
    const Error refused = ErrorOf(drive);
    EXPECT_EQ(refused.code(), 5);
    EXPECT_TRUE(Says(refused, "playing a recording")) << refused.text();
  }
  sim.set_loop(true);
  sim.play();
  const std::int64_t before = team.read().step;
  EXPECT_NE(team.step({}, 60).step, before);
  sim.step(1, 60);
  sim.pause();
  sim.branch(0.5);
  sim.run();
  const double x = team.read().pose[0][0];
  TeamReading s;
  for (int i = 0; i < 5; ++i) s = team.step(v, 60);
  EXPECT_EQ(s.step, 55);
  EXPECT_NE(s.pose[0][0], x);
}

TEST(Recording, ABranchGoesOnWithTheSameHashesAndClients) {
  const Folder folder;
  const std::vector<std::string> hashes = Record(folder);
  const auto daemon = ServerProcess::Command({"play", folder / "lesson1.run", "--paused"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  const auto run = read_run(folder / "lesson1.run");
  sim.seek(0.4);
  EXPECT_EQ(sim.hash(), hashes.at(39));
  EXPECT_NEAR(robot.get_pose().x, run.pose("robot1")[40][0], 1e-9);
  const Error refused = ErrorOf([&] { robot.set_velocity(0.1, 0); });
  EXPECT_EQ(refused.code(), 5);
  EXPECT_TRUE(Says(refused, "playing a recording")) << refused.text();
  sim.skip(-10);
  EXPECT_EQ(sim.steps(), 30);
  const Playback playback = sim.playback();
  EXPECT_EQ(playback.file, "lesson1.run");
  EXPECT_FALSE(playback.playing);
  EXPECT_NEAR(playback.end_time, 0.01 * kSteps, 1e-9);
  sim.set_loop(true);
  sim.play(2);
  sim.step(2, 60);
  sim.set_play_speed(-1);
  EXPECT_EQ(sim.playback().speed, -1);
  EXPECT_TRUE(sim.playback().loop);
  EXPECT_EQ(ErrorOf([&] { sim.set_play_speed(0); }).code(), 4);
  sim.pause();
  sim.branch(0.2);
  EXPECT_EQ(sim.hash(), hashes.at(19));
  sim.run();
  EXPECT_EQ(Drive(sim, robot, kSteps - 20), std::vector<std::string>(hashes.begin() + 20, hashes.end()));
}

TEST(Recording, ASavedStateIsGoneOnFrom) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  Drive(sim, robot, 10);
  sim.save_state("here");
  const std::vector<std::string> first = Drive(sim, robot, 10);
  sim.restore_state("here");
  EXPECT_EQ(sim.steps(), 10);
  EXPECT_EQ(Drive(sim, robot, 10), first);
  bool found = false;
  for (const SavedState& state : sim.saved_states())
    found |= state.name == "here" && std::abs(state.time - 0.1) < 1e-9;
  EXPECT_TRUE(found);
  EXPECT_EQ(ErrorOf([&] { sim.restore_state("never"); }).code(), 10);
  sim.restore_state("start");
  EXPECT_EQ(sim.steps(), 0);
  auto other = connect(daemon.server(), {.name = "ben"});
  other.release_robot("robot1");
  EXPECT_EQ(ErrorOf([&] { other.robot(1).set_velocity(0.1, 0); }).code(), 0);
}

std::string Text(const RunRows& rows) {
  std::ostringstream out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out << (i == 0 ? "" : "; ");
    for (std::size_t j = 0; j < rows.columns(); ++j) out << (j == 0 ? "" : " ") << rows[i][j];
  }
  return out.str();
}

void WriteSample(const std::string& file) {
  const std::string command = "python3 " + SourceDir() + "/tests/clients/python/run_file.py " + file;
  ASSERT_EQ(std::system(command.c_str()), 0);
}

TEST(ReadRun, ThingsThatComeAndGoAreNanWhereTheyAreNot) {
  const Folder folder;
  WriteSample(folder / "a.run");
  const auto run = read_run(folder / "a.run");
  EXPECT_EQ(run.names(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(Text(run.pose("a")), "5 0 0; 5 1 0; nan nan nan; nan nan nan");
  EXPECT_EQ(Text(run.pose("b")), "6 0 0; 6 1 0; 8 2 0; 8 3 0");
  EXPECT_EQ(Text(run.reading("b", "distances")), "3 nan nan; 3 nan nan; 7 8 9; 7 8 9");
  EXPECT_EQ(Text(run.reading("b", "targets")), "3 4 nan nan; 3 4 nan nan; 7 8 5 6; 7 8 5 6");
  EXPECT_EQ(Text(run.commands("a")), "0 0 1 0 3 3; 1 0.01 1 1 3 3");
  EXPECT_EQ(Text(run.commands("b")), "0 0 2 0 3 3; 1 0.01 2 1 3 3; 2 0.02 3 2 3 3; 3 0.03 3 3 3 3");
  EXPECT_EQ(run.hash(), (std::vector<std::string>{"0000000000000000", "0000000000000000", "fffffffffffffffe",
                                                  "fffffffffffffffd"}));
  EXPECT_EQ(run.info().at("seed"), "18446744073709551615");
  EXPECT_EQ(run.events().at(0).text, "b alone");
  EXPECT_EQ(ErrorOf([&] { run.pose("c"); }).code(), 10);
  EXPECT_EQ(ErrorOf([&] { run.reading("a", "smell"); }).code(), 4);
}

/// Reads everything in a file; returns the error.
Error ReadAll(const std::string& file) {
  return ErrorOf([&] {
    const auto run = read_run(file);
    for (const std::string& name : run.names()) {
      run.pose(name);
      run.commands(name);
      run.joints(name);
      for (const char* what : {"distances", "targets", "channels"}) run.reading(name, what);
    }
    run.time();
    run.steps();
    run.hash();
    run.events();
    run.scenario();
  });
}

TEST(ReadRun, RowsThatADamagedPageHidesAreAnError) {
  const Folder folder;
  const auto without = [&](const std::string& sql) {
    WriteSample(folder / "a.run");
    const std::string command = "python3 -c 'import sqlite3; db = sqlite3.connect(\"" + (folder / "a.run") +
                                "\", isolation_level=None); db.executescript(\"" + sql + "\")'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    const Error error = ReadAll(folder / "a.run");
    std::filesystem::remove(folder / "a.run");
    EXPECT_EQ(error.code(), 7) << sql;
    return error;
  };
  EXPECT_TRUE(Says(without("DELETE FROM step WHERE step = 1"), "steps are missing"));
  EXPECT_TRUE(Says(without("UPDATE step SET poses = NULL WHERE step = 2"), "poses of step 2 are missing"));
  EXPECT_TRUE(Says(without("DELETE FROM step WHERE step = 0"), "steps are missing"))
      << "the scene begins there";
  const std::string ends =
      "INSERT INTO meta SELECT char(101, 110, 100, 115), char(115, 116, 101, 112, 32, 51, 32, 49);";
  EXPECT_TRUE(Says(without(ends + "DELETE FROM step WHERE step = 3"), "steps are missing")) << "step 3 1";
  EXPECT_TRUE(Says(without("DELETE FROM robot WHERE place = 0"), "")) << "its bodies name it";
}

TEST(ReadRun, ForeignDamagedAndMissingFilesAreErrorsThatSaySo) {
  const Folder folder;
  EXPECT_EQ(ErrorOf([&] { read_run(folder / "none.run"); }).code(), 10);
  std::ofstream(folder / "text.run") << std::string(3000, 'x');
  EXPECT_EQ(ReadAll(folder / "text.run").code(), 7);
  std::ofstream(folder / "empty.run");
  EXPECT_TRUE(Says(ReadAll(folder / "empty.run"), "no recording"));
  WriteSample(folder / "a.run");
  EXPECT_EQ(ReadAll(folder / "a.run").code(), 0);
  std::ifstream in(folder / "a.run", std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(in), {});
  int wrong = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    std::string bytes = whole;
    if (i % 2 == 0) {
      bytes.resize(whole.size() * i / 60);
    } else {
      const std::size_t at = (i * 7919 + 100) % (whole.size() - 4000);
      bytes.replace(at, 4000, std::string(4000, static_cast<char>(i * 5)));
    }
    std::ofstream(folder / "b.run", std::ios::binary | std::ios::trunc) << bytes;
    const Error error = ReadAll(folder / "b.run");
    if (error.code() == 0) continue;
    EXPECT_TRUE(error.code() == 7 || error.code() == 5) << error.text();
    ++wrong;
  }
  EXPECT_GT(wrong, 25);
}

}  // namespace
}  // namespace coopdyn::client
