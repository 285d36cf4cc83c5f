// SPDX-License-Identifier: MIT
#include "server/controllers/controller_set.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <utility>
#include <variant>

#include "server/base/printable.h"
#include "server/controllers/child_backend.h"
#include "server/controllers/robot_facts.h"
#include "server/controllers/runner.h"
#include "server/model/values.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr std::size_t kPage = 4096;

/// An absolute path: without a slash dlopen() would search other folders.
std::string Path(const std::string& file) {
  return std::filesystem::absolute(file).string();
}

/// The modification time of `file`, ns; -1 if it is missing.
std::int64_t WrittenAt(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return -1;
  return status.st_mtim.tv_sec * kNanosecondsPerSecond + status.st_mtim.tv_nsec;
}

std::vector<std::uint32_t> FirstNumbers(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

/// Runs controllers in this process on the threads of `pool`.
class InProcessBackend final : public Backend {
 public:
  InProcessBackend(Areas& areas, WorkerPool& pool, int threads)
      : areas_(areas), pool_(pool), threads_(threads) {}
  ~InProcessBackend() override { Run(Operation::kEnd, {}); }
  std::vector<Casualty> Run(Operation operation, std::span<const std::uint32_t> items) override {
    areas_.Order(operation, items, threads_);
    runner_.Run(areas_, pool_);
    return {};
  }

 private:
  Areas& areas_;
  WorkerPool& pool_;
  const int threads_;
  Runner runner_;
};

/// A text written by another process, made printable.
std::string TextAt(const char* shared, std::size_t size) {
  std::string text(shared, size);
  text.resize(strnlen(text.c_str(), size));
  return Printable(text);
}

/// Fills `loaded` from the file's result. Another process has written it, so nothing in it is trusted.
void Describe(const FileResult& result, LoadedController& loaded) {
  if (Once(result.refused) != 0) {
    loaded.why = "cannot be used: " + TextAt(result.why, sizeof(result.why));
    return;
  }
  ControllerDescription& description = loaded.description.emplace();
  description.help = TextAt(result.help, sizeof(result.help));
  description.readings = Once(result.readings);
  if ((description.readings & COOPDYN_SENSORS) != 0)
    description.sensors = TextAt(result.sensors, sizeof(result.sensors));
  description.state_size = std::min<std::uint32_t>(Once(result.state_size), COOPDYN_MAX_STATE);
  const std::uint32_t option_count = Once(result.option_count);
  description.takes_any_options = option_count == COOPDYN_ANY_OPTIONS;
  if (description.takes_any_options) return;
  const std::size_t options = std::min<std::size_t>(option_count, COOPDYN_MAX_OPTIONS);
  for (std::size_t i = 0; i < options; ++i) {
    const OptionRecord& option = result.options[i];
    description.options.push_back({TextAt(option.name, kNameSize), TextAt(option.help, kTextSize),
                                   Once(option.value), Once(option.min), Once(option.max)});
  }
}

}  // namespace

std::uint64_t DefaultControllerMemory() {
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages < 0 || page < 0 ? 0 : static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) / 2;
}

std::vector<std::string> ControllerDescription::Faults(const RobotEntry& robot) const {
  const ControllerChoice& choice = robot.controller;
  const RobotModel& model = *robot.model;
  std::vector<std::string> faults;
  const bool has_drive = model.drive() != nullptr && !model.drive_actuator()->module.empty();
  if (supervises()) {
    faults.push_back(
        fmt::format("controller {} is a supervisor and drives no robot: write supervisor {} in [SIMULATION]",
                    choice.name, choice.name));
  } else if (!model.has_actuators()) {
    faults.push_back(
        fmt::format("controller {} has nothing to command: a {} has no actuator module, so no channels",
                    choice.name, model.type));
  } else if (maps() && model.Find<ChannelModel>() == nullptr) {
    faults.push_back(fmt::format(
        "controller {} exchanges mapped values (COOPDYN_MAPPED), and a {} has no channel: give its "
        "model a <coopdyn:channel>",
        choice.name, model.type));
  } else if (!gives_setpoints() && !maps() && !has_drive) {
    faults.push_back(
        fmt::format("controller {} drives by forward and turn, and a {} has no two-wheel drive: choose a "
                    "controller that gives "
                    "set-points (COOPDYN_SETPOINTS)",
                    choice.name, model.type));
  }
  AddOptionFaults(choice, faults);
  return faults;
}

