// SPDX-License-Identifier: MIT
#include "server/controllers/child_backend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <optional>
#include <utility>

#include "server/controllers/futex.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kMillisecond = 1'000'000;
constexpr Nanoseconds kLongestSlice = 20 * kMillisecond;  // between two looks at how the child is
constexpr Nanoseconds kEndTime = 200 * kMillisecond;      // for the instances to be destroyed
constexpr Nanoseconds kLastWait = 100 * kMillisecond;     // for a step when the daemon ends
constexpr int kMaxUnexplained = 5;
constexpr int kMaxLosses = 8;    // of the process with nobody to blame,
constexpr int kCalmSteps = 100;  // with fewer steps in between

/// By its own word, or by a crash when it had nearly all that it may have: few programs check for NULL.
bool RanOutOfMemory(const ChildEnd& end, std::uint64_t memory_bytes) {
  if (memory_bytes == 0) return false;
  if (end.signal == 0) return end.exit_code == kOutOfMemoryExit;
  const bool crashed = end.signal == SIGSEGV || end.signal == SIGBUS || end.signal == SIGABRT;
  return crashed && end.memory_bytes >= memory_bytes / 10 * 9;
}

/// Steps of this many robots are taken in turns with the child on one core.
constexpr std::size_t kFew = 512;

}  // namespace

ChildBackend::ChildBackend(Areas& areas, Options options, const Clock& clock, Logger logger)
    : areas_(areas), options_(std::move(options)), clock_(clock), logger_(std::move(logger)) {}

ChildBackend::~ChildBackend() {
  if (!process_) return;
  Move();
  InHeader& header = areas_.header();
  header.operation = Operation::kEnd;
  header.item_count = 0;
  same_core_->Free();
  header.go.store(++ticket_, std::memory_order_release);
  FutexWake(header.go);
  // When it answers, the controllers are destroyed and unloaded. What a process then takes to end is longer
  // than all the rest of a reset.
  const std::atomic<std::uint32_t>& reply = areas_.out.At<OutHeader>(0)->reply;
  for (Nanoseconds waited = 0; waited < kEndTime; waited += kMillisecond) {
    const std::uint32_t seen = reply.load(std::memory_order_acquire);
    if (seen == ticket_) {
      process_->Leave();
      return;
    }
    if (waited > 0 && process_->Ended()) return;
    FutexWait(reply, seen, kMillisecond);
  }
}

std::vector<Casualty> ChildBackend::Run() {
  const InHeader& header = areas_.header();
  const Operation operation = header.operation;
  const Place items = header.items;
  const std::size_t count = header.item_count;
  loss_.reset();
  if (process_ && operation == Operation::kStep && Send(operation, items, count, options_.threads)) {
    if (losses_ > 0 && ++calm_steps_ >= kCalmSteps) losses_ = 0;
    return {};
  }

  Order order{operation, {}};
  const std::uint32_t* listed = areas_.in.At<std::uint32_t>(items);
  order.items.assign(listed, listed + count);
  files_.resize(std::max<std::size_t>(files_.size(), header.file_count));
  robots_.resize(std::max<std::size_t>(robots_.size(), header.robot_count));
  casualties_.clear();
  alone_.clear();
  unexplained_ = 0;
  for (FileState& file : files_) file.crashes = 0;
  if (loss_) {
    NoteDone(order);
    if (!IsInterrupted()) Judge(order, operation, false);
  }
  Finish(order);
  return std::exchange(casualties_, {});
}

void ChildBackend::Rest() {
  if (same_core_) same_core_->Leave();
}

void ChildBackend::Drop(std::uint32_t robot) {
  robots_[robot].out = true;
}

double ChildBackend::child_cpu_s() const {
  return dead_cpu_s_ + (process_ ? process_->cpu_s() : 0);
}

void ChildBackend::Move() {
  if (areas_.left.data() == nullptr) return;
  const SharedArea left = std::exchange(areas_.left, SharedArea());
  if (!process_->HandOver(areas_.in.fd(), areas_.out.fd())) return;  // it will be seen to have ended, or hang
  InHeader& old = *left.At<InHeader>(0);
  old.operation = Operation::kMove;
  old.go.store(~ticket_, std::memory_order_release);
  FutexWake(old.go);
}

