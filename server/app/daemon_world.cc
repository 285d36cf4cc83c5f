// SPDX-License-Identifier: MIT
// Sets up the daemon's world: from a scenario, from a moment of a recording, or as a playback.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <thread>
#include <utility>

#include "server/app/daemon.h"
#include "server/model/text_file.h"
#include "server/replay/state_at.h"

namespace coopdyn {

int ThreadsOf(const ServeOptions& options) {
  const unsigned cores = std::thread::hardware_concurrency();
  return cores == 0 ? options.threads : std::min(options.threads, static_cast<int>(cores));
}

bool IsLoopback(const std::string& host) {
  return host.empty() || host == "localhost" || host == "::1" || host.starts_with("127.");
}

bool IsOwnPort(const ServeOptions& options, int port) {
  if (port == 0) return false;
  if (port == options.name_port || port == options.http_port) return true;
  const bool any = options.port == 0 || options.any_port;
  return !any && port >= options.port && port < options.port + kOwnPorts;
}

bool BeyondLoopback(const ServeOptions& options) {
  return std::any_of(options.hosts.begin(), options.hosts.end(),
                     [](const auto& host) { return !IsLoopback(host); });
}

ControllerOptions ControllersOf(const ServeOptions& options) {
  ControllerOptions controllers;
  controllers.in_process = options.controllers_in_process;
  controllers.threads = ThreadsOf(options);
  if (options.controller_memory_bytes) controllers.memory_bytes = *options.controller_memory_bytes;
  return controllers;
}

std::string Daemon::StartWorld() {
  if (!options_.play.file.empty()) return StartPlayback();
  return options_.from.empty() ? StartScenario() : StartFromRecording();
}

std::string Daemon::StartScenario() {
  Diagnostics diagnostics;
  const std::optional<std::uint64_t> seed = options_.run.seed;
  const auto scenario =
      options_.scenario_text
          ? ReadScenario(WithSettings(*options_.scenario_text, options_.settings, diagnostics), kPipe,
                         models_, false, diagnostics, seed)
          : LoadScenario(options_.scenario, models_, diagnostics, false, seed, options_.settings);
  const bool built =
      scenario != nullptr && !diagnostics.has_errors() && stepper_.Start(scenario, diagnostics);
  if (!built) return diagnostics.ToString();
  const std::size_t said = std::min(diagnostics.all().size(), Diagnostics::kMaxKept);
  for (std::size_t i = 0; i < said; ++i)
    logger_->warn("{}: {}", ToString(diagnostics.all()[i].where), diagnostics.all()[i].text);
  if (const auto all = static_cast<std::size_t>(diagnostics.warnings()); all > said)
    logger_->warn("and {} more warnings: coopdyn check sums them up", all - said);
  return {};
}

std::string Daemon::StartFromRecording() {
  const auto [file, when] = SplitMoment(options_.from);
  std::string error;
  const auto reader = RunReader::Open(file, error);
  if (reader == nullptr) return error;
  std::error_code missing;
  if (std::filesystem::equivalent(options_.record.file, reader->file(), missing)) {
    return "--record " + options_.record.file +
           " would overwrite the recording that --from reads: write another name";
  }
  Diagnostics diagnostics;
  if (reader->LoadScenario(models_.path(), diagnostics) == nullptr) return diagnostics.ToString();
  const std::optional<std::uint64_t> step = FindStep(*reader, when, error);
  if (!step) return error;
  const SavedStatePtr state = StateAt(*reader, *step, replay_services(), error);
  if (state == nullptr) return error;
  if (!stepper_.StartFrom(state, diagnostics)) return diagnostics.ToString();
  if (options_.run.duration_s && *options_.run.duration_s <= state->frame->time_s()) {
    return fmt::format("--duration {} is over at t = {} s, where the run continues: write a later time",
                       *options_.run.duration_s, state->frame->time_s());
  }
  if (options_.run.steps && *options_.run.steps <= state->frame->step) {
    return fmt::format("--steps {} is over at step {}, where the run continues: write a higher number",
                       *options_.run.steps, state->frame->step);
  }
  return {};
}

std::string Daemon::StartPlayback() {
  std::string error;
  auto reader = RunReader::Open(options_.play.file, error);
  if (reader == nullptr) return error;
  if (reader->mended()) logger_->info("{}: mended, the recording had not been closed", reader->file());
  Diagnostics diagnostics;
  if (reader->LoadScenario(models_.path(), diagnostics) == nullptr) return diagnostics.ToString();
  const RunExtent extent = reader->extent();
  const Nanoseconds start = options_.play.start;  // 0: the beginning
  const bool before = start != 0 && start < extent.begin;
  if (before || (start > extent.end && !reader->growing())) {
    return fmt::format("--at {:g} lies {} of {}: write a time from {:g} to {:g}", ToSeconds(start),
                       before ? "before the begin" : "beyond the end", reader->file(),
                       ToSeconds(extent.begin), ToSeconds(extent.end));
  }
  PlayOptions play;
  play.speed = options_.play.speed;
  play.loop = options_.play.loop;
  play.paused = options_.play.paused;
  play.start = options_.play.start;
  player_ = std::make_unique<Player>(Player::Boards{frames_, board_, edits_, run_, bell_}, std::move(reader),
                                     clock_, logger_, play);
  BringUpScenes();
  return player_->Start();
}

void Daemon::BringUpScenes() {
  player_->set_on_scene([this](std::shared_ptr<const Scene> scene) {
    control_.Post([this, scene = std::move(scene)] {
      // Skip it if a newer scene is shown by now: that one is posted too.
      if (frames_.Latest()->scene == scene) ApplyScene(scene, [] {});
    });
  });
}

void Daemon::RunWorld(const std::stop_token& stop) {
  for (;;) {
    std::optional<Edit> next;  // Play, or a Restore that ends a playback
    SavedStatePtr live;
    if (player_ != nullptr) {
      next = player_->Run(stop);
    } else if (std::optional<Stepper::PutAside> put_aside = stepper_.Run(stop)) {
      next = std::move(put_aside->edit);
      live = std::move(put_aside->state);
    }
    if (!next) return;
    if (As<edit::Play>(next->action) != nullptr) {
      Play(*next, live);
    } else if (stepper_.TakeOver(*std::move(next))) {
      player_.reset();
    } else {
      board_.SetPlaying(true);  // refused: the playback continues
    }
  }
}

void Daemon::Play(const Edit& play, const SavedStatePtr& live) {
  auto player = std::make_unique<Player>(Player::Boards{frames_, board_, edits_, run_, bell_},
                                         As<edit::Play>(play.action)->recording, clock_, logger_,
                                         PlayOptions(), frames_.Latest()->epoch);
  EditResult result;
  result.text = player->Start();
  if (result.text.empty()) {
    player_ = std::move(player);
    BringUpScenes();
    result.saved = live;
  } else {
    result.error = Error::kNotPossible;
    if (live != nullptr) stepper_.TakeOver({edit::Restore{live}});
    if (player_ != nullptr) board_.SetPlaying(true);
  }
  result.frame = frames_.Latest();
  if (play.done) play.done(result);
}

RecordingOptions Daemon::recording_options() {
  RecordingOptions recording;
  recording.folder = options_.record.folder;
  recording.what = options_.record.what;
  recording.pose_every = options_.record.every;
  recording.durable = options_.record.durable;
  recording.draw = [this](ImageRequest request) { return images_.Draw(std::move(request)); };
  recording.duration_s = options_.run.duration_s.value_or(0);
  recording.version = kVersion;
  recording.command = options_.command_line;
  if (options_.record.stop_on_failure) {
    recording.on_failure = [this] {
      run_.End(RunEnd::kRecording);
      shutdown_.Request();
    };
  }
  return recording;
}

ReplayServices Daemon::replay_services() {
  return {clock_, logger_, pool_, ControllersOf(options_), models_.path()};
}

}  // namespace coopdyn
