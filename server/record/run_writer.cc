// SPDX-License-Identifier: MIT
#include "server/record/run_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include "server/record/run_open.h"
#include "server/record/run_tables.h"
#include "server/record/space.h"
#include "server/record/state_codec.h"
#include "server/state/pose_codec.h"

namespace coopdyn {

namespace {

constexpr std::size_t kWalBytes = std::size_t{8} << 20;  // size at which the log is merged into the file
constexpr int kCacheKiB = 32 << 10;                      // holds the steps of one commit
constexpr int kCloseTimeoutMs = 200;                     // waits for other processes' readers

std::string SystemText(int code) {
  return std::generic_category().message(code);
}

/// Removes the files that SQLite keeps beside `file`.
void RemoveBeside(const std::string& file) {
  for (const char* end : {"-wal", "-shm", "-journal"}) ::unlink((file + end).c_str());
}

/// Makes `file`, empty. Returns an error text, empty on success.
std::string MakeEmpty(const std::string& file, bool overwrite) {
  if (overwrite) ::unlink(file.c_str());
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return "cannot make " + file + ": " + SystemText(errno);
  ::close(descriptor);
  RemoveBeside(file);
  return {};
}

std::uint64_t SizeOf(const std::string& file) {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 ? static_cast<std::uint64_t>(found.st_size) : 0;
}

}  // namespace

std::string WhyNoRunFile(const std::string& file, bool overwrite) {
  struct stat found {};
  if (::lstat(file.c_str(), &found) != 0) return {};
  if (!S_ISREG(found.st_mode)) return file + " is no file: choose another name";
  if (found.st_size > 0 && !BeginsAsRecording(file)) {
    return file + " is not a recording of coopdyn: choose another name";
  }
  if (!overwrite) return file + " exists: choose another name, or --force";
  if (::access(file.c_str(), W_OK) != 0) return "cannot write " + file + ": " + SystemText(errno);
  std::string ignored;
  if (OpenRun(file, ignored).growing) {
    return file + " is being recorded by another program: choose another name";
  }
  return {};
}

void RemoveRunFile(const std::string& file) {
  ::unlink(file.c_str());
  RemoveBeside(file);
}

RunHeader HeaderOf(const Frame& frame, Mode mode, const RecordWhat& what, Nanoseconds pose_every) {
  const Scenario& scenario = *frame.scene->scenario;
  RunHeader header;
  header.scenario_name = scenario.name;
  header.scenario_file = scenario.file;
  header.scenario_text = scenario.text;
  for (const ScoreEntry& score : scenario.scores) {
    const std::string unit = UnitOf(score.kind);
    header.scores += (header.scores.empty() ? "" : ", ") + score.name + (unit.empty() ? "" : " ") + unit;
  }
  header.sources = scenario.sources;
  header.scenario_seed = scenario.simulation.seed;
  header.seed = frame.seed;
  header.mode = mode;
  header.step_length = frame.step_length;
  header.substeps = scenario.simulation.substeps;
  header.what = what;
  header.pose_every = pose_every;
  std::set<std::string> known;
  for (const ControllerChoice* choice : ControllersOf(*frame.scene)) {
    if (!known.insert(choice->name).second) continue;
    if (std::string hash = FileHash(choice->file); !hash.empty()) {
      header.controllers.push_back({choice->name, std::move(hash)});
    }
  }
  return header;
}

RunWriter::RunWriter(std::string file, RunWriterOptions options)
    : file_(std::move(file)), options_(std::move(options)) {}

RunWriter::~RunWriter() {
  if (database_ != nullptr) database_->RollBack();
}

std::unique_ptr<RunWriter> RunWriter::Create(const std::string& file, RunWriterOptions options,
                                             const SavedState& first, std::string& error) {
  error = WhyNoRunFile(file, options.overwrite);
  if (error.empty()) error = MakeEmpty(file, options.overwrite);
  if (!error.empty()) return nullptr;
  std::unique_ptr<RunWriter> writer(new RunWriter(file, std::move(options)));
  if (writer->Open(first)) return writer;
  error = writer->error_;
  writer.reset();
  RemoveRunFile(file);
  return nullptr;
}

bool RunWriter::Open(const SavedState& first) {
  database_ = Database::Open(file_, Database::Access::kReadWrite, error_);
  if (database_ == nullptr) return false;
  const std::size_t page_size = options_.page_size != 0
                                    ? options_.page_size
                                    : PageSizeFor(StepRowBytes(*first.frame, options_.header.what, true));
  std::string setup =
      "PRAGMA page_size = " + std::to_string(page_size) +
      "; PRAGMA application_id = " + std::to_string(kRunApplicationId) +
      "; PRAGMA user_version = " + std::to_string(kRunFormat) +
      "; PRAGMA journal_mode = WAL; PRAGMA synchronous = " + (options_.durable ? "FULL" : "NORMAL") +
      "; PRAGMA wal_autocheckpoint = " + std::to_string(kWalBytes / page_size) + "; PRAGMA cache_size = -" +
      std::to_string(kCacheKiB);
  if (options_.max_pages > 0) setup += "; PRAGMA max_page_count = " + std::to_string(options_.max_pages);
  setup += "; BEGIN";
  dirty_ = true;
  const bool made = Try([&] {
    database_->Run(setup);
    CreateTables(*database_);
    WriteHeader(*database_, options_.header);
    SetMeta(*database_, "texts", TextsChain(*database_));
    insert_.step = database_->Prepare("INSERT INTO step VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    insert_.image = database_->Prepare("INSERT INTO image VALUES(?, ?, ?, ?, ?, ?)");
    insert_.keyframe = database_->Prepare("INSERT INTO keyframe VALUES(?, ?, ?)");
    insert_.input = database_->Prepare("INSERT INTO input VALUES(?, ?, ?, ?, ?)");
    insert_.event = database_->Prepare("INSERT INTO event VALUES(?, ?, ?, ?, ?, ?)");
  });
  begin_ = first.frame->time;
  if (!made || !AddStep(*first.frame) || !AddImages(first.frame) || !AddKeyframe(first) || !Commit())
    return false;
  now_.steps = committed_.steps = 0;
  return true;
}

template <typename Write>
bool RunWriter::Try(Write write) {
  if (!error_.empty()) return false;
  try {
    if (!dirty_) database_->Run("BEGIN");
    dirty_ = true;
    write();
    return true;
  } catch (const DatabaseError& failed) {
    error_ = failed.what();
    full_ = failed.full();
  }
  database_->RollBack();
  dirty_ = false;
  now_ = committed_;
  return false;
}

void RunWriter::Resume() {
  error_.clear();
  full_ = false;
  // After a checkpoint the log restarts at its beginning and needs less room.
  database_->Try("PRAGMA wal_checkpoint");
}

bool RunWriter::AddStep(const Frame& frame) {
  return Try([&] {
    const bool new_scene = frame.scene != now_.scene;
    if (new_scene) BeginScene(frame);
    FindCommands(frame, new_scene);
    messages_.clear();
    std::copy_if(frame.messages.begin(), frame.messages.end(), std::back_inserter(messages_),
                 [&frame](const SentMessage& sent) { return sent.step == frame.step; });
    WriteRow(frame);
    ++now_.steps;
    now_.end = frame.time;
    now_.last_step = frame.step;
  });
}

bool RunWriter::AddImages(const FramePtr& frame) {
  if (!options_.header.what.images || !options_.draw) return true;
  return Try([&] {
    for (std::size_t i = 0; i < frame->scene->robots.size(); ++i) {
      const RobotModel& model = *frame->scene->robots[i].entry.model;
      for (std::size_t sensor = 0; sensor < model.sensors.size(); ++sensor) {
        if (!std::holds_alternative<CameraModel>(model.sensors[sensor].kind)) continue;
        const auto robot = static_cast<int>(i);
        const FramePtr sample = SampleOf(frame, robot, sensor);
        const auto [last, is_first] = now_.images.try_emplace({robot, sensor}, -1);
        if (last->second >= sample->time) continue;
        last->second = sample->time;
        WriteImage({sample, robot, sensor});
      }
    }
  });
}

void RunWriter::WriteImage(CameraShot shot) {
  const SceneRobot& robot = shot.frame->scene->robots[static_cast<std::size_t>(shot.robot)];
  const std::string& module = robot.entry.model->sensors[shot.sensor].name;
  const auto step = static_cast<std::int64_t>(shot.frame->step);
  const Nanoseconds time = shot.frame->time;
  ImageRequest request;
  request.format = ImageFormat::kJpeg;
  request.shot = std::move(shot);
  const ImageResult drawn = options_.draw(std::move(request));
  if (!drawn.error.empty()) {
    if (std::exchange(drew_none_, true)) return;
    const Event event{static_cast<std::uint64_t>(step), ToSeconds(time), "warning",
                      "pictures are missing from the recording: " + drawn.error};
    WriteEvent(event);
    return;
  }
  insert_.image.Run(step, robot.entry.name, module, static_cast<std::int64_t>(drawn.width),
                    static_cast<std::int64_t>(drawn.height), std::as_bytes(std::span(*drawn.bytes)));
}

void RunWriter::WriteTexts(const Scene& scene) {
  const auto add = [this](const SourceText& source) {
    const auto same = [&source](const SourceText& known) {
      return known.kind == source.kind && known.name == source.name;
    };
    if (std::ranges::any_of(options_.header.sources, same) || std::ranges::any_of(now_.texts, same)) return;
    database_->Prepare("INSERT OR REPLACE INTO text VALUES(?, ?, ?, ?)")
        .Run(source.kind, source.name, source.file, source.text);
    now_.texts.push_back({source.kind, source.name, "", ""});
    SetMeta(*database_, "texts", TextsChain(*database_));
  };
  for (const SceneRobot& robot : scene.robots) {
    const RobotModel& model = *robot.entry.model;
    if (model.text.empty()) continue;
    add({"robot", model.type, model.file, model.text});
  }
  for (const SceneObject& thing : scene.objects) {
    if (thing.object.texture.source != nullptr) add(*thing.object.texture.source);
  }
}

void RunWriter::BeginScene(const Frame& frame) {
  const std::shared_ptr<const Scene> before = std::exchange(now_.scene, frame.scene);
  if (before != nullptr) WriteTexts(*frame.scene);
  WriteScene(*database_, ++now_.scene_number, frame.step, *now_.scene);
  LinkScene(*database_, now_.ends[kSceneTable]);
  const std::vector<bool> was_recomputed = now_.is_recomputed;
  now_.is_recomputed.assign(now_.scene->robots.size(), false);
  for (std::size_t i = 0; i < now_.scene->robots.size() && !options_.header.what.controllers; ++i) {
    now_.is_recomputed[i] = !now_.scene->robots[i].entry.controller.empty();
  }
  if (before == nullptr) return;
  const std::vector<int> places = PlacesIn(*before, *now_.scene);
  for (std::size_t i = 0; i < places.size(); ++i) {  // an unloaded controller stays unloaded
    if (places[i] < 0) continue;
    const auto was = static_cast<std::size_t>(places[i]);
    const bool same =
        before->robots[was].entry.controller.name == now_.scene->robots[i].entry.controller.name;
    if (same) now_.is_recomputed[i] = was_recomputed[was];
  }
}

void RunWriter::FindCommands(const Frame& frame, bool new_scene) {
  const bool is_first = now_.scene_number == 1 && new_scene;  // set-points in force came before the recording
  const Scene& scene = *frame.scene;
  commands_.clear();
  now_.in_force.resize(scene.channels.size());
  for (std::size_t i = 0; i < scene.actuators.size(); ++i) {
    const SceneActuator& actuator = scene.actuators[i];
    const auto robot = static_cast<std::size_t>(actuator.robot);
    const auto begin = static_cast<std::uint32_t>(actuator.first_channel);
    const auto end = begin + static_cast<std::uint32_t>(actuator.channel_count);
    const bool commanded = frame.commanded[i] != 0;
    // A client drives the robot, so its controller is unloaded: its set-points can no longer be recomputed.
    if (commanded && !is_first) now_.is_recomputed[robot] = false;
    bool changed = false;
    for (std::uint32_t channel = begin; channel < end; ++channel) {
      const Setpoint& setpoint = frame.channels[channel].setpoint;
      changed |= !SameBits(setpoint, now_.in_force[channel]);
      now_.in_force[channel] = setpoint;
    }
    if (!new_scene && !commanded && (!changed || now_.is_recomputed[robot])) continue;
    for (std::uint32_t channel = begin; channel < end; ++channel) {
      commands_.push_back({channel, commanded && !is_first, now_.in_force[channel]});
    }
  }
}

bool RunWriter::IsShown(Nanoseconds time) const {
  const Nanoseconds every = options_.header.pose_every;
  return every <= 0 || now_.shown < 0 || time / every != now_.shown / every;
}

void RunWriter::EncodeShown(const Frame& frame) {
  const RecordWhat& what = options_.header.what;
  EncodePoses(frame.bodies, poses_);
  if (what.channels) {
    EncodeChannels(frame.channels, channels_);
    EncodeSensed(frame, channels_);
  }
  if (what.distances) EncodeDistances(frame, distances_);
  if (what.targets) EncodeTargets(frame, targets_);
}

void RunWriter::WriteRow(const Frame& frame) {
  for (auto* blob :
       {&commands_blob_, &messages_blob_, &channels_, &distances_, &targets_, &poses_, &scores_}) {
    blob->clear();
  }
  EncodeCommands(commands_, commands_blob_);
  EncodeMessages(messages_, messages_blob_);
  EncodeScores(frame.scores, scores_);
  if (IsShown(frame.time)) {
    EncodeShown(frame);
    now_.shown = frame.time;
  }
  InsertChained(insert_.step, now_.ends[kStepTable], static_cast<std::int64_t>(frame.step), frame.time,
                static_cast<std::int64_t>(StateHash(frame)), now_.scene_number, commands_blob_,
                messages_blob_, channels_, distances_, targets_, poses_, scores_);
}

bool RunWriter::AddKeyframe(const SavedState& state) {
  return Try([&] {
    InsertChained(insert_.keyframe, now_.ends[kKeyframeTable], static_cast<std::int64_t>(state.frame->step),
                  EncodeState(state));
  });
}

bool RunWriter::AddInput(const RunInput& input) {
  return Try([&] {
    if (const auto* unload = As<edit::UnloadController>(input.what)) {
      const int robot = now_.scene->FindRobot(unload->robot);
      if (robot >= 0) now_.is_recomputed[static_cast<std::size_t>(robot)] = false;
    }
    TableEnd& end = now_.ends[kInputTable];
    const InputText text = Encode(input);
    InsertChained(insert_.input, end, end.id + 1, static_cast<std::int64_t>(input.step), text.action,
                  text.detail);
  });
}

bool RunWriter::AddEvent(const Event& event) {
  return Try([&] { WriteEvent(event); });
}

void RunWriter::WriteEvent(const Event& event) {
  TableEnd& end = now_.ends[kEventTable];
  InsertChained(insert_.event, end, end.id + 1, static_cast<std::int64_t>(event.step),
                static_cast<std::int64_t>(std::llround(event.time_s * 1e9)), event.level, event.text);
}

bool RunWriter::AddLost(std::uint64_t steps) {
  return Try([&] {
    now_.lost += steps;
    SetMeta(*database_, "lost", now_.lost);
  });
}

bool RunWriter::AddLostAfter(std::uint64_t steps) {
  return AddLost(steps) && Try([&] {
           now_.lost_after += steps;
           SetMeta(*database_, "lost_after", now_.lost_after);
         });
}

bool RunWriter::Commit() {
  if (!error_.empty()) return false;
  if (!dirty_) return true;
  const bool written = Try([&] {
    SetMeta(*database_, "ends", EndsText(now_.ends));
    Seal(*database_);
    database_->Run("COMMIT");
  });
  if (written) committed_ = now_;
  dirty_ = false;
  return written;
}

bool RunWriter::Close(std::string& remark) {
  const bool written = Try([&] {
    SetMeta(*database_, "last_step", now_.last_step);
    SetMeta(*database_, "closed", 1);
  });
  if (!written || !Commit()) return false;
  insert_ = Statements();
  database_->Try("PRAGMA busy_timeout = " + std::to_string(kCloseTimeoutMs));
  database_->Try("PRAGMA wal_checkpoint(TRUNCATE)");
  try {
    database_->MakePlain();
  } catch (const DatabaseError&) {
    remark = file_ + " is open elsewhere: " + file_ + "-wal belongs to it until it is closed there";
  }
  database_.reset();
  return true;
}

std::uint64_t RunWriter::bytes() const {
  return SizeOf(file_) + SizeOf(file_ + "-wal");
}

}  // namespace coopdyn