bool ChildBackend::Send(Operation operation, Place items, std::size_t count, int workers) {
  Move();
  InHeader& header = areas_.header();
  header.operation = operation;
  header.items = items;
  header.item_count = static_cast<std::uint32_t>(count);
  header.workers = static_cast<std::uint32_t>(workers);
  // A few robots' step takes less time than waking another core does.
  if (operation == Operation::kStep && count <= kFew) {
    same_core_->Take();
  } else {
    same_core_->Free();
  }
  header.go.store(++ticket_, std::memory_order_release);
  FutexWake(header.go);
  return Await(ticket_);
}

bool ChildBackend::SendList(Operation operation, const std::vector<std::uint32_t>& items, int workers) {
  std::copy(items.begin(), items.end(), areas_.in.At<std::uint32_t>(areas_.spare_items));
  return Send(operation, areas_.spare_items, items.size(), workers);
}

bool ChildBackend::Await(std::uint32_t ticket) {
  const std::atomic<std::uint32_t>& reply = areas_.out.At<OutHeader>(0)->reply;
  Nanoseconds slice = kMillisecond;
  watch_ = {};
  watched_at_ = -1;
  idle_for_ = 0;
  for (;;) {
    const std::uint32_t seen = reply.load(std::memory_order_acquire);
    if (seen == ticket) return true;
    FutexWait(reply, seen, slice);
    if (reply.load(std::memory_order_acquire) == ticket) return true;
    // It takes longer than a healthy step of a small swarm: see how the process is.
    if (process_->Ended()) {
      Bury(0);
      return false;
    }
    const std::uint64_t stuck = StuckWorkers(clock_.Now());
    if (stuck != 0 || idle_for_ > (IsInterrupted() ? kLastWait : options_.silence)) {
      Bury(stuck);
      return false;
    }
    slice = std::min(2 * slice, kLongestSlice);
  }
}

std::uint64_t ChildBackend::StuckWorkers(Nanoseconds now) {
  // A longer pause than we asked for means that we were stopped ourselves, and the child perhaps with us.
  const Nanoseconds passed = watched_at_ < 0 ? 0 : std::min(now - watched_at_, 4 * kLongestSlice);
  watched_at_ = now;
  const Nanoseconds deadline = IsInterrupted() ? kLastWait : options_.deadline;
  std::uint64_t stuck = 0;
  bool idle = true;
  for (std::size_t w = 0; w < static_cast<std::size_t>(std::min<int>(options_.threads, kMaxWorkers)); ++w) {
    const std::uint64_t word = areas_.out.At<OutHeader>(0)->workers[w].word.load(std::memory_order_acquire);
    const bool works = static_cast<std::uint32_t>(word) != 0;
    idle = idle && !works;
    WorkerWatch& watch = watch_[w];
    watch.same_for = works && word == watch.word ? watch.same_for + passed : 0;
    watch.word = word;
    if (deadline > 0 && watch.same_for >= deadline) stuck |= std::uint64_t{1} << w;
  }
  idle_for_ = idle ? idle_for_ + passed : 0;
  return stuck;
}

