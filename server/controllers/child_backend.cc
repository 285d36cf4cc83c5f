// SPDX-License-Identifier: MIT
#include "server/controllers/child_backend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <thread>
#include <utility>

namespace coopdyn {

namespace {

constexpr Nanoseconds kMillisecond = 1'000'000;
constexpr Nanoseconds kLongestSlice = 20 * kMillisecond;  // longest interval between checks of the child
constexpr Nanoseconds kEndTime = 200 * kMillisecond;      // for the child to destroy the instances
constexpr Nanoseconds kLastWait = 100 * kMillisecond;     // for a step when the daemon shuts down
constexpr int kMaxLosses = 8;                             // losses of the process without a culprit,
constexpr int kCalmSteps = 100;                           // with fewer steps in between
constexpr std::uint64_t kChangesAround = 3;               // of a worker's word, besides its items
constexpr std::size_t kFew = 512;  // up to this many robots, step in turns on one core with the child

/// True if the child reported it, or crashed near its limit: few programs check malloc() for NULL.
bool RanOutOfMemory(const ChildEnd& end, std::uint64_t memory_bytes) {
  if (memory_bytes == 0) return false;
  if (end.signal == 0) return end.exit_code == kOutOfMemoryExit;
  const bool crashed = end.signal == SIGSEGV || end.signal == SIGBUS || end.signal == SIGABRT;
  return crashed && end.memory_bytes >= memory_bytes / 10 * 9;
}

/// The item that a worker is running, + 1; 0: none.
std::uint32_t ItemOf(std::uint64_t word) {
  return static_cast<std::uint32_t>(word);
}

}  // namespace

ChildBackend::ChildBackend(Areas& areas, Options options, const Clock& clock, Logger logger)
    : areas_(areas), options_(std::move(options)), clock_(clock), logger_(std::move(logger)) {}

ChildBackend::~ChildBackend() {
  if (!process_) return;
  same_core_->Free();
  areas_.Order(Operation::kEnd, {}, 1);
  areas_.header().yields.store(0);
  areas_.header().go.store(++ticket_, std::memory_order_release);
  FutexWake(areas_.header().go);
  // The reply means that the controllers are destroyed and unloaded. Do not wait for the process to exit:
  // that takes longer than the rest of a reset.
  const std::atomic<std::uint32_t>& reply = areas_.out_header().reply;
  for (Nanoseconds waited = 0; waited < kEndTime; waited += kMillisecond) {
    const std::uint32_t seen = reply.load(std::memory_order_acquire);
    if (seen == ticket_) {
      process_->Leave();
      return;
    }
    if (waited > 0 && process_->ended()) return;
    FutexWait(reply, seen, kMillisecond);
  }
}

std::vector<Casualty> ChildBackend::Run(Operation operation, std::span<const std::uint32_t> items) {
  if (items.empty()) return {};
  operation_ = operation;
  open_.assign(items.begin(), items.end());
  files_.resize(areas_.header().file_count);
  robot_out_.resize(areas_.header().robot_count);
  for (FileState& file : files_) file.crashes = 0;
  casualties_.clear();
  suspected_.clear();
  trial_ = false;
  do {
    const bool runs = process_ != nullptr;
    const std::optional<Loss> loss = runs ? Send(operation_, open_, trial_ ? 1 : options_.threads) : Start();
    if (runs && !loss) break;
    if (loss && IsInterrupted()) {
      StopAll("was stopped with the daemon");
    } else if (loss) {
      Judge(*loss);
    }
    std::erase_if(open_, [this](std::uint32_t item) { return !IsOpen(item); });
  } while (!open_.empty());
  if (operation == Operation::kStep && losses_ > 0 && ++calm_steps_ > kCalmSteps) losses_ = 0;
  return std::exchange(casualties_, {});
}

void ChildBackend::Rest() {
  if (same_core_) same_core_->Leave();
}

std::optional<ChildBackend::Loss> ChildBackend::Send(Operation operation,
                                                     std::span<const std::uint32_t> items, int workers) {
  if (items.empty()) return std::nullopt;
  areas_.Order(operation, items, workers);
  // A step of a few robots takes less time than waking another core.
  if (operation == Operation::kStep && items.size() <= kFew) {
    same_core_->Take();
  } else {
    same_core_->Free();
  }
  InHeader& header = areas_.header();
  const std::atomic<std::uint32_t>& reply = areas_.out_header().reply;
  const Nanoseconds begun = clock_.Now();
  const bool yields = same_core_->Yields(begun);
  header.yields.store(yields ? 1 : 0);
  header.go.store(++ticket_);
  if (yields) {
    if (areas_.out_header().sleeps.load() != 0) FutexWake(header.go);
    std::this_thread::yield();
    same_core_->NoteTurn(begun, clock_.Now());
    if (reply.load(std::memory_order_acquire) == ticket_) return std::nullopt;
    header.yields.store(0);
  }
  FutexWake(header.go);  // do not rely on the child's `sleeps`
  // A timer that ends before the next system tick costs 2 µs.
  Nanoseconds slice = operation == Operation::kStep ? 8 * kMillisecond : kMillisecond;
  watch_ = {};
  watched_at_ = -1;
  idle_for_ = 0;
  for (;;) {
    const std::uint32_t seen = reply.load(std::memory_order_acquire);
    if (seen == ticket_) return std::nullopt;
    FutexWait(reply, seen, slice);
    if (reply.load(std::memory_order_acquire) == ticket_) return std::nullopt;
    // This is longer than a healthy step of a small swarm: check the process.
    if (process_->ended()) return Bury(0);
    const std::uint64_t stuck = StuckWorkers(clock_.Now());
    if (stuck != 0 || idle_for_ > (IsInterrupted() ? kLastWait : options_.silence)) return Bury(stuck);
    slice = std::min(2 * slice, kLongestSlice);
  }
}

std::uint64_t ChildBackend::StuckWorkers(Nanoseconds now) {
  // A longer pause than requested means that this process was stopped, and perhaps the child too.
  const Nanoseconds passed = watched_at_ < 0 ? 0 : std::min(now - watched_at_, 4 * kLongestSlice);
  watched_at_ = now;
  const Nanoseconds deadline = IsInterrupted() ? kLastWait : options_.deadline;
  std::uint64_t stuck = 0;
  bool idle = true;
  for (std::size_t w = 0; w < static_cast<std::size_t>(std::min<int>(options_.threads, kMaxWorkers)); ++w) {
    const std::uint64_t word = areas_.out_header().workers[w].word.load(std::memory_order_acquire);
    WorkerWatch& watch = watch_[w];
    if (word != watch.word) ++watch.changes;
    // A worker changes its word once per item and once at the end. More changes are no progress: the word is
    // being overwritten.
    const bool overwritten = watch.changes > areas_.header().item_count + kChangesAround;
    const bool works = ItemOf(word) != 0 || overwritten;
    idle = idle && !works;
    watch.same_for = works && (overwritten || word == watch.word) ? watch.same_for + passed : 0;
    watch.word = word;
    if (deadline > 0 && watch.same_for >= deadline) stuck |= std::uint64_t{1} << w;
  }
  idle_for_ = idle ? idle_for_ + passed : 0;
  return stuck;
}

ChildBackend::Loss ChildBackend::Bury(std::uint64_t stuck_workers) {
  Loss loss;
  loss.hung = !process_->ended();
  const ChildEnd end = process_->End();
  dead_cpu_s_ += end.cpu_s;
  same_core_.reset();
  process_.reset();
  const InHeader& header = areas_.header();
  const std::size_t limit = header.operation == Operation::kLoad ? files_.size() : robot_out_.size();
  for (std::size_t w = 0; w < kMaxWorkers; ++w) {
    const std::uint32_t item = ItemOf(areas_.out_header().workers[w].word) - 1;
    if (item >= limit || IsDone(header.operation, item)) continue;
    // In a hang, items of workers that are not stuck are not to blame.
    if (loss.hung && (stuck_workers >> w & 1) == 0) continue;
    loss.suspects.push_back(item);
  }
  std::sort(loss.suspects.begin(), loss.suspects.end());
  if (loss.hung) {
    const char* why = stuck_workers == 0 ? "gave no answer for {:g} s while no controller was at work"
                      : loss.suspects.empty()
                          ? "gave no answer for {:g} s, as a controller overwrites what it "
                            "shares with the daemon"
                          : "did not return within {:g} s";
    loss.why =
        fmt::format(fmt::runtime(why), ToSeconds(stuck_workers == 0 ? options_.silence : options_.deadline));
  } else if (RanOutOfMemory(end, header.memory_bytes)) {
    loss.why = fmt::format(
        "ran out of memory: all controllers together may use {} MiB (serve --controller-memory MIB allows "
        "more)",
        header.memory_bytes >> 20);
    // Other items may have been running, but this one requested the memory.
    const std::uint32_t starved = areas_.out_header().out_of_memory.load(std::memory_order_acquire) - 1;
    if (std::find(loss.suspects.begin(), loss.suspects.end(), starved) != loss.suspects.end()) {
      loss.suspects = {starved};
    }
  } else {
    loss.why = end.ToString();
    loss.by_others = end.by_others();
  }
  return loss;
}

std::optional<ChildBackend::Loss> ChildBackend::Start() {
  InHeader& header = areas_.header();
  OutHeader& out = areas_.out_header();
  header.go.store(ticket_ = 0);
  out.reply.store(0);
  out.sleeps.store(0);
  for (WorkerProgress& worker : out.workers) worker.word.store(0);
  out.out_of_memory.store(0);
  try {
    process_ = std::make_unique<ChildProcess>(*options_.launcher, areas_.in.fd(), areas_.out.fd());
    same_core_.emplace(process_->pid());
  } catch (const std::exception& exception) {
    StopAll(std::string("could not run: its process cannot be started: ") + exception.what());
    return std::nullopt;
  }
  // The facts that the layout of the areas depends on.
  const auto shape = [this](std::uint32_t file) {
    const FileResult& result = areas_.file_result(file);
    return std::array{result.refused, result.readings, result.state_size, result.option_count};
  };
  std::vector<std::uint32_t> files, robots;
  std::vector<std::array<std::uint32_t, 4>> shapes;
  for (std::uint32_t file = 0; file < files_.size(); ++file) {
    if (areas_.file_result(file).done == 0 || shape(file)[0] != 0 || files_[file].out) continue;
    files.push_back(file);
    shapes.push_back(shape(file));
  }
  if (std::optional<Loss> loss = Send(Operation::kLoad, files, options_.threads)) return loss;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (shape(files[i]) != shapes[i])
      StopFile(files[i], "was changed on disk while it ran: reset starts the new one");
  }
  for (std::uint32_t robot = 0; robot < robot_out_.size(); ++robot) {
    const RobotResult& result = areas_.result(robot);
    const std::uint64_t done = result.done.load(std::memory_order_acquire);
    if (done == 0 || Once(result.failed) != 0 || robot_out_[robot]) continue;
    robots.push_back(robot);
    // Restore the state after the last operation that the robot finished, current or not.
    areas_.setup(robot).restore = static_cast<std::int32_t>(done & 1);
  }
  header.reviving = 1;
  std::optional<Loss> loss = Send(Operation::kCreate, robots, options_.threads);
  header.reviving = 0;
  return loss;
}