std::vector<std::string> ControllerDescription::SupervisorFaults(const ControllerChoice& choice) const {
  std::vector<std::string> faults;
  if (!supervises()) {
    faults.push_back(
        fmt::format("controller {} drives a robot and is no supervisor: write controller {} in a [ROBOT_n] "
                    "or [SWARM_n] (a "
                    "supervisor asks for COOPDYN_WORLD in describe())",
                    choice.name, choice.name));
  }
  AddOptionFaults(choice, faults);
  return faults;
}

void ControllerDescription::AddOptionFaults(const ControllerChoice& choice,
                                            std::vector<std::string>& faults) const {
  if (takes_any_options) return;
  std::vector<std::string> names;
  for (const ControllerOption& option : options) names.push_back(option.name);
  for (const auto& [name, value] : choice.options) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      faults.push_back(fmt::format("controller {} has no option '{}'{}", choice.name, name,
                                   names.empty() ? ": it takes none" : DidYouMean(name, names)));
      continue;
    }
    const ControllerOption& option = options[static_cast<std::size_t>(found - names.begin())];
    // Not `value < min || …`: that would let nan pass.
    if (value >= option.min && value <= option.max) continue;
    faults.push_back(fmt::format(
        "controller {}: {} must be from {} to {}, not {}; for example: {} {} {}={}{}", choice.name, name,
        option.min, option.max, value, supervises() ? "supervisor" : "controller", choice.name, name,
        option.value, option.help.empty() ? "" : " (" + option.help + ")"));
  }
}

std::vector<std::size_t> ControllerDescription::SensorsOf(const RobotModel& model) const {
  std::vector<std::size_t> wanted;
  if ((readings & COOPDYN_SENSORS) == 0) return wanted;
  const std::vector<std::string> words = SplitWords(sensors);
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    const SensorModel& sensor = model.sensors[i];
    const bool is_camera = std::holds_alternative<CameraModel>(sensor.kind);
    const bool is_named = std::ranges::any_of(
        words, [&sensor](const std::string& word) { return word == sensor.name || word == sensor.type(); });
    const bool has_values = is_camera || FixedCount(sensor.kind) > 0;
    if (has_values && (words.empty() ? !is_camera : is_named)) wanted.push_back(i);
  }
  return wanted;
}

std::vector<double> ControllerDescription::Values(const ControllerChoice& choice) const {
  std::vector<double> values;
  if (takes_any_options) {
    for (const auto& [name, value] : choice.options) values.push_back(value);
  }
  for (const ControllerOption& option : options) {
    const auto given = std::find_if(choice.options.begin(), choice.options.end(),
                                    [&option](const auto& pair) { return pair.first == option.name; });
    values.push_back(given == choice.options.end() ? option.value : given->second);
  }
  return values;
}

ControllerSet::ControllerSet(std::vector<std::string> files, const ControllerOptions& options,
                             const Clock& clock, const Logger& logger, WorkerPool& pool)
    : areas_{{kPage, SharedArea::Others::kRead}, {sizeof(OutHeader), SharedArea::Others::kWrite}} {
  const int threads = std::clamp<int>(options.threads, 1, kMaxWorkers);
  if (options.in_process) {
    backend_ = std::make_unique<InProcessBackend>(areas_, pool, threads);
  } else {
    backend_ =
        std::make_unique<ChildBackend>(areas_,
                                       ChildBackend::Options{options.launcher, threads, options.deadline,
                                                             options.interrupted, options.silence},
                                       clock, logger);
  }
  const std::size_t count = files.size();
  Layout in(kPage), out(sizeof(OutHeader));
  const Place items = in.Add<std::uint32_t>(count), setups = in.Add<FileSetup>(count);
  const Place results = out.Add<FileResult>(count);
  std::vector<Place> paths;
  for (std::string& file : files) {
    written_.push_back(WrittenAt(file));
    loaded_.push_back({std::move(file), std::nullopt, ""});
    paths.push_back(in.Add<char>(Path(loaded_.back().file).size() + 1));
  }
  readings_end_ = in.end();
  areas_.Grow(in.end(), out.end());
  InHeader& header = areas_.header();
  header.file_count = static_cast<std::uint32_t>(count);
  header.items = items;
  header.files = setups;
  header.file_results = results;
  header.share_from_ns = options.share_from;
  header.memory_bytes = options.memory_bytes;
  for (std::size_t i = 0; i < count; ++i) {
    areas_.in.At<FileSetup>(setups)[i].path = paths[i];
    std::strcpy(areas_.in.At<char>(paths[i]), Path(loaded_[i].file).c_str());
  }
  Run(Operation::kLoad, FirstNumbers(count));
  for (std::uint32_t i = 0; i < count; ++i) Describe(areas_.file_result(i), loaded_[i]);
  for (const Casualty& casualty : casualties_) {
    loaded_[casualty.item].description.reset();
    loaded_[casualty.item].why = casualty.why;
  }
}

