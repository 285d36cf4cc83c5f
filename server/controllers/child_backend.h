// SPDX-License-Identifier: MIT
// Controllers in a process of their own. When it dies or hangs, the robot whose controller was at work is
// stopped. A new process gets the state of all the others and finishes what was begun: for them it is as if
// nothing had happened. The stepping thread only.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/controllers/backend.h"
#include "server/controllers/child_process.h"
#include "server/controllers/same_core.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

class ChildBackend final : public Backend {
 public:
  /// When this many robots with one controller have crashed in one step, or hung since the start, it is
  /// stopped on all robots: each crash takes a new process, each hang the deadline.
  static constexpr int kMaxCrashes = 16;
  static constexpr int kMaxHangs = 3;

  struct Options {
    std::shared_ptr<ChildLauncher> launcher;         // of the child; shared by all that a host runs
    int threads = 1;                                 // of the child
    Nanoseconds deadline = 0;                        // wall clock for one robot's step; 0: none
    const std::atomic<bool>* interrupted = nullptr;  // true: the daemon ends, wait for nothing; may be null
    Nanoseconds silence = 0;  // wall clock for a process with no controller at work, as when it starts
  };
  /// The areas and the clock outlive it. The process starts with the first Run().
  ChildBackend(Areas& areas, Options options, const Clock& clock, Logger logger);
  /// Lets the controllers destroy their instances, if they do it quickly, and ends the process.
  ~ChildBackend() override;

  std::vector<Casualty> Run(Operation operation, std::span<const std::uint32_t> items) override;
  void Rest() override;
  void Drop(std::uint32_t robot) override { robot_out_[robot] = true; }
  double child_cpu_s() const override { return dead_cpu_s_ + (process_ ? process_->cpu_s() : 0); }
  int child_pid() const override { return process_ ? process_->pid() : -1; }

 private:
  /// How the process was lost, and with what in hand.
  struct Loss {
    bool by_others = false;  // no controller needs to have had a part in it
    bool hung = false;
    std::string why;
    std::vector<std::uint32_t> suspects;
  };

  /// Has the child do it. When the process is lost meanwhile: how.
  std::optional<Loss> Send(Operation operation, std::span<const std::uint32_t> items, int workers);
  /// Bit w: worker w has had the same item in hand for longer than the deadline.
  std::uint64_t StuckWorkers(Nanoseconds now);
  Loss Bury(std::uint64_t stuck_workers);
  bool IsInterrupted() const { return options_.interrupted != nullptr && options_.interrupted->load(); }

  /// Starts a process with all that the last one had.
  std::optional<Loss> Start();
  /// Stops those who are to blame for a loss, if that is known.
  void Judge(const Loss& loss);
  void BlameRobot(std::uint32_t robot, const Loss& loss);
  void StopFile(std::uint32_t file, const std::string& why);
  void StopRobot(std::uint32_t robot, const std::string& why);
  /// Stops all that the operation is about.
  void StopAll(const std::string& why);
  bool IsOpen(std::uint32_t item) const;
  bool IsDone(Operation operation, std::uint32_t item) const;

  struct FileState {
    bool out = false;
    int crashes = 0;  // in this Run()
    int hangs = 0;
  };
  struct WorkerWatch {
    std::uint64_t word = 0;
    std::uint64_t changes = 0;  // of the word, as far as they were seen
    Nanoseconds same_for = 0;
  };

  Areas& areas_;
  const Options options_;
  const Clock& clock_;
  const Logger logger_;
  std::unique_ptr<ChildProcess> process_;
  std::optional<SameCore> same_core_;  // with process_
  std::uint32_t ticket_ = 0;
  double dead_cpu_s_ = 0;
  std::vector<FileState> files_;
  std::vector<bool> robot_out_;
  // In this Run():
  Operation operation_ = Operation::kLoad;
  std::vector<std::uint32_t> open_;  // items to do
  std::vector<Casualty> casualties_;
  std::vector<std::uint32_t> suspected_;  // of steps
  bool trial_ = false;                    // steps are done one at a time
  // Over all:
  int losses_ = 0, calm_steps_ = 0;  // lost since somebody was to blame; steps since the last of them
  std::array<WorkerWatch, kMaxWorkers> watch_{};
  Nanoseconds watched_at_ = 0;
  Nanoseconds idle_for_ = 0;  // no worker has anything in hand, and no reply
};

}  // namespace coopdyn
