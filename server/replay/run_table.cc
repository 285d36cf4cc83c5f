// SPDX-License-Identifier: MIT
#include "server/replay/run_table.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "server/model/values.h"
#include "server/replay/verify_chain.h"

namespace coopdyn {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr PoseValues kNowhere{kNan, kNan, kNan, kNan, kNan, kNan, kNan};

PoseValues ToValues(const Pose& X) {
  return {X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()};
}

/// Where the columns are in one scene; -1: not there.
struct Places {
  std::shared_ptr<const Scene> scene;
  std::vector<int> robots, objects, targets;
  std::vector<int> column_of_robot;         // of each robot of the scene
  std::vector<std::size_t> first_distance;  // of each robot of the scene
  std::size_t distances = 0;                // of all its robots
};

Places FindPlaces(const RunColumns& columns, std::shared_ptr<const Scene> scene) {
  Places places;
  std::unordered_map<std::string, int> robots, objects;
  for (std::size_t i = 0; i < scene->robots.size(); ++i) {
    robots.emplace(scene->robots[i].entry.name, static_cast<int>(i));
    places.first_distance.push_back(places.distances);
    places.distances += scene->robots[i].entry.model->sector_count();
  }
  for (std::size_t i = 0; i < scene->objects.size(); ++i) {
    objects.emplace(scene->objects[i].object.name, static_cast<int>(i));
  }
  const auto find = [](const auto& index, const std::string& name) {
    const auto found = index.find(name);
    return found == index.end() ? -1 : found->second;
  };
  places.column_of_robot.assign(scene->robots.size(), -1);
  for (std::size_t i = 0; i < columns.robots.size(); ++i) {
    places.robots.push_back(find(robots, columns.robots[i].name));
    if (places.robots.back() >= 0)
      places.column_of_robot[static_cast<std::size_t>(places.robots.back())] = static_cast<int>(i);
  }
  for (const std::string& name : columns.objects) places.objects.push_back(find(objects, name));
  for (const TargetColumn& column : columns.targets) {
    const auto found = std::find_if(scene->targets.begin(), scene->targets.end(),
                                    [&](const Target& target) { return target.id == column.id; });
    places.targets.push_back(
        found == scene->targets.end() ? -1 : static_cast<int>(found - scene->targets.begin()));
  }
  places.scene = std::move(scene);
  return places;
}

}  // namespace

bool RowPicker::Takes(Nanoseconds time) {
  if (every_ <= 0) return true;
  if (begin_) {
    const Nanoseconds interval = (time - *begin_) / every_;
    if (interval <= last_) return false;
    last_ = interval;
  } else {
    begin_ = time;
  }
  return true;
}

std::string ToNanoseconds(const char* option, double seconds, Nanoseconds& ns) {
  constexpr double kMax_s = 9e9;  // 285 years: what fits
  if (!(std::abs(seconds) <= kMax_s)) return fmt::format("{}: write simulated seconds, e.g. 12.5", option);
  ns = static_cast<Nanoseconds>(std::llround(seconds * 1e9));
  return {};
}

bool FillFrame(const RecordedStep& recorded, std::shared_ptr<const Scene> scene, const RunHeader& header,
               Frame& frame) {
  if (recorded.bodies.size() != scene->body_ids.size()) return false;
  if (!recorded.channels.empty() && recorded.channels.size() != scene->channels.size()) return false;
  frame.step = recorded.step;
  frame.time = recorded.time;
  frame.step_length = header.step_length;
  frame.seed = header.seed;
  frame.bodies = recorded.bodies;
  frame.channels.assign(scene->channels.size(), {});
  for (std::size_t i = 0; i < recorded.channels.size(); ++i) {
    frame.channels[i].position = recorded.channels[i].position;
    frame.channels[i].velocity = recorded.channels[i].velocity;
  }
  frame.commanded.assign(scene->actuators.size(), 0);
  frame.recorded_hash = recorded.hash;
  frame.scene = std::move(scene);
  return true;
}

struct RunTable::Impl {
  explicit Impl(RunReader& reader) : reader(reader) {}