ControllerSet::~ControllerSet() = default;

bool ControllerSet::is_fresh() const {
  for (std::size_t i = 0; i < loaded_.size(); ++i) {
    if (WrittenAt(loaded_[i].file) != written_[i]) return false;
  }
  return true;
}

int ControllerSet::IndexOf(const std::string& file) const {
  for (std::size_t i = 0; i < loaded_.size(); ++i) {
    if (loaded_[i].file == file) return static_cast<int>(i);
  }
  return -1;
}

std::vector<Casualty> ControllerSet::Create(std::span<const ControlledRobot> robots, const Frame& frame) {
  const std::size_t count = robots.size();
  Layout in(readings_end_), out(areas_.out.bytes());
  const Place items = in.Add<std::uint32_t>(std::max(count, loaded_.size()));
  const Place setups = in.Add<RobotSetup>(count);
  const Place readings = in.AddBytes(count * sizeof(RobotReadings), 64);
  const Place results = out.AddBytes(count * sizeof(RobotResult), 64);
  const Place texts = out.Add<char>(count * kTextSize);
  std::vector<RobotSetup> setup(count);
  std::vector<std::vector<std::size_t>> wanted;  // sensors of each robot
  for (std::size_t i = 0; i < count; ++i) {
    const RobotModel& model = *robots[i].robot->entry.model;
    const std::size_t sensors = model.sector_count();
    const DriveModel drive = model.drive() == nullptr ? DriveModel() : *model.drive();
    const auto channels = static_cast<std::size_t>(robots[i].robot->channel_count);
    coopdyn_robot& facts = setup[i].robot;  // the Place…() functions below add the rest
    facts.id = robots[i].robot->id.value;
    facts.radius_m = model.footprint_radius_m;
    facts.wheel_radius_m = drive.wheel_radius_m;
    facts.track_m = drive.track_m;
    facts.max_wheel_speed_rad_s = drive.max_wheel_speed_rad_s;
    facts.channel_count = channels;
    facts.distance_count = sensors;
    setup[i].file = robots[i].file;
    setup[i].restore = kNoState;
    setup[i].name = in.Add<char>(robots[i].robot->entry.name.size() + 1);
    for (Place* place :
         {&setup[i].bearing_rad, &setup[i].opening_rad, &setup[i].max_m, &setup[i].distances}) {
      *place = in.Add<double>(sensors);
    }
    setup[i].joints = in.Add<coopdyn_joint>(channels);
    setup[i].joint_text_bytes = JointTexts(model).size();
    setup[i].joint_texts = in.Add<char>(setup[i].joint_text_bytes);
    setup[i].channels = in.Add<coopdyn_channel>(channels);
    setup[i].options = in.Add<double>(robots[i].options.size());
    const ControllerDescription& description = *loaded_[robots[i].file].description;
    wanted.push_back(description.SensorsOf(model));
    PlaceSensors(model, wanted.back(), in, setup[i]);
    setup[i].exchange_steps = 1;
    if (description.maps()) PlaceMapped(model, frame.step_length, in, out, setup[i]);
    if (description.takes_any_options) PlaceOptions(robots[i].robot->entry.controller, in, setup[i]);
    setup[i].setpoints = out.Add<coopdyn_setpoint>(description.gives_setpoints() ? channels : 0);
    const std::size_t size = description.state_size;
    for (Place& place : setup[i].states) place = out.AddBytes(size, alignof(std::max_align_t));
  }
  readings_end_ = in.end();
  // After the memory that every step writes: controllers that log nothing never touch these pages.
  for (std::size_t i = 0; i < count; ++i) setup[i].logs = out.Add<coopdyn_logged>(COOPDYN_MAX_LOGS);
  const bool supervised = std::ranges::any_of(
      robots, [this](const ControlledRobot& one) { return loaded_[one.file].description->supervises(); });
  const Place supervision = out.Add<coopdyn_supervision>(supervised ? 1 : 0);
  const Place moves = out.Add<coopdyn_move>(supervised ? COOPDYN_MAX_MOVES : 0);
  areas_.Grow(in.end(), out.end());

  InHeader& header = areas_.header();
  header.supervision = supervision;
  header.moves = moves;
  header.robot_count = static_cast<std::uint32_t>(count);
  header.items = items;
  header.robots = setups;
  header.readings = readings;
  header.robot_results = results;
  header.texts = texts;
  header.seed = frame.seed;
  for (std::uint32_t i = 0; i < count; ++i) {
    const RobotEntry& entry = robots[i].robot->entry;
    std::strcpy(areas_.in.At<char>(setup[i].name), entry.name.c_str());
    const std::vector<SectorModel> sectors = entry.model->sectors();
    for (std::size_t k = 0; k < sectors.size(); ++k) {
      areas_.in.At<double>(setup[i].bearing_rad)[k] = sectors[k].bearing_rad;
      areas_.in.At<double>(setup[i].opening_rad)[k] = sectors[k].opening_rad;
      areas_.in.At<double>(setup[i].max_m)[k] = sectors[k].max_range_m;
    }
    std::ranges::copy(JointTexts(*entry.model), areas_.in.At<char>(setup[i].joint_texts));
    std::ranges::copy(JointsOf(*entry.model), areas_.in.At<coopdyn_joint>(setup[i].joints));
    WriteSensors(*entry.model, wanted[i], areas_, setup[i]);
    WriteMapped(*entry.model, areas_, setup[i]);
    WriteOptions(entry.controller, areas_, setup[i]);
    std::copy(robots[i].options.begin(), robots[i].options.end(), areas_.in.At<double>(setup[i].options));
    if (!robots[i].state.empty()) {
      setup[i].restore = static_cast<std::int32_t>((header.serial + 1) & 1);
      std::copy(robots[i].state.begin(), robots[i].state.end(),
                areas_.out.At<std::byte>(setup[i].states[setup[i].restore]));
    }
    areas_.setup(i) = setup[i];
  }
  RunRobots(Operation::kCreate, FirstNumbers(count));
  return std::exchange(casualties_, {});
}

