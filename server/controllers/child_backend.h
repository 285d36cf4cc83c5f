// SPDX-License-Identifier: MIT
// Controllers in a process of their own. If it dies or hangs, the robot whose controller was at work is
// stopped, a new process gets the state of all the others, and what was not finished is: for the other robots
// it is as if nothing had happened. The stepping thread only.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/controllers/backend.h"
#include "server/controllers/child_process.h"
#include "server/controllers/same_core.h"

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
    const std::atomic<bool>* interrupted = nullptr;  // true: what takes long is given up; may be null
    Nanoseconds silence = 0;  // wall clock, for a process that has nothing in hand, as when it starts
  };
  /// The areas and the clock outlive it. The process starts with the first Run().
  ChildBackend(Areas& areas, Options options, const Clock& clock, Logger logger);
  /// Lets the controllers destroy their instances, if they do it quickly, and ends the process.
  ~ChildBackend() override;

  std::vector<Casualty> Run() override;
  void Rest() override;
  void Drop(std::uint32_t robot) override;
  double child_cpu_s() const override;
  /// Of the child; -1: there is none now.
  pid_t pid() const { return process_ ? process_->pid() : -1; }

 private:
  /// An operation on a list of items, as Run() found it in the header.
  struct Order {
    Operation operation = Operation::kLoad;
    std::vector<std::uint32_t> items;
  };
  /// How the process was lost, and with what in hand.
  struct Loss {
    bool by_others = false;  // no controller needs to have had a part in it
    bool hung = false;
    std::string why;
    std::vector<std::uint32_t> suspects;
  };

  /// Has the child do it; false: the process is lost, `loss_` tells how.
  bool Send(Operation operation, Place items, std::size_t count, int workers);
  bool SendList(Operation operation, const std::vector<std::uint32_t>& items, int workers);
  bool Await(std::uint32_t ticket);
  /// Lets it wait in the areas that there are now, if they are others than before.
  void Move();
  bool IsInterrupted() const { return options_.interrupted != nullptr && options_.interrupted->load(); }
  /// Bit w: worker w has had the same item in hand for longer than the deadline.
  std::uint64_t StuckWorkers(Nanoseconds now);
  void Bury(std::uint64_t stuck_workers);

  /// Brings the order to its end after the process was lost, or before it was started.
  void Finish(const Order& order);
  /// A new process, with all that the lost one had. False: it was lost too.
  bool Revive(const Order& order);
  /// Finds out whom the loss is to be blamed on. `alone`: the item was tried by itself.
  void Judge(const Order& order, Operation operation, bool alone);
  void BlameRobot(std::uint32_t robot, const Loss& loss);
  void StopFile(const Order& order, std::uint32_t file, const std::string& why);
  void StopRobot(std::uint32_t robot, const std::string& why);
  void StopAll(const Order& order, const std::string& why);
  /// Notes which of the order's items are complete.
  void NoteDone(const Order& order);
  bool IsOpen(const Order& order, std::uint32_t item) const;
  bool IsDone(Operation operation, std::uint32_t item) const;

  /// What the areas were laid out for.
  struct Shape {
    std::uint32_t readings = 0, state_size = 0, option_count = 0;
    static Shape Of(const FileResult& result) {
      return {result.readings, result.state_size, result.option_count};
    }
    bool operator==(const Shape&) const = default;
  };
  struct FileState {
    bool loaded = false, out = false;
    Shape shape;
    int crashes = 0;  // in this Run()
    int hangs = 0;
  };
  struct RobotState {
    bool created = false, out = false;
  };
  struct WorkerWatch {
    std::uint64_t word = 0;
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
  std::vector<RobotState> robots_;
  std::vector<Casualty> casualties_;  // of this Run()
  std::deque<std::uint32_t> alone_;   // to be tried by themselves, in this Run()
  int unexplained_ = 0;               // losses without anybody to blame, in this Run()
  int losses_ = 0, calm_steps_ = 0;   // lost since somebody was to blame; steps since the last of them
  std::optional<Loss> loss_;
  std::array<WorkerWatch, kMaxWorkers> watch_{};
  Nanoseconds watched_at_ = 0;
  Nanoseconds idle_for_ = 0;  // no worker has anything in hand, and no reply
};

}  // namespace coopdyn
