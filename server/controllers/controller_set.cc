// SPDX-License-Identifier: MIT
#include "server/controllers/controller_set.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

#include "server/base/printable.h"
#include "server/controllers/child_backend.h"

namespace coopdyn {

namespace {

constexpr std::size_t kPage = 4096;

/// When `file` was last written, ns; -1: it is not there.
std::int64_t WrittenAt(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return -1;
  return status.st_mtim.tv_sec * kNanosecondsPerSecond + status.st_mtim.tv_nsec;
}

/// The text that another process has left there, printable.
std::string TextAt(const char* shared, std::size_t size) {
  std::string text(shared, size);
  text.resize(strnlen(text.c_str(), size));
  return Printable(text);
}

/// The file's result, which another process has written: nothing in it is trusted to be sound.
LoadedController Take(std::string file, const FileResult& result) {
  LoadedController loaded{std::move(file), std::nullopt, ""};
  if (Once(result.refused) != 0) {
    loaded.why = "cannot be used: " + TextAt(result.why, sizeof(result.why));
    return loaded;
  }
  ControllerDescription description;
  description.help = TextAt(result.help, sizeof(result.help));
  description.readings = Once(result.readings);
  description.state_size = std::min<std::uint32_t>(Once(result.state_size), COOPDYN_MAX_STATE);
  const std::size_t options = std::min<std::size_t>(Once(result.option_count), COOPDYN_MAX_OPTIONS);
  for (std::size_t i = 0; i < options; ++i) {
    const OptionRecord& option = result.options[i];
    description.options.push_back({TextAt(option.name, kNameSize), TextAt(option.help, kTextSize),
                                   Once(option.value), Once(option.min), Once(option.max)});
  }
  loaded.description = std::move(description);
  return loaded;
}

}  // namespace

std::uint64_t DefaultControllerMemory() {
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages < 0 || page < 0 ? 0 : static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) / 2;
}