void ChildBackend::Judge(const Loss& loss) {
  const Operation operation = areas_.header().operation;
  std::vector<std::uint32_t> guilty;
  for (const std::uint32_t item : loss.suspects) {
    const bool again = std::find(suspected_.begin(), suspected_.end(), item) != suspected_.end();
    const bool only_one = loss.suspects.size() == 1 || operation != Operation::kStep;
    if (only_one && (!loss.by_others || (again && operation == Operation::kStep))) guilty.push_back(item);
  }
  if (!guilty.empty()) {
    losses_ = 0;
    for (const std::uint32_t item : guilty) {
      if (operation == Operation::kLoad) {
        StopFile(item, loss.why + " while it was loaded");
      } else {
        BlameRobot(item, loss);
      }
    }
    return;
  }
  calm_steps_ = 0;
  if (++losses_ > kMaxLosses) {
    return StopAll(
        fmt::format("could not go on: its process {} {} times and no controller was to blame; does "
                    "one of them start its own threads?",
                    loss.why, std::exchange(losses_, 0)));
  }
  logger_->warn("the controllers' process {}: a new one continues from its state", loss.why);
  // Several items were running, or another program killed the process: running one at a time shows the
  // culprit.
  trial_ = true;
  if (operation == Operation::kStep)
    suspected_.insert(suspected_.end(), loss.suspects.begin(), loss.suspects.end());
}

