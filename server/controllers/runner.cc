// SPDX-License-Identifier: MIT
#include "server/controllers/runner.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "server/controllers/child_process.h"
#include "server/controllers/faults.h"
#include "server/controllers/guarded_buffer.h"
#include "server/controllers/instance.h"

namespace coopdyn {

namespace {

constexpr std::size_t kStepGrain = 16;       // robots that a worker fetches at a time
constexpr std::size_t kMaxSetpoints = 4096;  // per controller and step
/// Reading a clock takes longer than the step of a simple controller, so one step in this many is timed. Odd,
/// to avoid beating with a rhythm of the controllers.
constexpr std::uint64_t kTimedEvery = 61;

/// The item that this thread is running, for the new-handler, which has no arguments.
struct InHand {
  std::atomic<std::uint32_t>* out_of_memory = nullptr;
  std::uint32_t item = 0;
};
thread_local InHand in_hand;

/// Restores rounding and traps that a controller (or its -ffast-math) may have changed.
class KeepRounding {
 public:
#if defined(__x86_64__)
  KeepRounding() : before_(_mm_getcsr() & ~kFlags) {}
  ~KeepRounding() {
    if ((_mm_getcsr() & ~kFlags) != before_) _mm_setcsr(before_);
  }

 private:
  static constexpr unsigned kFlags = 0x3f;
  const unsigned before_;
#else
  KeepRounding() { std::fegetenv(&before_); }
  ~KeepRounding() { std::fesetenv(&before_); }

