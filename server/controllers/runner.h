// SPDX-License-Identifier: MIT
// Loads, creates and steps controllers as the `in` area orders and leaves the results in the `out` area. Runs
// in the controllers' process or, with `--controllers in-process`, in the daemon: the same code, so the same
// results. One thread calls Run(), which distributes steps to a pool.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/worker_pool.h"
#include "server/controllers/plugin.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

struct Instance;

class Runner {
 public:
  Runner();
  /// Does not destroy the instances; kEnd does.
  ~Runner();

  /// Runs the operation in the header.
  void Run(const Areas& areas, WorkerPool& pool);
  /// From now on, if `new` fails, this process notes the item that was running and exits.
  static void EndWithoutMemory();

 private:
  struct Worker;

  template <typename T>
  const T* In(Place place) const {
    return areas_->in.At<T>(place);
  }
  const InHeader& header() const { return areas_->header(); }

  void Load(std::uint32_t file);
  void Create(std::uint32_t robot, Worker& worker);
  /// Steps all items, on several workers if that is faster.
  void StepAll(WorkerPool& pool);
  /// Steps items until there are none left.
  void StepSome(std::size_t worker);
  void Step(std::uint32_t robot, Worker& worker);
  /// Only saves the instance, in a step that begins no exchange of the robot's channel.
  void StepOver(std::uint32_t robot, Worker& worker);
  /// Calls Step() and adds its time to that of the robot's file.
  void TimedStep(std::uint32_t robot, Worker& worker);
  /// Saves the instance's state to `place`, through a guarded buffer.
  void Save(const Instance& instance, Place place, Worker& worker) const;
  void End();
  /// The robot's controller failed: `why` follows "controller NAME ".
  void Fail(std::uint32_t robot, const std::string& why) const;
  void Begin(std::size_t worker, std::uint32_t item) const;

  const Areas* areas_ = nullptr;                      // during Run()
  std::vector<std::optional<Plugin>> plugins_;        // by file
  std::vector<std::unique_ptr<Instance>> instances_;  // by robot; may be null
  std::vector<Worker> workers_;
  std::atomic<std::size_t> next_{0};  // first item not begun
  Nanoseconds item_time_ = 0;         // average per item in the last step
  bool timed_ = false;                // each robot's step is timed in this step
};

}  // namespace coopdyn
