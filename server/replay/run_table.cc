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
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr PoseValues kNowhere{kNan, kNan, kNan, kNan, kNan, kNan, kNan};

PoseValues ToValues(const Pose& X) {
  return {X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()};
}

}  // namespace

Setpoints::Setpoints(std::size_t channels) : references(channels, kNan), modes(channels, kNan) {}

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
  constexpr double kMax_s = 9e9;  // 285 years: fits into Nanoseconds
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

RunTable::Places RunTable::FindPlaces(std::shared_ptr<const Scene> scene) const {
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
  for (std::size_t i = 0; i < columns_.robots.size(); ++i) {
    places.robots.push_back(find(robots, columns_.robots[i].name));
    if (places.robots.back() >= 0)
      places.column_of_robot[static_cast<std::size_t>(places.robots.back())] = static_cast<int>(i);
  }
  for (const std::string& name : columns_.objects) places.objects.push_back(find(objects, name));
  for (const TargetColumn& column : columns_.targets) {
    const auto found = std::find_if(scene->targets.begin(), scene->targets.end(),
                                    [&](const Target& target) { return target.id == column.id; });
    places.targets.push_back(
        found == scene->targets.end() ? -1 : static_cast<int>(found - scene->targets.begin()));
  }
  places.scene = std::move(scene);
  return places;
}

std::string RunTable::Limit(const ExportOptions& options) {
  const RunExtent extent = reader_.extent();
  begin_ = extent.begin;
  end_ = extent.end;
  if (options.from_s) {
    if (std::string error = ToNanoseconds("--from", *options.from_s, begin_); !error.empty()) return error;
  }
  if (options.until_s) {
    if (std::string error = ToNanoseconds("--until", *options.until_s, end_); !error.empty()) return error;
  }
  if (std::string error = ToNanoseconds("--every", options.every_s, every_); !error.empty()) return error;
  if (every_ < 0) return "--every: write a time above 0, e.g. 0.1";
  const std::string lasts =
      fmt::format("the run lasts from {} to {} s", FormatNumber(ToSeconds(extent.begin)),
                  FormatNumber(ToSeconds(extent.end)));
  if (begin_ > end_ && options.from_s && options.until_s && *options.from_s > *options.until_s) {
    return "--from " + FormatNumber(*options.from_s) + " is after --until " + FormatNumber(*options.until_s);
  }
  if (begin_ > extent.end) return "--from " + FormatNumber(*options.from_s) + ": " + lasts;
  if (end_ < extent.begin) return "--until " + FormatNumber(*options.until_s) + ": " + lasts;
  const auto from = reader_.StepAt(begin_, false);
  if (!from) return reader_.error();
  const auto until = reader_.StepAt(end_, false);
  if (!until) return reader_.error();
  first_ = *from;
  last_ = *until;
  return {};
}

const RunTable::Places* RunTable::PlacesOf(std::uint64_t scene) {
  const auto found = places_of_.find(scene);
  if (found != places_of_.end()) return &found->second;
  std::shared_ptr<const Scene> read = reader_.SceneOf(scene);
  if (read == nullptr) return nullptr;
  return &places_of_.emplace(scene, FindPlaces(std::move(read))).first->second;
}

std::string RunTable::Choose(const ExportOptions& options) {
  if (std::string error = Limit(options); !error.empty()) return error;
  std::map<std::uint64_t, std::shared_ptr<const Scene>> by_number;
  const bool whole = reader_.ForEach(first_, last_, true, [&](const RecordedStep& step) {
    if (!InRange(step.time)) return true;
    ++steps_;
    if (!by_number.contains(step.scene)) by_number.emplace(step.scene, reader_.SceneOf(step.scene));
    return by_number[step.scene] != nullptr;
  });
  std::vector<std::shared_ptr<const Scene>> scenes;
  for (const auto& [number, scene] : by_number) {
    if (scene == nullptr) return reader_.error();
    scenes.push_back(scene);
  }
  if (!whole) return reader_.error();
  if (steps_ == 0) {
    return fmt::format("there is no recorded step from {} to {} s", FormatNumber(ToSeconds(begin_)),
                       FormatNumber(ToSeconds(end_)));
  }
  std::string error;
  logged_.Add(reader_.Events());
  if (!reader_.error().empty()) return reader_.error();
  columns_ = ChooseColumns(scenes, {reader_.has_scores(), logged_.Names(last_)}, options, error);
  if (!options.readings.empty()) moments_ = std::make_unique<PlayFrames>(reader_);
  const Nanoseconds spacing = std::max(every_, reader_.header().pose_every);
  max_rows_ = steps_;
  if (spacing > 0) max_rows_ = std::min(max_rows_, static_cast<std::uint64_t>((end_ - begin_) / spacing) + 2);
  return error;
}