  std::string Choose(const ExportOptions& options);
  std::string Limit(const ExportOptions& options);
  const Places* PlacesOf(std::uint64_t scene);
  /// Whether the set-points of `robot` that no client sent are in the file.
  bool HasSetpoints(const SceneRobot& robot) const {
    return reader.header().what.controllers || robot.entry.controller.empty();
  }
  void TakeSetpoints(const SavedState& state);
  void TakeCommands(const RecordedStep& recorded, const Places& places,
                    const std::function<void(const CommandRow&)>& use);
  bool MakeRow(const RecordedStep& recorded, const Places& places);
  void MakeRobot(const RecordedStep& recorded, const Places& places, std::size_t column);
  std::string Damage(std::uint64_t step) const;
  bool InRange(Nanoseconds time) const { return time >= begin && time <= end; }

  RunReader& reader;
  RunColumns columns;
  RunExtent extent;
  std::uint64_t first = 0, last = 0;  // steps to read
  Nanoseconds begin = 0, end = 0;     // times to use, both included
  Nanoseconds every = 0;
  std::uint64_t steps = 0;  // recorded in that time
  std::uint64_t max_rows = 0;
  std::map<std::uint64_t, Places> places_of;  // by scene number

  // While rows are read:
  std::vector<std::vector<double>> in_force;  // set-points of each robot's channels, by column
  Frame frame;
  RunRow row;
};

std::string RunTable::Impl::Limit(const ExportOptions& options) {
  extent = reader.extent();
  begin = extent.begin;
  end = extent.end;
  if (options.from_s) {
    if (std::string error = ToNanoseconds("--from", *options.from_s, begin); !error.empty()) return error;
  }
  if (options.until_s) {
    if (std::string error = ToNanoseconds("--until", *options.until_s, end); !error.empty()) return error;
  }
  if (std::string error = ToNanoseconds("--every", options.every_s, every); !error.empty()) return error;
  if (every < 0) return "--every: write a time above 0, e.g. 0.1";
  const std::string lasts =
      fmt::format("the run lasts from {} to {} s", FormatNumber(ToSeconds(extent.begin)),
                  FormatNumber(ToSeconds(extent.end)));
  if (begin > end && options.from_s && options.until_s && *options.from_s > *options.until_s) {
    return "--from " + FormatNumber(*options.from_s) + " is after --until " + FormatNumber(*options.until_s);
  }
  if (begin > extent.end) return "--from " + FormatNumber(*options.from_s) + ": " + lasts;
  if (end < extent.begin) return "--until " + FormatNumber(*options.until_s) + ": " + lasts;
  const auto from = reader.StepAt(begin, false);
  if (!from) return reader.error();
  const auto until = reader.StepAt(end, false);
  if (!until) return reader.error();
  first = *from;
  last = *until;
  return {};
}

const Places* RunTable::Impl::PlacesOf(std::uint64_t scene) {
  const auto found = places_of.find(scene);
  if (found != places_of.end()) return &found->second;
  std::shared_ptr<const Scene> read = reader.SceneOf(scene);
  if (read == nullptr) return nullptr;
  return &places_of.emplace(scene, FindPlaces(columns, std::move(read))).first->second;
}

std::string RunTable::Impl::Choose(const ExportOptions& options) {
  if (std::string error = Limit(options); !error.empty()) return error;
  std::map<std::uint64_t, std::shared_ptr<const Scene>> by_number;
  const bool whole = reader.ForEach(first, last, true, [&](const RecordedStep& step) {
    if (!InRange(step.time)) return true;
    ++steps;
    if (!by_number.contains(step.scene)) by_number.emplace(step.scene, reader.SceneOf(step.scene));
    return by_number[step.scene] != nullptr;
  });
  std::vector<std::shared_ptr<const Scene>> scenes;
  for (const auto& [number, scene] : by_number) {
    if (scene == nullptr) return reader.error();
    scenes.push_back(scene);
  }
  if (!whole) return reader.error();
  if (steps == 0) {
    return fmt::format("there is no recorded step from {} to {} s", FormatNumber(ToSeconds(begin)),
                       FormatNumber(ToSeconds(end)));
  }
  std::string error;
  columns = ChooseColumns(scenes, options, error);
  const Nanoseconds spacing = std::max(every, reader.header().pose_every);
  max_rows = steps;
  if (spacing > 0) max_rows = std::min(max_rows, static_cast<std::uint64_t>((end - begin) / spacing) + 2);
  return error;
}