ControllerSet::ControllerSet(std::vector<std::string> files, const ControllerOptions& options,
                             const Clock& clock, const Logger& logger, WorkerPool& pool)
    : pool_(pool), threads_(std::clamp<int>(options.threads, 1, kMaxWorkers)) {
  Layout in(kPage), out;
  InHeader header{};
  out.Add<OutHeader>(1);
  header.file_count = static_cast<std::uint32_t>(files.size());
  header.files = in.Add<FileSetup>(files.size());
  header.file_results = out.Add<FileResult>(files.size());
  items_ = in.Add<std::uint32_t>(files.size());
  const Place spare_items = in.Add<std::uint32_t>(files.size());
  std::vector<std::string> paths;
  std::vector<Place> places;
  for (const std::string& file : files) {
    written_.push_back(WrittenAt(file));
    // Without a slash dlopen() would look elsewhere.
    paths.push_back(std::filesystem::absolute(file).string());
    places.push_back(in.Add<char>(paths.back().size() + 1));
  }
  areas_ = std::make_unique<Areas>();
  areas_->in = SharedArea(in.end(), SharedArea::Others::kRead);
  areas_->out = SharedArea(out.end(), SharedArea::Others::kWrite);
  areas_->spare_items = spare_items;
  readings_end_ = in.end();
  InHeader& ours = areas_->header();
  ours.file_count = header.file_count;
  ours.share_from_ns = options.share_from;
  ours.memory_bytes = options.memory_bytes;
  ours.files = header.files;
  ours.file_results = header.file_results;
  std::vector<std::uint32_t> items(files.size());
  for (std::uint32_t i = 0; i < files.size(); ++i) {
    items[i] = i;
    areas_->in.At<FileSetup>(ours.files)[i].path = places[i];
    std::memcpy(areas_->in.At<char>(places[i]), paths[i].c_str(), paths[i].size() + 1);
  }
  if (options.in_process) {
    backend_ = std::make_unique<InProcessBackend>(*areas_, pool);
  } else {
    auto launcher = options.launcher;
    if (launcher == nullptr) launcher = std::make_shared<ChildLauncher>(options.program);
    backend_ = std::make_unique<ChildBackend>(
        *areas_,
        ChildBackend::Options{launcher, threads_, options.deadline, options.interrupted, options.silence},
        clock, logger);
  }
  if (files.empty()) return;
  Run(Operation::kLoad, items);
  for (std::size_t i = 0; i < files.size(); ++i) {
    loaded_.push_back(Take(std::move(files[i]), areas_->file_result(static_cast<std::uint32_t>(i))));
  }
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

std::vector<Casualty> ControllerSet::Create(std::span<const ControlledRobot> robots, std::uint64_t seed) {
  const std::size_t count = robots.size();
  Layout in(readings_end_), out(areas_->out.bytes());
  const Place setups = in.Add<RobotSetup>(count);
  const Place readings = in.AddBytes(count * sizeof(RobotReadings), 64);
  items_ = in.Add<std::uint32_t>(count);
  areas_->spare_items = in.Add<std::uint32_t>(std::max(count, loaded_.size()));
  const Place results = out.AddBytes(count * sizeof(RobotResult), 64);
  const Place texts = out.Add<char>(count * kTextSize);
  std::vector<RobotSetup> setup(count);
  for (std::size_t i = 0; i < count; ++i) {
    const RobotModel& model = *robots[i].robot->entry.model;
    const std::size_t sensors = model.distance_sensors.size();
    setup[i].name = in.Add<char>(robots[i].robot->entry.name.size() + 1);
    for (Place* place :
         {&setup[i].bearing_rad, &setup[i].opening_rad, &setup[i].max_m, &setup[i].distances}) {
      *place = in.Add<double>(sensors);
    }
    setup[i].options = in.Add<double>(robots[i].options.size());
    const std::size_t size = loaded_[robots[i].file].description->state_size;
    for (Place& place : setup[i].states) place = out.AddBytes(size, alignof(std::max_align_t));
  }
  readings_end_ = in.end();
  areas_->Grow(in.end(), out.end());

  InHeader& header = areas_->header();
  header.robot_count = static_cast<std::uint32_t>(count);
  header.robots = setups;
  header.readings = readings;
  header.robot_results = results;
  header.texts = texts;
  header.seed = seed;
  std::vector<std::uint32_t> items(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const SceneRobot& robot = *robots[i].robot;
    const RobotModel& model = *robot.entry.model;
    setup[i].file = robots[i].file;
    setup[i].id = robot.id.value;
    setup[i].radius_m = model.footprint_radius_m;
    setup[i].wheel_radius_m = model.drive()->wheel_radius_m;
    setup[i].track_m = model.drive()->track_m;
    setup[i].max_wheel_speed_rad_s = model.drive()->max_wheel_speed_rad_s;
    setup[i].distance_count = model.distance_sensors.size();
    setup[i].restore = kNoState;
    std::memcpy(areas_->in.At<char>(setup[i].name), robot.entry.name.c_str(), robot.entry.name.size() + 1);
    for (std::size_t sensor = 0; sensor < model.distance_sensors.size(); ++sensor) {
      areas_->in.At<double>(setup[i].bearing_rad)[sensor] = model.distance_sensors[sensor].bearing_rad;
      areas_->in.At<double>(setup[i].opening_rad)[sensor] = model.distance_sensors[sensor].opening_rad;
      areas_->in.At<double>(setup[i].max_m)[sensor] = model.distance_sensors[sensor].max_range_m;
    }
    std::copy(robots[i].options.begin(), robots[i].options.end(), areas_->in.At<double>(setup[i].options));
    if (!robots[i].state.empty()) setup[i].restore = static_cast<std::int32_t>((header.serial + 1) & 1);
    areas_->setup(i) = setup[i];
    if (!robots[i].state.empty()) {
      std::memcpy(areas_->out.At<std::byte>(setup[i].states[setup[i].restore]), robots[i].state.data(),
                  robots[i].state.size());
    }
    items[i] = i;
  }
  Run(Operation::kCreate, items);
  AddFailures(items);
  return std::exchange(casualties_, {});
}

std::span<const Casualty> ControllerSet::Step(const Frame& frame, std::span<const std::uint32_t> items) {
  InHeader& header = areas_->header();
  header.seed = frame.seed;
  header.step = frame.step;
  header.time_s = frame.time_s();
  header.step_s = ToSeconds(frame.step_length);
  Run(Operation::kStep, items);
  AddFailures(items);
  return casualties_;
}

std::span<const std::byte> ControllerSet::StateOf(std::uint32_t robot) const {
  const RobotSetup& setup = areas_->setup(robot);
  const std::uint64_t done = areas_->result(robot).done.load(std::memory_order_acquire);
  return {areas_->out.At<std::byte>(setup.states[done & 1]), loaded_[setup.file].description->state_size};
}

ControllerCost ControllerSet::slowest() const {
  ControllerCost slowest;
  for (std::uint32_t file = 0; file < loaded_.size(); ++file) {
    const auto took =
        static_cast<Nanoseconds>(areas_->file_result(file).step_ns.load(std::memory_order_relaxed));
    if (took > slowest.per_step) slowest = {std::filesystem::path(loaded_[file].file).stem().string(), took};
  }
  return slowest;
}

int ControllerSet::child_pid() const {
  const auto* child = dynamic_cast<const ChildBackend*>(backend_.get());
  return child == nullptr ? -1 : child->pid();
}

void ControllerSet::Run(Operation operation, std::span<const std::uint32_t> items) {
  InHeader& header = areas_->header();
  header.operation = operation;
  ++header.serial;
  header.items = items_;
  header.item_count = static_cast<std::uint32_t>(items.size());
  header.workers = static_cast<std::uint32_t>(threads_);
  std::copy(items.begin(), items.end(), areas_->in.At<std::uint32_t>(items_));
  casualties_ = backend_->Run();
}

void ControllerSet::AddFailures(std::span<const std::uint32_t> items) {
  const InHeader& header = areas_->header();
  const std::size_t lost = casualties_.size();
  const RobotResult* results = areas_->out.At<RobotResult>(header.robot_results);
  for (const std::uint32_t item : items) {
    const RobotResult& result = results[item];
    const bool done = result.done.load(std::memory_order_acquire) == header.serial;
    if (done && Once(result.failed) == 0) continue;
    const auto same = [item](const Casualty& casualty) { return casualty.item == item; };
    if (std::any_of(casualties_.begin(), casualties_.begin() + static_cast<std::ptrdiff_t>(lost), same))
      continue;
    const char* text = areas_->out.At<char>(header.texts) + item * kTextSize;
    casualties_.push_back(
        {item, done ? TextAt(text, kTextSize)
                    : std::string("has no result: memory was overwritten, by it or by another")});
  }
  for (const Casualty& casualty : casualties_) backend_->Drop(casualty.item);
}

}  // namespace coopdyn
