// SPDX-License-Identifier: MIT
// Runs controllers in a child process. When the process dies or hangs, stops the robot whose controller was
// running. A new process restores the state of all other controllers and finishes the operation, so they do
// not notice. Used only by the stepping thread.
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
  /// A controller that crashes on this many robots in one step, or hangs on this many since the start, is
  /// stopped on all robots: each crash costs a new process, each hang the deadline.
  static constexpr int kMaxCrashes = 16;
  static constexpr int kMaxHangs = 3;

  struct Options {
    std::shared_ptr<ChildLauncher> launcher;         // starts the child; shared by all sets of a host
    int threads = 1;                                 // of the child
    Nanoseconds deadline = 0;                        // wall clock for one robot's step; 0: none
    const std::atomic<bool>* interrupted = nullptr;  // true: the daemon shuts down, do not wait; may be null
    Nanoseconds silence = 0;  // wall clock limit while no controller runs, as at the start
  };
  /// The areas and the clock must outlive it. The first Run() starts the process.
  ChildBackend(Areas& areas, Options options, const Clock& clock, Logger logger);
  /// Gives the controllers a short time to destroy their instances, then ends the process.
  ~ChildBackend() override;

  std::vector<Casualty> Run(Operation operation, std::span<const std::uint32_t> items) override;
  void Rest() override;
  void Drop(std::uint32_t robot) override { robot_out_[robot] = true; }
  double child_cpu_s() const override { return dead_cpu_s_ + (process_ ? process_->cpu_s() : 0); }
  int child_pid() const override { return process_ ? process_->pid() : -1; }

 private:
  /// How the process was lost, and the items it was running.
  struct Loss {
    bool by_others = false;  // killed from outside: perhaps no controller is to blame
    bool hung = false;
    std::string why;
    std::vector<std::uint32_t> suspects;
  };

  /// Makes the child run the operation. Returns a loss if the process is lost meanwhile.
  std::optional<Loss> Send(Operation operation, std::span<const std::uint32_t> items, int workers);
  /// Bit w is set if worker w has run the same item for longer than the deadline.
  std::uint64_t StuckWorkers(Nanoseconds now);
  Loss Bury(std::uint64_t stuck_workers);
  bool IsInterrupted() const { return options_.interrupted != nullptr && options_.interrupted->load(); }

  /// Starts a process and restores the files and robots of the last one.
  std::optional<Loss> Start();
  /// Stops the items to blame for a loss, if known.
  void Judge(const Loss& loss);
  void BlameRobot(std::uint32_t robot, const Loss& loss);
  void StopFile(std::uint32_t file, const std::string& why);
  void StopRobot(std::uint32_t robot, const std::string& why);
  /// Stops all items of the operation.
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
    std::uint64_t changes = 0;  // observed changes of the word
    Nanoseconds same_for = 0;
  };

  Areas& areas_;
  const Options options_;
  const Clock& clock_;
  const Logger logger_;
  std::unique_ptr<ChildProcess> process_;
  std::optional<SameCore> same_core_;  // set while process_ is
  std::uint32_t ticket_ = 0;
  double dead_cpu_s_ = 0;
  std::vector<FileState> files_;
  std::vector<bool> robot_out_;
  // In this Run():
  Operation operation_ = Operation::kLoad;
  std::vector<std::uint32_t> open_;  // items not done yet
  std::vector<Casualty> casualties_;
  std::vector<std::uint32_t> suspected_;  // robots suspected of losses in steps
  bool trial_ = false;                    // run one robot at a time
  // Across calls:
  int losses_ = 0, calm_steps_ = 0;  // losses without a culprit in a row; steps since the last of them
  std::array<WorkerWatch, kMaxWorkers> watch_{};
  Nanoseconds watched_at_ = 0;
  Nanoseconds idle_for_ = 0;  // time without a running item or a reply
};

}  // namespace coopdyn