void ChildBackend::Bury(std::uint64_t stuck_workers) {
  Loss loss;
  const bool ended = process_->Ended().has_value();
  process_->Kill();
  const ChildEnd end = process_->Wait();
  dead_cpu_s_ += end.cpu_s;
  same_core_.reset();
  process_.reset();
  const InHeader& header = areas_.header();
  const std::size_t limit = header.operation == Operation::kLoad ? files_.size() : robots_.size();
  for (std::size_t w = 0; w < kMaxWorkers; ++w) {
    const std::uint64_t word = areas_.out.At<OutHeader>(0)->workers[w].word.load(std::memory_order_acquire);
    const std::uint32_t item = static_cast<std::uint32_t>(word) - 1;
    if (static_cast<std::uint32_t>(word) == 0 || item >= limit || IsDone(header.operation, item)) continue;
    // Of a process that hung, what went on meanwhile is not to blame.
    if (!ended && (stuck_workers >> w & 1) == 0) continue;
    loss.suspects.push_back(item);
  }
  std::sort(loss.suspects.begin(), loss.suspects.end());
  loss.hung = !ended;
  loss.by_others = ended && end.by_others();
  if (ended) {
    loss.why = end.ToString();
  } else if (stuck_workers != 0) {
    loss.why = fmt::format("did not return within {:g} s", ToSeconds(options_.deadline));
  } else {
    loss.why =
        fmt::format("gave no answer for {:g} s with no controller at work", ToSeconds(options_.silence));
  }
  const std::uint32_t starved = areas_.out.At<OutHeader>(0)->out_of_memory.load(std::memory_order_acquire);
  if (ended && RanOutOfMemory(end, header.memory_bytes)) {
    loss.why = fmt::format(
        "ran out of memory: all controllers together may use {} MiB (serve --controller-memory MIB allows "
        "more)",
        header.memory_bytes >> 20);
    // Others may have been at work, but it was this one that wanted more.
    const auto it = std::find(loss.suspects.begin(), loss.suspects.end(), starved - 1);
    if (starved > 0 && it != loss.suspects.end()) loss.suspects = {starved - 1};
  }
  loss_ = std::move(loss);
}

void ChildBackend::Finish(const Order& order) {
  for (;;) {
    std::vector<std::uint32_t> open;
    for (const std::uint32_t item : order.items) {
      if (IsOpen(order, item)) open.push_back(item);
    }
    if (open.empty()) return;
    if (IsInterrupted() && loss_) return StopAll(order, "was ended with the daemon");
    if (unexplained_ > kMaxUnexplained) {
      return StopAll(order,
                     "could not run: its process " + (loss_ ? loss_->why : std::string("does not start")));
    }
    if (losses_ > kMaxLosses) {
      return StopAll(order, fmt::format("could not go on: its process {} {} times and no controller was to "
                                        "blame; has one of them threads of its own?",
                                        loss_ ? loss_->why : "ended", std::exchange(losses_, 0)));
    }
    if (!process_ && !Revive(order)) continue;
    if (!alone_.empty()) {
      const std::uint32_t item = alone_.front();
      alone_.pop_front();
      if (!IsOpen(order, item)) continue;
      const bool done = SendList(order.operation, {item}, 1);
      NoteDone(order);
      if (!done) Judge(order, order.operation, true);
      continue;
    }
    const bool done = SendList(order.operation, open, options_.threads);
    NoteDone(order);
    if (done) return;
    Judge(order, order.operation, false);
  }
}

bool ChildBackend::Revive(const Order& order) {
  InHeader& header = areas_.header();
  OutHeader& out = *areas_.out.At<OutHeader>(0);
  header.go.store(ticket_ = 0);
  out.reply.store(0);
  for (WorkerProgress& worker : out.workers) worker.word.store(0);
  out.out_of_memory.store(0);
  areas_.left = SharedArea();
  try {
    process_ = std::make_unique<ChildProcess>(*options_.launcher, areas_.in.fd(), areas_.out.fd());
    same_core_.emplace(process_->pid());
  } catch (const std::exception& exception) {
    StopAll(order, std::string("could not run: its process cannot be started: ") + exception.what());
    return false;
  }
  std::vector<std::uint32_t> files, robots;
  for (std::uint32_t file = 0; file < files_.size(); ++file) {
    if (files_[file].loaded && !files_[file].out) files.push_back(file);
  }
  for (std::uint32_t robot = 0; robot < robots_.size(); ++robot) {
    if (!robots_[robot].created || robots_[robot].out) continue;
    robots.push_back(robot);
    // What it has finished in this operation stays finished; else it starts from the operation before.
    const bool done = areas_.result(robot).done.load(std::memory_order_acquire) == header.serial;
    areas_.setup(robot).restore = static_cast<std::int32_t>((done ? header.serial : header.serial - 1) & 1);
  }
  if (!files.empty() && !SendList(Operation::kLoad, files, options_.threads)) {
    Judge(order, Operation::kLoad, true);
    return false;
  }
  for (const std::uint32_t file : files) {
    const FileResult& result = areas_.file_result(file);
    if (result.refused == 0 && Shape::Of(result) == files_[file].shape) continue;
    StopFile(order, file, "was changed on disk while it ran: reset starts the new one");
  }
  std::erase_if(robots, [this](std::uint32_t robot) { return robots_[robot].out; });
  header.reviving = 1;
  const bool created = robots.empty() || SendList(Operation::kCreate, robots, options_.threads);
  header.reviving = 0;
  if (!created) {
    Judge(order, Operation::kCreate, true);
    return false;
  }
  return true;
}

