// SPDX-License-Identifier: MIT
// Loads, creates and steps controllers as the `in` area says, and leaves the results in the `out` area. It
// runs in the controllers' process, or with `--controllers in-process` in the daemon: the same code, so the
// same results. One thread calls Run(); steps are shared out to a pool.
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
  /// Does not destroy the instances: kEnd does.
  ~Runner();

  /// Does the operation in the header.
  void Run(const Areas& areas, WorkerPool& pool);
  /// From now on, when `new` gets no memory, this process ends and says whose controller was at work.
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
  /// Steps all items, on as many workers as pay.
  void StepAll(WorkerPool& pool);
  /// Steps items until there are none left.
  void StepSome(std::size_t worker);
  void Step(std::uint32_t robot, Worker& worker);
  /// The same of one that is not asked in this step, as no exchange of its channel begins: it is only saved.
  void StepOver(std::uint32_t robot, Worker& worker);
  /// Step(), and adds its time to its file's.
  void TimedStep(std::uint32_t robot, Worker& worker);
  /// The instance's state into `place`, by way of memory with a guard.
  void Save(const Instance& instance, Place place, Worker& worker) const;
  void End();
  /// The robot's controller failed: `why` follows "controller NAME ".
  void Fail(std::uint32_t robot, const std::string& why) const;
  void Begin(std::size_t worker, std::uint32_t item) const;

  const Areas* areas_ = nullptr;                      // in Run()
  std::vector<std::optional<Plugin>> plugins_;        // by file
  std::vector<std::unique_ptr<Instance>> instances_;  // by robot; null: none
  std::vector<Worker> workers_;
  std::atomic<std::size_t> next_{0};  // item that nobody has begun
  Nanoseconds item_time_ = 0;         // that an item took in the last step
  bool timed_ = false;                // the present step: each robot's is timed
};

}  // namespace coopdyn