 private:
  std::fenv_t before_;
#endif
};

/// Calls into a controller; `called` names the function being called. Returns why it failed, empty on
/// success.
template <typename Function>
std::string Guarded(const char* const& called, Function function) {
  const KeepRounding keep;
  try {
    function();
    return {};
  } catch (const std::exception& exception) {
    return fmt::format("threw an exception in {}() ({})", called, exception.what());
  } catch (...) {
    return fmt::format("threw an exception in {}()", called);
  }
}

/// Room for `count` values at the end of `buffer`.
template <typename T>
T* LastOf(const GuardedBuffer& buffer, std::size_t count) {
  return static_cast<T*>(buffer.Last(count * sizeof(T), alignof(T)));
}

}  // namespace

struct Runner::Worker {
  GuardedBuffer command{sizeof(coopdyn_command)};
  GuardedBuffer setpoints{kMaxSetpoints * sizeof(coopdyn_setpoint)};
  GuardedBuffer motors{kMaxSetpoints * sizeof(double)};
  GuardedBuffer logs{COOPDYN_MAX_LOGS * sizeof(coopdyn_logged)};
  GuardedBuffer supervision{sizeof(coopdyn_supervision)};
  GuardedBuffer moves{COOPDYN_MAX_MOVES * sizeof(coopdyn_move)};
  GuardedBuffer state{COOPDYN_MAX_STATE};
};

Runner::Runner() = default;
Runner::~Runner() = default;

void Runner::Run(const Areas& areas, WorkerPool& pool) {
  areas_ = &areas;
  const std::size_t workers = std::clamp<std::size_t>(header().workers, 1, kMaxWorkers);
  while (workers_.size() < workers) workers_.emplace_back();
  plugins_.resize(std::max<std::size_t>(plugins_.size(), header().file_count));
  instances_.resize(std::max<std::size_t>(instances_.size(), header().robot_count));
  const std::span items(In<std::uint32_t>(header().items), header().item_count);
  switch (header().operation) {
    case Operation::kLoad:
      for (const std::uint32_t file : items) Load(file);
      break;
    case Operation::kCreate:
      for (const std::uint32_t robot : items) Create(robot, workers_.front());
      break;
    case Operation::kStep:
      StepAll(pool);
      break;
    case Operation::kEnd:
      End();
      break;
  }
  areas.out_header().workers[0].word.store(0, std::memory_order_release);
}

void Runner::Begin(std::size_t worker, std::uint32_t item) const {
  std::atomic<std::uint64_t>& word = areas_->out_header().workers[worker].word;
  const std::uint64_t begun = (word.load(std::memory_order_relaxed) >> 32) + 1;
  word.store(begun << 32 | (item + 1), std::memory_order_release);
  in_hand = {&areas_->out_header().out_of_memory, item};
}

void Runner::EndWithoutMemory() {
  std::set_new_handler([] {
    if (in_hand.out_of_memory != nullptr) in_hand.out_of_memory->store(in_hand.item + 1);
    _exit(kOutOfMemoryExit);
  });
}

void Runner::Load(std::uint32_t file) {
  Begin(0, file);
  FileResult& result = areas_->file_result(file);
  result.refused = 0;
  try {
    const KeepRounding keep;
    plugins_[file].emplace(In<char>(In<FileSetup>(header().files)[file].path), result);
  } catch (const PluginError& error) {
    result.refused = 1;
    CopyText(result.why, sizeof(result.why), error.what());
  }
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::Create(std::uint32_t robot, Worker& worker) {
  Begin(0, robot);
  const RobotSetup& setup = areas_->setup(robot);
  if (!plugins_[setup.file]) return Fail(robot, "is not loaded");
  const Plugin& plugin = *plugins_[setup.file];
  const auto too_many = [&](bool given, std::size_t count, const char* what) {
    if (!given || count <= kMaxSetpoints) return false;
    Fail(robot, fmt::format("cannot drive it: it has {} {}, and a controller commands at most {}", count,
                            what, kMaxSetpoints));
    return true;
  };
  if (too_many(plugin.gives_setpoints(), setup.robot.channel_count, "channels")) return;
  if (too_many(plugin.maps(), setup.robot.motor_count, "motors")) return;
  auto instance = std::make_unique<Instance>(plugin, setup, *areas_);
  const coopdyn_controller& functions = instance->plugin->functions();
  char error[kTextSize] = "";
  std::string why = Guarded("create", [&] {
    instance->state = functions.create(&instance->robot, In<double>(setup.options), error, sizeof(error));
  });
  if (why.empty() && instance->state == nullptr) {
    const std::string reason(error, strnlen(error, sizeof(error)));
    why = (instance->plugin->supervises() ? "cannot supervise: " : "cannot drive it: ") +
          (reason.empty() ? "its create() returned NULL" : reason);
  }
  if (why.empty()) why = Guarded("reset", [&] { functions.reset(instance->state, header().seed); });
  if (why.empty() && setup.restore == kNoState) {
    why = Guarded("save", [&] { Save(*instance, setup.states[header().serial & 1], worker); });
  } else if (why.empty() && instance->plugin->state_size() > 0) {
    const std::byte* saved = areas_->out.At<std::byte>(setup.states[setup.restore]);
    why = Guarded("restore", [&] { functions.restore(instance->state, saved); });
  }
  if (!why.empty()) return Fail(robot, why);
  instances_[robot] = std::move(instance);
  if (header().reviving != 0) return;
  RobotResult& result = areas_->result(robot);
  result.failed = 0;
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::StepAll(WorkerPool& pool) {
  const std::size_t count = header().item_count;
  const std::size_t workers = std::clamp<std::size_t>(header().workers, 1, kMaxWorkers);
  // Waking a thread takes longer than the steps of many controllers. The choice affects only the time, not
  // the results.
  const bool shared = item_time_ * static_cast<Nanoseconds>(count) >= header().share_from_ns;
  const std::size_t parts = shared ? std::min(workers, (count + kStepGrain - 1) / kStepGrain) : 1;
  timed_ = header().serial % kTimedEvery == 0;
  for (std::uint32_t file = 0; timed_ && file < header().file_count; ++file) {
    areas_->file_result(file).step_ns.store(0, std::memory_order_relaxed);
  }
  const SteadyClock clock;
  const Nanoseconds begun = clock.Now();
  next_.store(0, std::memory_order_relaxed);
  if (parts <= 1) {
    StepSome(0);
  } else {
    pool.For(parts, 1, [this](std::size_t first, std::size_t end) {
      for (std::size_t part = first; part < end; ++part) StepSome(part);
    });
  }
  if (count == 0) return;
  item_time_ = (clock.Now() - begun) * static_cast<Nanoseconds>(std::max<std::size_t>(parts, 1)) /
               static_cast<Nanoseconds>(count);
}

void Runner::StepSome(std::size_t worker) {
  const std::size_t count = header().item_count;
  const std::uint32_t* items = In<std::uint32_t>(header().items);
  for (;;) {
    const std::size_t first = next_.fetch_add(kStepGrain, std::memory_order_relaxed);
    if (first >= count) break;
    for (std::size_t i = first; i < std::min(count, first + kStepGrain); ++i) {
      Begin(worker, items[i]);
      timed_ ? TimedStep(items[i], workers_[worker]) : Step(items[i], workers_[worker]);
    }
  }
  std::atomic<std::uint64_t>& word = areas_->out_header().workers[worker].word;
  word.store(word.load(std::memory_order_relaxed) >> 32 << 32, std::memory_order_release);
}

void Runner::TimedStep(std::uint32_t robot, Worker& worker) {
  const SteadyClock clock;
  const Nanoseconds begun = clock.Now();
  Step(robot, worker);
  const std::uint32_t file = areas_->setup(robot).file;
  areas_->file_result(file).step_ns.fetch_add(static_cast<std::uint64_t>(clock.Now() - begun),
                                              std::memory_order_relaxed);
}

void Runner::Step(std::uint32_t robot, Worker& worker) {
  // The lost process left no state to restore the instance from.
  if (instances_[robot] == nullptr) return Fail(robot, "had its state overwritten by another controller");
  Instance& instance = *instances_[robot];
  const RobotSetup& setup = areas_->setup(robot);
  if (header().step % setup.exchange_steps != 0) return StepOver(robot, worker);
  for (std::size_t i = 0; i < instance.sensed.size(); ++i) {
    const SensorPlace& place = In<SensorPlace>(setup.sensed)[i];
    instance.sensed[i] = {place.step, In<double>(place.values), In<std::uint8_t>(place.image)};
  }
  const RobotReadings& sent = areas_->readings(robot);
  coopdyn_readings readings = {
      .seed = header().seed,
      .step = header().step,
      .time_s = header().time_s,
      .step_s = header().step_s,
      .distance_count = sent.distance_count,
      .distance_m = In<double>(setup.distances),
      .x_m = sent.x_m,
      .y_m = sent.y_m,
      .heading_rad = sent.heading_rad,
      .forward_m_s = sent.forward_m_s,
      .turn_rad_s = sent.turn_rad_s,
      .channel_count = sent.channel_count,
      .channels = In<coopdyn_channel>(setup.channels),
      .target_count = sent.target_count,
      .targets = In<coopdyn_target>(sent.targets),
      .neighbour_count = sent.neighbour_count,
      .neighbours = In<coopdyn_sighting>(sent.neighbours),
      .heard_count = sent.heard_count,
      .heard = In<coopdyn_heard>(sent.heard),
      .compass_rad = sent.compass_rad,
      .support_x_m = sent.support_x_m,
      .support_y_m = sent.support_y_m,
      .support_rad = sent.support_rad,
      .height_m = sent.height_m,
      .roll_rad = sent.roll_rad,
      .pitch_rad = sent.pitch_rad,
      .velocity_m_s = {},
      .angular_velocity_rad_s = {},
      .sensors = instance.sensed.data(),
      .world = nullptr,
      .mapped = instance.plugin->maps() ? In<double>(setup.mapped) : nullptr,
  };
  std::ranges::copy(sent.velocity_m_s, readings.velocity_m_s);
  std::ranges::copy(sent.angular_velocity_rad_s, readings.angular_velocity_rad_s);

  const bool supervises = instance.plugin->supervises();
  const coopdyn_world world = {header().body_count, In<coopdyn_body>(header().bodies), header().score_count,
                               In<coopdyn_score>(header().scores)};
  if (supervises) readings.world = &world;

  auto& command = *LastOf<coopdyn_command>(worker.command, 1);
  coopdyn_logged* const logs = LastOf<coopdyn_logged>(worker.logs, COOPDYN_MAX_LOGS);
  coopdyn_supervision* const doing =
      supervises ? LastOf<coopdyn_supervision>(worker.supervision, 1) : nullptr;
  coopdyn_move* const moves = LastOf<coopdyn_move>(worker.moves, COOPDYN_MAX_MOVES);
  command = {};
  command.logs = logs;
  command.supervision = doing;
  if (supervises) {
    *doing = {};
    doing->moves = moves;
  }
  std::span<coopdyn_setpoint> setpoints;
  if (instance.plugin->gives_setpoints()) {
    const std::size_t count = instance.joints.size();
    setpoints = {LastOf<coopdyn_setpoint>(worker.setpoints, count), count};
    std::ranges::fill(setpoints, coopdyn_setpoint{});
    command.setpoints = setpoints.data();
  }
  std::span<double> motors;
  if (instance.plugin->maps()) {
    const std::size_t count = setup.robot.motor_count;
    motors = {LastOf<double>(worker.motors, count), count};
    std::ranges::fill(motors, 0.0);
    command.motors = motors.data();
  }
  const char* called = "step";
  std::string wrong;
  const std::string failed = Guarded(called, [&] {
    instance.plugin->functions().step(instance.state, &readings, &command);
    if (!IsFine(command)) wrong = Fault(command);
    if (command.setpoints != setpoints.data() || command.logs != logs || command.supervision != doing ||
        command.motors != motors.data() || (supervises && doing->moves != moves)) {
      wrong = "changed a pointer of its command: write into the array that it points to";
    }
    for (std::size_t i = 0; i < command.log_count && wrong.empty(); ++i) {
      if (!IsFine(logs[i])) wrong = Fault(logs[i]);
    }
    if (supervises && wrong.empty() && doing->move_count > COOPDYN_MAX_MOVES)
      wrong = TooManyMoves(doing->move_count);
    for (std::size_t i = 0; supervises && wrong.empty() && i < doing->move_count; ++i) {
      if (!IsFine(moves[i])) wrong = Fault(moves[i]);
    }
    for (std::size_t i = 0; i < setpoints.size() && wrong.empty(); ++i) {
      if (!IsFine(setpoints[i], instance.joints[i].modes)) wrong = Fault(setpoints[i], instance.joints[i]);
    }
    for (std::size_t i = 0; i < motors.size() && wrong.empty(); ++i) {
      if (!std::isfinite(motors[i]))
        wrong = fmt::format("returned motors[{}] = {}: it must be a finite number", i, motors[i]);
    }
    called = "save";
    if (wrong.empty()) Save(instance, setup.states[header().serial & 1], worker);
  });
  if (!wrong.empty() || !failed.empty()) return Fail(robot, wrong.empty() ? failed : wrong);
  RobotResult& result = areas_->result(robot);
  result.failed = 0;
  CopyCommand(command, result.command);
  std::ranges::copy(setpoints, areas_->out.At<coopdyn_setpoint>(setup.setpoints));
  std::ranges::copy(motors, areas_->out.At<double>(setup.motors));
  std::copy_n(logs, command.log_count, areas_->out.At<coopdyn_logged>(setup.logs));
  if (supervises) {
    std::copy_n(moves, doing->move_count, areas_->out.At<coopdyn_move>(header().moves));
    doing->moves = nullptr;
    *areas_->out.At<coopdyn_supervision>(header().supervision) = *doing;
  }
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::StepOver(std::uint32_t robot, Worker& worker) {
  const Instance& instance = *instances_[robot];
  const std::string failed =
      Guarded("save", [&] { Save(instance, areas_->setup(robot).states[header().serial & 1], worker); });
  if (!failed.empty()) return Fail(robot, failed);
  RobotResult& result = areas_->result(robot);
  result.failed = 0;
  CopyCommand(coopdyn_command{}, result.command);
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::Save(const Instance& instance, Place place, Worker& worker) const {
  const std::size_t size = instance.plugin->state_size();
  if (size == 0) return;
  void* state = worker.state.Last(size, alignof(std::max_align_t));
  std::memset(state, 0, size);  // bytes that save() does not write are 0, not another robot's
  instance.plugin->functions().save(instance.state, state);
  std::memcpy(areas_->out.At<std::byte>(place), state, size);
}

void Runner::Fail(std::uint32_t robot, const std::string& why) const {
  CopyText(areas_->text(robot), kTextSize, why);
  RobotResult& result = areas_->result(robot);
  result.failed = 1;
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::End() {
  for (std::uint32_t robot = 0; robot < instances_.size(); ++robot) {
    const std::unique_ptr<Instance>& instance = instances_[robot];
    if (instance == nullptr) continue;
    Begin(0, robot);
    Guarded("destroy", [&] { instance->plugin->functions().destroy(instance->state); });
  }
  instances_.clear();
}

}  // namespace coopdyn