std::string RunTable::Damage(std::uint64_t step) const {
  return reader_.error().empty() ? fmt::format("step {} does not fit its scene: the file is damaged", step)
                                 : reader_.error();
}

void RunTable::TakeSetpoint(std::size_t column, std::size_t channel, const Setpoint& setpoint) {
  std::vector<ChannelColumn>& channels = columns_.robots[column].channels;
  if (channel >= channels.size()) return;
  in_force_[column].references[channel] = setpoint.reference;
  in_force_[column].modes[channel] = static_cast<double>(setpoint.mode);
  channels[channel].modes.insert(setpoint.mode);
}

void RunTable::TakeSetpoints(const SavedState& state) {
  const Frame& exact = *state.frame;
  for (std::size_t i = 0; i < columns_.robots.size(); ++i) {
    in_force_[i] = Setpoints(columns_.robots[i].channels.size());
    const int place = exact.scene->FindRobot(columns_.robots[i].name);
    if (place < 0) continue;
    const std::span<const ChannelState> channels = ChannelsOf(exact, place);
    for (std::size_t k = 0; k < channels.size(); ++k) TakeSetpoint(i, k, channels[k].setpoint);
  }
}

void RunTable::TakeCommands(const RecordedStep& recorded, const Places& places,
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
      TakeSetpoint(static_cast<std::size_t>(column), next->channel - first, next->setpoint);
    }
    if (!use || column < 0 || !is_known || !InRange(recorded.time)) continue;
    const auto at = static_cast<std::size_t>(column);
    use({at, recorded.step, ToSeconds(recorded.time), in_force_[at]});
  }
}

