// SPDX-License-Identifier: MIT
// Recorded runs to export, with their exact frames.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "server/model/readers.h"
#include "server/physics/simulation.h"
#include "server/record/recorder.h"
#include "server/record/run_reader.h"
#include "server/replay/export_file.h"
#include "server/sensing/channel_filters.h"
#include "tests/server/base/temp_folder.h"
#include "tests/server/state/wheels.h"
#include "tests/source_dir.h"

namespace coopdyn {

/// Two robots, two red targets and a green one, a box that one robot pushes and a wall.
inline const std::string& PushingScenario() {
  static const std::string text = R"(# Grüße: 10 € für den Ersten
[TARGET]
red 3 0
green 1 -2
red 0 2.5
[ROBOT_1]
type coopbot
name robot1
position 0 0
orientation 10deg
[ROBOT_2]
type coopbot
name robot2
position 0 1.5
[BOX_1]
type box
size 0.2 0.2 0.2
mass 0.5kg
position 0.4 0.07
[BALL]
type sphere
size 0.2
mass 0.1kg
position -2 -2
[WALL_1]
type box
size 0.2 4 0.5
position 2 0
)";
  return text;
}

struct RunToMake {
  std::string scenario = PushingScenario();
  int steps = 40;
  RecordWhat what{true, true, true, true};
  Nanoseconds pose_every = 0;
  std::uint64_t keyframe_steps = 16;
  std::vector<Event> events = {};
};

class ExportTest : public testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }
  /// The sorted names of all files in the test's folder.
  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
  static std::string Text(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  void Put(const std::string& name, const std::string& text) const { folder_.Write(name, text); }
  static SearchPath Path() {
    SearchPath path;
    path.folders.emplace_back(SourceDir());
    return path;
  }

  /// The set-points of the robots from step `step` on: a client changes them every tenth step.
  static WheelSpeeds SetpointAt(std::uint64_t step, std::size_t robot) {
    const double phase = static_cast<double>(step / 10);
    return {4 + phase / 3 + static_cast<double>(robot), 4 - phase / 7};
  }
  static bool Commands(std::uint64_t step) { return step % 10 == 0; }

  /// Records a run of 10 ms steps into run.run: the given frames, from step 0 on.
  std::vector<FramePtr> Record(const RunToMake& make = {}) {
    static RobotLibrary library(Path());  // reads the models once for all tests
    Diagnostics diagnostics;
    const auto scenario = ReadScenario(make.scenario, "lesson.scenario", library, false, diagnostics);
    EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
    WorkerPool pool(1);
    const auto run =
        Simulation::Build(MakeScene(scenario), 1, 1, {&pool, nullptr, AdvanceFilters}, clock_, diagnostics);
    EXPECT_NE(run, nullptr) << diagnostics.ToString();
    RecorderOptions options;
    options.file = File("run.run");
    options.what = make.what;
    options.pose_every = make.pose_every;
    options.keyframe_steps = make.keyframe_steps;
    options.version = "0.1.0";
    Recorder recorder(options, clock_, NullLogger());
    EXPECT_EQ(recorder.Check(), "");
    const auto save = [&] {
      auto state = std::make_shared<SavedState>(run->Save());
      state->mode = Mode::kLockstep;
      return state;
    };
    recorder.Begin(save());
    std::vector<FramePtr> frames{run->frame()};
    std::vector<WheelSpeeds> wheels(run->scene().robots.size());
    for (int i = 0; i < make.steps; ++i) {
      const std::uint64_t step = run->frame()->step + 1;
      const std::vector<std::uint8_t> commanded(wheels.size(), Commands(step) ? 1 : 0);
      for (std::size_t k = 0; Commands(step) && k < wheels.size(); ++k) wheels[k] = SetpointAt(step, k);
      const bool keyframe = recorder.WantsKeyframe(step);
      std::vector<Setpoint> setpoints = ByChannel(wheels);
      run->Step(kDefaultStep, {setpoints, {}, commanded});
      recorder.Step(run->frame(), Mode::kLockstep, keyframe ? save() : nullptr, 0);
      frames.push_back(run->frame());
    }
    for (const Event& event : make.events) recorder.Note(event);
    recorder.Close();
    EXPECT_EQ(recorder.status().failure, "");
    return frames;
  }

  /// The reader of run.run, with its scenario loaded.
  std::unique_ptr<RunReader> Open() {
    std::string error;
    auto reader = RunReader::Open(File("run.run"), error);
    EXPECT_NE(reader, nullptr) << error;
    Diagnostics diagnostics;
    EXPECT_NE(reader->LoadScenario(Path(), diagnostics), nullptr) << diagnostics.ToString();
    return reader;
  }

 private:
  const TempFolder folder_;
  SteadyClock clock_;
};

/// During its lifetime no file can grow beyond `bytes`, as on a full disk.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  using Handler = void (*)(int);
  rlimit before_{};
  Handler handler_;
};

/// A CSV file without quotes.
struct Table {
  explicit Table(const std::string& text) {
    std::istringstream stream(text);
    std::string line;
    std::getline(stream, line);
    for (const std::string& name : Split(line)) {
      column_of.emplace(name, names.size());
      names.push_back(name);
    }
    while (std::getline(stream, line)) rows.push_back(Split(line));
  }
  static std::vector<std::string> Split(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
    return words;
  }
  double Number(std::size_t row, const std::string& name) const {
    return std::strtod(rows.at(row).at(column_of.at(name)).c_str(), nullptr);
  }

  std::vector<std::string> names;
  std::map<std::string, std::size_t> column_of;
  std::vector<std::vector<std::string>> rows;
};

}  // namespace coopdyn
