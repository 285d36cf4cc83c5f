// SPDX-License-Identifier: MIT
// Runs to repeat: a live run, recorded as by the daemon, whose steps a test controls, and its file. A run
// steps on its own thread, and ends before a test repeats it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/controllers/controller_host.h"
#include "server/model/drive.h"
#include "server/model/readers.h"
#include "server/physics/stepper.h"
#include "server/record/recorder.h"
#include "server/record/run_reader.h"
#include "server/record/sqlite_db.h"
#include "server/replay/state_at.h"
#include "server/sensing/channel_filters.h"
#include "tests/server/base/temp_folder.h"
#include "tests/source_dir.h"

namespace coopdyn {

inline SearchPath TestPath() {
  SearchPath path;
  path.folders.emplace_back(SourceDir());
  path.folders.emplace_back(std::filesystem::path(SAMPLE_CONTROLLERS).parent_path());
  path.folders.emplace_back(TEST_CONTROLLERS);
  return path;
}

inline ControllerOptions TestControllers(int threads = 1) {
  ControllerOptions options;
  options.program = CONTROLLERS_TEST_CHILD;
  options.threads = threads;
  return options;
}

/// Everything that a repetition needs.
struct Repeating {
  explicit Repeating(int threads = 1)
      : logger(NullLogger()),
        pool(threads),
        services{clock, logger, pool, TestControllers(threads), TestPath()} {}

  SteadyClock clock;
  Logger logger;
  WorkerPool pool;
  ReplayServices services;
};

struct LiveOptions {
  RecordWhat what{false, false, false, true};
  std::uint64_t keyframe_steps = 50;
  std::uint64_t seed = 1;
  int threads = 1;
};

/// A run in free mode that steps only when the test asks for it.
class LiveRun {
 public:
  LiveRun(const std::string& file, const std::string& scenario, LiveOptions options = {})
      : LiveRun(file, options) {
    static RobotLibrary library(TestPath());  // reads the models once for all tests
    Diagnostics diagnostics;
    const auto read = ReadScenario(scenario, "lesson.scenario", library, false, diagnostics, options.seed);
    if (read == nullptr || !stepper_.Start(read, diagnostics)) {
      throw std::runtime_error(diagnostics.ToString());
    }
    Begin();
  }
  /// Continues from `state`.
  LiveRun(const std::string& file, const SavedStatePtr& state, LiveOptions options = {})
      : LiveRun(file, options) {
    Diagnostics diagnostics;
    if (!stepper_.StartFrom(state, diagnostics)) throw std::runtime_error(diagnostics.ToString());
    Begin();
  }
  ~LiveRun() { End(); }

  FramePtr frame() const { return frames_.Latest(); }
  /// Sets commands for the next step.
  void Command(const std::string& robot, double left_rad_s, double right_rad_s) {
    const Verdict verdict =
        board_.Command(board_.FindSlot(robot), client_, SetpointsFor({left_rad_s, right_rad_s}), std::nullopt,
                       [](const StepResult&) {});
    EXPECT_EQ(verdict.error, Error::kOk) << verdict.text;
  }
  void Send(const std::string& robot, const std::vector<double>& values) {
    RobotMessage message;
    message.count = static_cast<std::uint32_t>(values.size());
    std::copy(values.begin(), values.end(), message.values.begin());
    EXPECT_EQ(board_.Send(board_.FindSlot(robot), client_, message).error, Error::kOk);
  }
  void Step(int count = 1) {
    auto done = std::make_shared<std::promise<void>>();
    std::future<void> ran = done->get_future();
    edits_.Push({edit::Step{count}, [](const EditResult& refused) { ADD_FAILURE() << refused.text; },
                 [done](const StepResult&) { done->set_value(); }});
    bell_.Ring();
    ran.wait();
  }
  EditResult Apply(EditAction action) {
    auto answer = std::make_shared<std::promise<EditResult>>();
    std::future<EditResult> result = answer->get_future();
    edits_.Push({std::move(action), [answer](const EditResult& r) { answer->set_value(r); }});
    bell_.Ring();
    return result.get();
  }
  /// Hash of the newest frame.
  std::uint64_t hash() const { return StateHash(*frame()); }
  std::vector<Event> events() const { return control_.events(); }

  /// Ends the run and its recording.
  void End() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    bell_.Ring();
    thread_.join();
    recorder_.Close();
    EXPECT_EQ(recorder_.status().failure, "");
  }

 private:
  LiveRun(const std::string& file, const LiveOptions& options)
      : pool_(options.threads),
        controllers_(TestControllers(options.threads), clock_, NullLogger(), pool_),
        recorder_(RecordOptionsOf(file, options), clock_, NullLogger()),
        stepper_({frames_, board_, edits_, control_, bell_}, clock_, NullLogger(), RunOptionsOf(options),
                 {&pool_, &controllers_, AdvanceFilters}) {}

  static RecorderOptions RecordOptionsOf(const std::string& file, const LiveOptions& options) {
    RecorderOptions record;
    record.file = file;
    record.what = options.what;
    record.keyframe_steps = options.keyframe_steps;
    record.version = "test";
    return record;
  }
  static RunOptions RunOptionsOf(const LiveOptions& options) {
    RunOptions run;
    run.mode = Mode::kFree;
    run.paused = true;
    run.seed = options.seed;
    return run;
  }
  void Begin() {
    thread_ = std::jthread([this](const std::stop_token& stop) { stepper_.Run(stop); });
    Apply(edit::SetJournal{&recorder_});
  }

  const Client client_{1, "ana", "test"};
  SteadyClock clock_;
  WorkerPool pool_;
  Doorbell bell_;
  FrameBoard frames_;
  CommandBoard board_;
  EditQueue edits_{bell_};
  RunControl control_;
  ControllerHost controllers_;
  Recorder recorder_;
  Stepper stepper_;
  std::jthread thread_;
};

/// Changes a recording like a disk fault.
class Tamper {
 public:
  explicit Tamper(const std::string& file) {
    std::string error;
    database_ = Database::Open(file, Database::Access::kReadWrite, error);
    if (database_ == nullptr) throw std::runtime_error(error);
  }
  void Run(const std::string& sql) { ASSERT_TRUE(database_->Try(sql)) << database_->error(); }
  /// Flips bit `bit` of the blob that `select` finds, and writes it back with `update`, bound to its ?1.
  void FlipBit(const std::string& select, const std::string& update, std::size_t bit) {
    Statement read = database_->Prepare(select);
    ASSERT_TRUE(read.Step()) << select;
    const std::span<const std::byte> found = read.blob(0);
    std::vector<std::byte> blob(found.begin(), found.end());
    read.Reset();
    ASSERT_LT(bit / 8, blob.size());
    blob[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    database_->Prepare(update).Run(blob);
  }
  void FlipCommand(std::uint64_t step, std::size_t bit) {
    const std::string where = " WHERE step = " + std::to_string(step);
    FlipBit("SELECT commands FROM step" + where, "UPDATE step SET commands = ?1" + where, bit);
  }

 private:
  std::unique_ptr<Database> database_;
};

}  // namespace coopdyn