void RunTable::MakeRobot(const RecordedStep& recorded, const Places& places, std::size_t column) {
  RobotValues& values = row_.robots[column];
  values.X_WR = kNowhere;
  values.heading_rad = kNan;
  const std::size_t channels = columns_.robots[column].channels.size();
  values.channels.assign(2 * channels, kNan);
  values.setpoints = Setpoints(channels);
  values.distances_m.assign(columns_.robots[column].sensors, kNan);
  values.targets.assign(2 * columns_.targets.size(), kNan);
  if (places.robots[column] < 0) return;
  const auto place = static_cast<std::size_t>(places.robots[column]);
  const SceneRobot& robot = places.scene->robots[place];
  const Pose X_WR = RobotPose(frame_, static_cast<int>(place));
  values.X_WR = ToValues(X_WR);
  values.heading_rad = WrapAngle(Heading(X_WR.q));
  for (std::size_t i = 0; !recorded.channels.empty() && i < channels; ++i) {
    if (i >= static_cast<std::size_t>(robot.channel_count)) break;
    const ChannelMotion& motion = recorded.channels[static_cast<std::size_t>(robot.first_channel) + i];
    values.channels[i] = motion.position;
    values.channels[channels + i] = motion.velocity;
  }
  if (HasSetpoints(robot)) values.setpoints = in_force_[column];
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

bool RunTable::MakeReadings(const Places& places) {
  const FramePtr moment = moments_->Make(row_.step);
  if (moment == nullptr) return false;
  for (std::size_t i = 0; i < columns_.robots.size(); ++i) {
    std::vector<double>& values = row_.robots[i].readings;
    values.clear();
    for (const ReadingColumn& column : columns_.robots[i].readings) {
      const std::size_t first = values.size();
      values.resize(first + column.values.size(), kNan);
      if (places.robots[i] < 0) continue;
      const RobotModel& model = ModelOf(*moment, places.robots[i]);
      const auto sensor = std::ranges::find(model.sensors, column.module, &SensorModel::name);
      if (sensor == model.sensors.end()) continue;
      FillFixed(*moment, places.robots[i], static_cast<std::size_t>(sensor - model.sensors.begin()),
                std::span(values).subspan(first));
    }
  }
  return true;
}

void RunTable::MakeNumbers(const RecordedStep& recorded) {
  row_.scores.clear();
  for (const ScoreColumn& score : columns_.scores)
    row_.scores.push_back(score.place < recorded.scores.size() ? recorded.scores[score.place].value : kNan);
  row_.logged.clear();
  for (const std::string& name : columns_.logged) {
    const Logged* newest = logged_.Find(name, recorded.step);
    row_.logged.push_back(newest == nullptr ? kNan : newest->value);
  }
}

bool RunTable::MakeRow(const RecordedStep& recorded, const Places& places) {
  if (!FillFrame(recorded, places.scene, reader_.header(), frame_)) return false;
  row_.step = recorded.step;
  row_.time_s = ToSeconds(recorded.time);
  row_.hash = recorded.hash;
  for (std::size_t i = 0; i < row_.robots.size(); ++i) MakeRobot(recorded, places, i);
  for (std::size_t i = 0; i < row_.objects.size(); ++i) {
    const int place = places.objects[i];
    row_.objects[i] =
        place < 0 ? kNowhere
                  : ToValues(ObjectPose(frame_, places.scene->objects[static_cast<std::size_t>(place)]));
  }
  MakeNumbers(recorded);
  return moments_ == nullptr || MakeReadings(places);
}

std::unique_ptr<RunTable> RunTable::Make(RunReader& reader, const ExportOptions& options,
                                         std::string& error) {
  std::unique_ptr<RunTable> table(new RunTable(reader));
  error = table->Choose(options);
  return error.empty() ? std::move(table) : nullptr;
}

std::string RunTable::ReadEvents(std::vector<Event>& events) {
  events = reader_.Events();
  if (!reader_.error().empty()) return reader_.error();
  const double begin_s = ToSeconds(begin_), end_s = ToSeconds(end_);
  std::erase_if(events, [&](const Event& e) { return e.time_s < begin_s || e.time_s > end_s; });
  return {};
}

std::string RunTable::ForEach(const Uses& uses, const ExportProgress& progress) {
  constexpr std::uint64_t kStepsPerReport = 32;
  row_.robots.resize(columns_.robots.size());
  row_.objects.resize(columns_.objects.size());
  in_force_.clear();
  for (const RobotColumn& robot : columns_.robots) in_force_.emplace_back(robot.channels.size());
  if (!is_checked_) {
    if (std::string damage = WhyDamaged(reader_, first_, last_); !damage.empty()) return damage;
    is_checked_ = true;
  }
  const SavedStatePtr keyframe = reader_.Keyframe(first_);
  if (keyframe == nullptr) return Damage(first_);
  TakeSetpoints(*keyframe);

  std::string error;
  RowPicker picker(every_);
  std::uint64_t expected = keyframe->frame->step, done = 0;
  const auto fail = [&](std::uint64_t step) {
    error = Damage(step);
    return false;
  };
  const auto use = [&](const RecordedStep& recorded) {
    const Places* places = PlacesOf(recorded.scene);
    if (places == nullptr) return fail(recorded.step);
    if (recorded.step != expected) {  // steps and their commands were lost; a keyframe follows
      const SavedStatePtr next = reader_.Keyframe(recorded.step);
      if (next == nullptr) return fail(recorded.step);
      if (next->frame->step == recorded.step) TakeSetpoints(*next);
    }
    expected = recorded.step + 1;
    TakeCommands(recorded, *places, uses.command);
    if (!InRange(recorded.time)) return true;
    const bool shown = !recorded.bodies.empty() || places->scene->body_ids.empty();
    if (uses.row && shown && picker.Takes(recorded.time)) {
      if (!MakeRow(recorded, *places)) return fail(recorded.step);
      uses.row(row_);
    }
    const double share =
        static_cast<double>(++done) / static_cast<double>(std::max<std::uint64_t>(steps_, 1));
    if (done % kStepsPerReport == 0 && progress && !progress(std::min(share, 1.0))) error = kExportStopped;
    return error.empty();
  };
  if (!reader_.ForEach(keyframe->frame->step, last_, !uses.row, use) && error.empty()) {
    error = Damage(last_);
  }
  return error;
}

}  // namespace coopdyn