void ChildBackend::Judge(const Order& order, Operation operation, bool alone) {
  const Loss loss = *loss_;
  if (!loss.by_others) {
    ++losses_;
    calm_steps_ = 0;
  }
  if (loss.suspects.empty()) {
    ++unexplained_;
    logger_->warn("the controllers' process {}: a new one goes on from where it was", loss.why);
    return;
  }
  if (loss.by_others && operation != Operation::kStep) {
    ++unexplained_;  // again, but not for ever
    return;
  }
  // Several were at work, or somebody killed it: who did it will show when they are tried one by one.
  if (operation == Operation::kStep && !alone && (loss.suspects.size() > 1 || loss.by_others)) {
    logger_->warn("the controllers' process {}: a new one goes on from where it was", loss.why);
    alone_.insert(alone_.end(), loss.suspects.begin(), loss.suspects.end());
    return;
  }
  losses_ = 0;
  for (const std::uint32_t item : loss.suspects) {
    if (operation == Operation::kLoad) {
      StopFile(order, item, loss.why + " while it was loaded");
    } else {
      BlameRobot(item, loss);
    }
  }
}

void ChildBackend::BlameRobot(std::uint32_t robot, const Loss& loss) {
  StopRobot(robot, loss.why);
  FileState& file = files_[areas_.setup(robot).file];
  int& count = loss.hung ? file.hangs : file.crashes;
  if (++count < (loss.hung ? kMaxHangs : kMaxCrashes)) return;
  for (std::uint32_t other = 0; other < robots_.size(); ++other) {
    if (&files_[areas_.setup(other).file] != &file) continue;
    StopRobot(other, fmt::format("is stopped on all robots: on {} it {}", count, loss.why));
  }
}

void ChildBackend::StopFile(const Order& order, std::uint32_t file, const std::string& why) {
  files_[file].out = true;
  if (order.operation == Operation::kLoad) {
    casualties_.push_back({file, why});
    return;
  }
  for (std::uint32_t robot = 0; robot < robots_.size(); ++robot) {
    if (areas_.setup(robot).file == file) StopRobot(robot, why);
  }
}

void ChildBackend::StopRobot(std::uint32_t robot, const std::string& why) {
  if (robots_[robot].out) return;
  robots_[robot].out = true;
  casualties_.push_back({robot, why});
}

void ChildBackend::StopAll(const Order& order, const std::string& why) {
  if (order.operation == Operation::kLoad) {
    for (const std::uint32_t file : order.items) {
      if (IsOpen(order, file)) StopFile(order, file, why);
    }
    return;
  }
  for (std::uint32_t robot = 0; robot < robots_.size(); ++robot) StopRobot(robot, why);
}

void ChildBackend::NoteDone(const Order& order) {
  for (const std::uint32_t item : order.items) {
    if (!IsDone(order.operation, item)) continue;
    if (order.operation == Operation::kLoad) {
      files_[item].loaded = areas_.file_result(item).refused == 0;
      files_[item].shape = Shape::Of(areas_.file_result(item));
    }
    if (order.operation == Operation::kCreate) robots_[item].created = areas_.result(item).failed == 0;
    if (order.operation == Operation::kStep && areas_.result(item).failed != 0) robots_[item].created = false;
  }
}

bool ChildBackend::IsOpen(const Order& order, std::uint32_t item) const {
  const bool out = order.operation == Operation::kLoad ? files_[item].out : robots_[item].out;
  return !out && !IsDone(order.operation, item);
}

bool ChildBackend::IsDone(Operation operation, std::uint32_t item) const {
  const std::uint64_t serial = areas_.header().serial;
  if (operation == Operation::kLoad) {
    return areas_.file_result(item).done.load(std::memory_order_acquire) == serial;
  }
  return areas_.result(item).done.load(std::memory_order_acquire) == serial;
}

}  // namespace coopdyn