std::span<const Casualty> ControllerSet::Step(const Frame& frame, std::span<const std::uint32_t> items) {
  InHeader& header = areas_.header();
  header.seed = frame.seed;
  header.step = frame.step;
  header.time_s = frame.time_s();
  header.step_s = ToSeconds(frame.step_length);
  RunRobots(Operation::kStep, items);
  return casualties_;
}

std::span<const std::byte> ControllerSet::StateOf(std::uint32_t robot) const {
  const RobotSetup& setup = areas_.setup(robot);
  const std::uint64_t done = areas_.result(robot).done.load(std::memory_order_acquire);
  return {areas_.out.At<std::byte>(setup.states[done & 1]), loaded_[setup.file].description->state_size};
}

ControllerCost ControllerSet::slowest() const {
  ControllerCost slowest;
  for (std::uint32_t file = 0; file < loaded_.size(); ++file) {
    const auto took =
        static_cast<Nanoseconds>(areas_.file_result(file).step_ns.load(std::memory_order_relaxed));
    if (took > slowest.per_step) slowest = {std::filesystem::path(loaded_[file].file).stem().string(), took};
  }
  return slowest;
}

void ControllerSet::Run(Operation operation, std::span<const std::uint32_t> items) {
  ++areas_.header().serial;
  casualties_ = backend_->Run(operation, items);
}

void ControllerSet::RunRobots(Operation operation, std::span<const std::uint32_t> items) {
  Run(operation, items);
  const std::size_t lost = casualties_.size();
  for (const std::uint32_t item : items) {
    const RobotResult& result = areas_.result(item);
    const bool done = result.done.load(std::memory_order_acquire) == areas_.header().serial;
    if (done && Once(result.failed) == 0) continue;
    const auto same = [item](const Casualty& casualty) { return casualty.item == item; };
    if (std::any_of(casualties_.begin(), casualties_.begin() + static_cast<std::ptrdiff_t>(lost), same))
      continue;
    casualties_.push_back(
        {item, done ? TextAt(areas_.text(item), kTextSize)
                    : std::string("has no result: its memory was overwritten, by it or by another")});
  }
  for (const Casualty& casualty : casualties_) backend_->Drop(casualty.item);
}

}  // namespace coopdyn