std::string RunTable::Impl::Damage(std::uint64_t step) const {
  return reader.error().empty() ? fmt::format("step {} does not fit its scene: the file is damaged", step)
                                : reader.error();
}

/// Set-points as they are after a keyframe.
void RunTable::Impl::TakeSetpoints(const SavedState& state) {
  const Frame& exact = *state.frame;
  for (std::size_t i = 0; i < columns.robots.size(); ++i) {
    std::fill(in_force[i].begin(), in_force[i].end(), kNan);
    const int place = exact.scene->FindRobot(columns.robots[i].name);
    if (place < 0) continue;
    const std::span<const ChannelState> channels = ChannelsOf(exact, place);
    for (std::size_t k = 0; k < std::min(channels.size(), in_force[i].size()); ++k) {
      in_force[i][k] = channels[k].setpoint.reference;
    }
  }
}

void RunTable::Impl::TakeCommands(const RecordedStep& recorded, const Places& places,
                                  const std::function<void(const CommandRow&)>& use) {
  const Scene& scene = *places.scene;
  for (auto next = recorded.commands.begin(); next != recorded.commands.end();) {
    if (next->channel >= scene.channels.size()) return;
    const int place = scene.channels[next->channel].robot;
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(place)];
    const int column = places.column_of_robot[static_cast<std::size_t>(place)];
    const auto first = static_cast<std::uint32_t>(robot.first_channel);
    const auto end = first + static_cast<std::uint32_t>(robot.channel_count);
    bool is_known = HasSetpoints(robot);
    for (; next != recorded.commands.end() && next->channel < end; ++next) {
      is_known |= next->by_client;
      if (column < 0) continue;
      std::vector<double>& setpoints = in_force[static_cast<std::size_t>(column)];
      if (next->channel - first < setpoints.size())
        setpoints[next->channel - first] = next->setpoint.reference;
    }
    if (!use || column < 0 || !is_known || !InRange(recorded.time)) continue;
    const auto at = static_cast<std::size_t>(column);
    use({at, recorded.step, ToSeconds(recorded.time), in_force[at]});
  }
}

void RunTable::Impl::MakeRobot(const RecordedStep& recorded, const Places& places, std::size_t column) {
  RobotValues& values = row.robots[column];
  const RunColumns& all = columns;
  values.X_WR = kNowhere;
  values.heading_rad = kNan;
  values.positions.assign(all.robots[column].channels.size(), kNan);
  values.setpoints = values.positions;
  values.distances_m.assign(all.robots[column].sensors, kNan);
  values.targets.assign(2 * all.targets.size(), kNan);
  if (places.robots[column] < 0) return;
  const auto place = static_cast<std::size_t>(places.robots[column]);
  const SceneRobot& robot = places.scene->robots[place];
  const Pose X_WR = RobotPose(frame, static_cast<int>(place));
  values.X_WR = ToValues(X_WR);
  values.heading_rad = WrapAngle(Heading(X_WR.q));
  for (std::size_t i = 0; !recorded.channels.empty() && i < values.positions.size(); ++i) {
    if (i >= static_cast<std::size_t>(robot.channel_count)) break;
    values.positions[i] = recorded.channels[static_cast<std::size_t>(robot.first_channel) + i].position;
  }
  if (HasSetpoints(robot)) values.setpoints = in_force[column];
  if (recorded.distances.size() == places.distances) {
    const std::size_t count = robot.entry.model->sector_count();
    for (std::size_t i = 0; i < std::min(count, values.distances_m.size()); ++i)
      values.distances_m[i] = static_cast<double>(recorded.distances[places.first_distance[place] + i]);
  }
  const std::size_t targets = places.scene->targets.size();
  if (recorded.targets.size() != 2 * targets * places.scene->robots.size()) return;
  for (std::size_t i = 0; i < places.targets.size(); ++i) {
    if (places.targets[i] < 0) continue;
    const std::size_t at = 2 * (place * targets + static_cast<std::size_t>(places.targets[i]));
    values.targets[2 * i] = static_cast<double>(recorded.targets[at]);
    values.targets[2 * i + 1] = static_cast<double>(recorded.targets[at + 1]);
  }
}

