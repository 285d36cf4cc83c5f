// SPDX-License-Identifier: MIT
// Where controllers run: in this process or in a child. The stepping thread (holder of the baton) only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

/// The two areas of a set of controllers; everything in `in` is ready before an operation is run.
struct Areas {
  SharedArea in, out;
  Place spare_items = 0;  // in `in`: room for as many items as there are files or robots
  SharedArea left;        // the `in` where the child still waits, if that is another now

  /// Larger ones with the same contents; pointers into them are void. Throws std::system_error.
  void Grow(std::size_t in_bytes, std::size_t out_bytes) {
    if (in_bytes <= in.bytes() && out_bytes <= out.bytes()) return;
    SharedArea larger_in = Larger(in, in_bytes, SharedArea::Others::kRead);
    if (out_bytes > out.bytes()) out = Larger(out, out_bytes, SharedArea::Others::kWrite);
    std::swap(in, larger_in);
    if (left.data() == nullptr) left = std::move(larger_in);
  }

  InHeader& header() const { return *in.At<InHeader>(0); }
  RobotSetup& setup(std::uint32_t robot) const { return in.At<RobotSetup>(header().robots)[robot]; }
  const RobotResult& result(std::uint32_t robot) const {
    return out.At<RobotResult>(header().robot_results)[robot];
  }
  const FileResult& file_result(std::uint32_t file) const {
    return out.At<FileResult>(header().file_results)[file];
  }

 private:
  static SharedArea Larger(const SharedArea& area, std::size_t bytes, SharedArea::Others others) {
    SharedArea larger(std::max(bytes, area.bytes()), others);
    std::memcpy(larger.data(), area.data(), area.bytes());
    return larger;
  }
};

/// Items that took their process with them.
struct Casualty {
  std::uint32_t item = 0;  // robot; of kLoad: file
  std::string why;         // follows "controller NAME "
};

class Backend {
 public:
  virtual ~Backend() = default;
  /// Does the operation in the header to its end. Those of its items that are not casualties have their
  /// result in the `out` area. kCreate and kStep may bring casualties that are not among the items.
  virtual std::vector<Casualty> Run() = 0;
  /// No step follows at once: lets go what is held for the next one.
  virtual void Rest() {}
  /// The robot's controller is not needed any more.
  virtual void Drop(std::uint32_t robot) = 0;
  /// CPU time used outside this process, s.
  virtual double child_cpu_s() const = 0;
};

class InProcessBackend final : public Backend {
 public:
  /// Both outlive it.
  InProcessBackend(Areas& areas, WorkerPool& pool);
  ~InProcessBackend() override;
  std::vector<Casualty> Run() override;
  void Drop(std::uint32_t robot) override;
  double child_cpu_s() const override { return 0; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
