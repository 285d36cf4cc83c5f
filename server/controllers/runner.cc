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
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "server/base/printable.h"
#include "server/controllers/child_launcher.h"

namespace coopdyn {

namespace {

constexpr std::size_t kStepGrain = 16;  // robots that a worker takes at a time
/// Reading a clock costs more than the step of a simple controller: one step in this many is timed. Odd, so
/// that no rhythm of the controllers hides from it.
constexpr std::uint64_t kTimedEvery = 61;

/// What this thread has in hand, for whoever gets no memory: a new-handler has no arguments.
struct InHand {
  std::atomic<std::uint32_t>* out_of_memory = nullptr;
  std::uint32_t item = 0;
};
thread_local InHand in_hand;

/// What a controller says is shown on terminals.
void CopyText(char* to, std::size_t size, const std::string& said) {
  const std::string text = Printable(said);
  const std::size_t length = std::min(size - 1, text.size());
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

/// Rounding and traps as they were, whatever a controller (or its -ffast-math) does to them.
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

/// Calls into a controller. Returns why it failed; empty: it did not.
template <typename Function>
std::string Guarded(const char* name, Function function) {
  const KeepRounding keep;
  try {
    function();
    return {};
  } catch (const std::exception& exception) {
    return fmt::format("threw an exception in {}() ({})", name, exception.what());
  } catch (...) {
    return fmt::format("threw an exception in {}()", name);
  }
}

/// What is wrong with a command; empty: nothing.
std::string Fault(const coopdyn_command& command) {
  const auto not_finite = [](const char* what, double value) {
    return fmt::format("returned {} = {}: it must be a finite number", what, value);
  };
  if (!std::isfinite(command.forward_m_s)) return not_finite("forward_m_s", command.forward_m_s);
  if (!std::isfinite(command.turn_rad_s)) return not_finite("turn_rad_s", command.turn_rad_s);
  if (command.message_count > COOPDYN_MAX_MESSAGE) {
    return fmt::format("returned message_count = {}: at most {}", command.message_count, COOPDYN_MAX_MESSAGE);
  }
  for (std::uint32_t i = 0; i < command.message_count; ++i) {
    if (!std::isfinite(command.message[i])) return not_finite("a number in message", command.message[i]);
  }
  return {};
}

}  // namespace

/// A robot's controller, and the facts that it may point to as long as it lives.
struct Runner::Instance {
  const Plugin* plugin = nullptr;
  void* state = nullptr;
  std::string name;
  std::vector<double> bearing_rad, opening_rad, max_m;
  coopdyn_robot robot{};
};

Runner::Runner() = default;
Runner::~Runner() = default;

void Runner::Run(const std::byte* in, std::byte* out, WorkerPool& pool) {
  in_ = in;
  out_ = out;
  const std::size_t count = header().item_count;
  const std::uint32_t* items = In<std::uint32_t>(header().items);
  const std::size_t workers = std::clamp<std::size_t>(header().workers, 1, kMaxWorkers);
  while (workers_.size() < workers) workers_.emplace_back();
  plugins_.resize(std::max<std::size_t>(plugins_.size(), header().file_count));
  instances_.resize(std::max<std::size_t>(instances_.size(), header().robot_count));
  switch (header().operation) {
    case Operation::kLoad:
      for (std::size_t i = 0; i < count; ++i) {
        Begin(0, items[i]);
        Load(items[i]);
      }
      break;
    case Operation::kCreate:
      for (std::size_t i = 0; i < count; ++i) {
        Begin(0, items[i]);
        Create(items[i], workers_.front());
      }
      break;
    case Operation::kStep:
      StepAll(pool);
      break;
    case Operation::kMove:  // of the process, not of the controllers
      break;
    case Operation::kEnd:
      End();
      break;
  }
  Out<OutHeader>(0)->workers[0].word.store(0, std::memory_order_release);
}

void Runner::Begin(std::size_t worker, std::uint32_t item) const {
  std::atomic<std::uint64_t>& word = Out<OutHeader>(0)->workers[worker].word;
  const std::uint64_t begun = (word.load(std::memory_order_relaxed) >> 32) + 1;
  word.store(begun << 32 | (item + 1), std::memory_order_release);
  in_hand = {&Out<OutHeader>(0)->out_of_memory, item};
}

void Runner::EndWithoutMemory() {
  std::set_new_handler([] {
    if (in_hand.out_of_memory != nullptr) in_hand.out_of_memory->store(in_hand.item + 1);
    _exit(kOutOfMemoryExit);
  });
}

void Runner::Load(std::uint32_t file) {
  FileResult& result = Out<FileResult>(header().file_results)[file];
  result.refused = 0;
  try {
    const KeepRounding keep;
    plugins_[file].emplace(In<char>(In<FileSetup>(header().files)[file].path));
    const ControllerDescription& description = plugins_[file]->description();
    CopyText(result.help, sizeof(result.help), description.help);
    result.readings = description.readings;
    result.state_size = description.state_size;
    result.option_count = static_cast<std::uint32_t>(description.options.size());
    for (std::size_t i = 0; i < description.options.size(); ++i) {
      const ControllerOption& option = description.options[i];
      CopyText(result.options[i].name, kNameSize, option.name);
      CopyText(result.options[i].help, kTextSize, option.help);
      result.options[i].value = option.value;
      result.options[i].min = option.min;
      result.options[i].max = option.max;
    }
  } catch (const PluginError& error) {
    result.refused = 1;
    CopyText(result.why, sizeof(result.why), error.what());
  }
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::Create(std::uint32_t robot, Worker& worker) {
  const RobotSetup& setup = In<RobotSetup>(header().robots)[robot];
  if (!plugins_[setup.file]) return Fail(robot, "is not loaded");
  auto instance = std::make_unique<Instance>();
  instance->plugin = &*plugins_[setup.file];
  const coopdyn_controller& functions = instance->plugin->functions();
  const auto copy = [&](Place place) {
    const double* values = In<double>(place);
    return std::vector<double>(values, values + setup.distance_count);
  };
  instance->name = In<char>(setup.name);
  instance->bearing_rad = copy(setup.bearing_rad);
  instance->opening_rad = copy(setup.opening_rad);
  instance->max_m = copy(setup.max_m);
  instance->robot = {setup.id,
                     instance->name.c_str(),
                     setup.radius_m,
                     setup.wheel_radius_m,
                     setup.track_m,
                     setup.max_wheel_speed_rad_s,
                     setup.distance_count,
                     instance->bearing_rad.data(),
                     instance->opening_rad.data(),
                     instance->max_m.data()};
  char error[kTextSize] = "";
  std::string why = Guarded("create", [&] {
    instance->state = functions.create(&instance->robot, In<double>(setup.options), error, sizeof(error));
  });
  if (why.empty() && instance->state == nullptr) {
    const std::string reason(error, strnlen(error, sizeof(error)));
    why = "cannot drive it: " + (reason.empty() ? "its create() returned NULL" : reason);
  }
  if (why.empty()) why = Guarded("reset", [&] { functions.reset(instance->state, header().seed); });
  const bool has_state = instance->plugin->description().state_size > 0;
  if (why.empty() && setup.restore != kNoState && has_state) {
    const std::byte* saved = Out<std::byte>(setup.states[setup.restore]);
    why = Guarded("restore", [&] { functions.restore(instance->state, saved); });
  }
  if (why.empty() && setup.restore == kNoState) {
    why = Guarded("save", [&] { Save(*instance, setup.states[header().serial & 1], worker); });
  }
  if (!why.empty()) return Fail(robot, why);
  instances_[robot] = std::move(instance);
  if (header().reviving != 0) return;
  result(robot).failed = 0;
  result(robot).done.store(header().serial, std::memory_order_release);
}

void Runner::StepAll(WorkerPool& pool) {
  const std::size_t count = header().item_count;
  const std::size_t workers = std::clamp<std::size_t>(header().workers, 1, kMaxWorkers);
  // To wake a thread costs more than many a controller's step. It changes nothing but the time it takes.
  const bool shared = item_time_ * static_cast<Nanoseconds>(count) >= header().share_from_ns;
  const std::size_t parts = shared ? std::min(workers, (count + kStepGrain - 1) / kStepGrain) : 1;
  timed_ = header().serial % kTimedEvery == 0;
  for (std::uint32_t file = 0; timed_ && file < header().file_count; ++file) {
    Out<FileResult>(header().file_results)[file].step_ns.store(0, std::memory_order_relaxed);
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
  std::atomic<std::uint64_t>& word = Out<OutHeader>(0)->workers[worker].word;
  word.store(word.load(std::memory_order_relaxed) >> 32 << 32, std::memory_order_release);
}

void Runner::TimedStep(std::uint32_t robot, Worker& worker) {
  const SteadyClock clock;
  const Nanoseconds begun = clock.Now();
  Step(robot, worker);
  const std::uint32_t file = In<RobotSetup>(header().robots)[robot].file;
  Out<FileResult>(header().file_results)[file].step_ns.fetch_add(
      static_cast<std::uint64_t>(clock.Now() - begun), std::memory_order_relaxed);
}

void Runner::Step(std::uint32_t robot, Worker& worker) {
  const Instance& instance = *instances_[robot];
  const RobotSetup& setup = In<RobotSetup>(header().robots)[robot];
  const RobotReadings& felt = In<RobotReadings>(header().readings)[robot];
  coopdyn_readings readings;
  readings.seed = header().seed;
  readings.step = header().step;
  readings.time_s = header().time_s;
  readings.step_s = header().step_s;
  readings.distance_count = felt.distance_count;
  readings.distance_m = In<double>(setup.distances);
  readings.x_m = felt.x_m;
  readings.y_m = felt.y_m;
  readings.heading_rad = felt.heading_rad;
  readings.forward_m_s = felt.forward_m_s;
  readings.turn_rad_s = felt.turn_rad_s;
  for (int side = 0; side < 2; ++side) {
    readings.wheel_angle_rad[side] = felt.wheel_angle_rad[side];
    readings.wheel_speed_rad_s[side] = felt.wheel_speed_rad_s[side];
  }
  readings.target_count = felt.target_count;
  readings.targets = In<coopdyn_target>(felt.targets);
  readings.neighbour_count = felt.neighbour_count;
  readings.neighbours = In<coopdyn_sighting>(felt.neighbours);
  readings.heard_count = felt.heard_count;
  readings.heard = In<coopdyn_heard>(felt.heard);

  auto& command =
      *static_cast<coopdyn_command*>(worker.command.Last(sizeof(coopdyn_command), alignof(coopdyn_command)));
  command = {};
  const coopdyn_controller& functions = instance.plugin->functions();
  std::string why = Guarded("step", [&] { functions.step(instance.state, &readings, &command); });
  if (why.empty()) why = Fault(command);
  if (why.empty()) {
    why = Guarded("save", [&] { Save(instance, setup.states[header().serial & 1], worker); });
  }
  if (!why.empty()) return Fail(robot, why);
  RobotResult& result = this->result(robot);
  result.failed = 0;
  result.forward_m_s = command.forward_m_s;
  result.turn_rad_s = command.turn_rad_s;
  result.message_count = command.message_count;
  for (std::uint32_t i = 0; i < command.message_count; ++i) result.message[i] = command.message[i];
  result.done.store(header().serial, std::memory_order_release);
}

void Runner::Save(const Instance& instance, Place place, Worker& worker) const {
  const std::size_t size = instance.plugin->description().state_size;
  if (size == 0) return;
  void* state = worker.state.Last(size, alignof(std::max_align_t));
  std::memset(state, 0, size);  // what save() leaves out is 0, not another robot's
  instance.plugin->functions().save(instance.state, state);
  std::memcpy(Out<std::byte>(place), state, size);
}

void Runner::Fail(std::uint32_t robot, const std::string& why) const {
  CopyText(Out<char>(header().texts) + robot * kTextSize, kTextSize, why);
  result(robot).failed = 1;
  result(robot).done.store(header().serial, std::memory_order_release);
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