bool RunTable::Impl::MakeRow(const RecordedStep& recorded, const Places& places) {
  if (!FillFrame(recorded, places.scene, reader.header(), frame)) return false;
  row.step = recorded.step;
  row.time_s = ToSeconds(recorded.time);
  row.hash = recorded.hash;
  for (std::size_t i = 0; i < row.robots.size(); ++i) MakeRobot(recorded, places, i);
  for (std::size_t i = 0; i < row.objects.size(); ++i) {
    const int place = places.objects[i];
    row.objects[i] =
        place < 0 ? kNowhere
                  : ToValues(ObjectPose(frame, places.scene->objects[static_cast<std::size_t>(place)]));
  }
  return true;
}

std::unique_ptr<RunTable> RunTable::Make(RunReader& reader, const ExportOptions& options,
                                         std::string& error) {
  auto impl = std::make_unique<Impl>(reader);
  error = impl->Choose(options);
  if (!error.empty()) return nullptr;
  return std::unique_ptr<RunTable>(new RunTable(std::move(impl)));
}

RunTable::RunTable(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RunTable::~RunTable() = default;

const RunColumns& RunTable::columns() const {
  return impl_->columns;
}

const RecordWhat& RunTable::what() const {
  return impl_->reader.header().what;
}

std::uint64_t RunTable::max_rows() const {
  return impl_->max_rows;
}

std::string RunTable::ReadEvents(std::vector<Event>& events) {
  events = impl_->reader.Events();
  if (!impl_->reader.error().empty()) return impl_->reader.error();
  const double begin_s = ToSeconds(impl_->begin), end_s = ToSeconds(impl_->end);
  std::erase_if(events, [&](const Event& e) { return e.time_s < begin_s || e.time_s > end_s; });
  return {};
}

std::string RunTable::ForEach(const Uses& uses, const ExportProgress& progress) {
  Impl& run = *impl_;
  constexpr std::uint64_t kStepsPerReport = 32;
  run.row.robots.resize(run.columns.robots.size());
  run.row.objects.resize(run.columns.objects.size());
  run.in_force.clear();
  for (const RobotColumn& robot : run.columns.robots) run.in_force.emplace_back(robot.channels.size(), kNan);
  if (std::string damage = WhyDamaged(run.reader, run.first, run.last); !damage.empty()) return damage;
  const SavedStatePtr keyframe = run.reader.Keyframe(run.first);
  if (keyframe == nullptr) return run.Damage(run.first);
  run.TakeSetpoints(*keyframe);

  std::string error;
  RowPicker picker(run.every);
  std::uint64_t expected = keyframe->frame->step, done = 0;
  const auto use = [&](const RecordedStep& recorded) {
    const Places* places = run.PlacesOf(recorded.scene);
    if (places == nullptr) {
      error = run.Damage(recorded.step);
      return false;
    }
    if (recorded.step != expected) {  // steps were lost, and commands with them; then a keyframe follows
      const SavedStatePtr next = run.reader.Keyframe(recorded.step);
      if (next == nullptr) {
        error = run.Damage(recorded.step);
        return false;
      }
      if (next->frame->step == recorded.step) run.TakeSetpoints(*next);
    }
    expected = recorded.step + 1;
    run.TakeCommands(recorded, *places, uses.command);
    if (!run.InRange(recorded.time)) return true;
    const bool shown = !recorded.bodies.empty() || places->scene->body_ids.empty();
    if (shown && picker.Takes(recorded.time)) {
      if (!run.MakeRow(recorded, *places)) {
        error = run.Damage(recorded.step);
        return false;
      }
      uses.row(run.row);
    }
    const double share =
        static_cast<double>(++done) / static_cast<double>(std::max<std::uint64_t>(run.steps, 1));
    if (done % kStepsPerReport == 0 && progress && !progress(std::min(share, 1.0))) error = kExportStopped;
    return error.empty();
  };
  if (!run.reader.ForEach(keyframe->frame->step, run.last, false, use) && error.empty()) {
    error = run.Damage(run.last);
  }
  return error;
}

}  // namespace coopdyn