void ChildBackend::BlameRobot(std::uint32_t robot, const Loss& loss) {
  StopRobot(robot, loss.why);
  const std::uint32_t file = areas_.setup(robot).file;
  int& count = loss.hung ? files_[file].hangs : files_[file].crashes;
  if (++count < (loss.hung ? kMaxHangs : kMaxCrashes)) return;
  for (std::uint32_t other = 0; other < robot_out_.size(); ++other) {
    if (areas_.setup(other).file != file) continue;
    StopRobot(other, fmt::format("is stopped on all robots: on {} it {}", count, loss.why));
  }
}

void ChildBackend::StopFile(std::uint32_t file, const std::string& why) {
  files_[file].out = true;
  if (operation_ == Operation::kLoad) {
    casualties_.push_back({file, why});
    return;
  }
  for (std::uint32_t robot = 0; robot < robot_out_.size(); ++robot) {
    if (areas_.setup(robot).file == file) StopRobot(robot, why);
  }
}

void ChildBackend::StopRobot(std::uint32_t robot, const std::string& why) {
  if (robot_out_[robot]) return;
  robot_out_[robot] = true;
  casualties_.push_back({robot, why});
}

void ChildBackend::StopAll(const std::string& why) {
  if (operation_ == Operation::kLoad) {
    for (const std::uint32_t file : open_) {
      if (IsOpen(file)) StopFile(file, why);
    }
    return;
  }
  for (std::uint32_t robot = 0; robot < robot_out_.size(); ++robot) StopRobot(robot, why);
}

bool ChildBackend::IsOpen(std::uint32_t item) const {
  const bool out = operation_ == Operation::kLoad ? files_[item].out : robot_out_[item];
  return !out && !IsDone(operation_, item);
}

bool ChildBackend::IsDone(Operation operation, std::uint32_t item) const {
  const std::atomic<std::uint64_t>& done =
      operation == Operation::kLoad ? areas_.file_result(item).done : areas_.result(item).done;
  return done.load(std::memory_order_acquire) == areas_.header().serial;
}

}  // namespace coopdyn
