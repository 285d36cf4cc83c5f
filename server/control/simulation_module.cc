// SPDX-License-Identifier: MIT
#include "server/control/simulation_module.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/module_tables.h"
#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/model/settings.h"
#include "server/model/text_file.h"
#include "server/state/run_input.h"

namespace coopdyn {

namespace {

struct ScenarioRead {
  std::shared_ptr<const Scenario> scenario;  // null: error
  Error error = Error::kOk;
  std::string text;  // diagnostics, one per line; only warnings on success
};

constexpr std::size_t kMaxNames = 40;

bool IsGoodName(const std::string& name) {
  const auto is_letter = [](char c) { return IsLower(c) || IsUpper(c); };
  if (name.empty() || name.size() > SavedStates::kMaxName || !is_letter(name.front())) return false;
  return std::all_of(name.begin(), name.end(),
                     [&is_letter](char c) { return is_letter(c) || IsDigit(c) || c == '_' || c == '-'; });
}

ScenarioRead NoScenario(Error error, std::string text) {
  return {nullptr, error, std::move(text)};
}

ScenarioRead Finish(std::shared_ptr<const Scenario> scenario, const Diagnostics& diagnostics) {
  std::string text = diagnostics.ToString();
  if (!text.empty()) text.pop_back();
  if (scenario == nullptr || diagnostics.has_errors()) return NoScenario(Error::kMalformed, std::move(text));
  return {std::move(scenario), Error::kOk, std::move(text)};
}

std::string KnownNames(const RobotLibrary& robots) {
  std::string list;
  std::size_t count = 0;
  for (const std::string& name : robots.path().ScenarioNames()) {
    if (++count > kMaxNames) return list + ", …";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "there are none on the search path" : "there are " + list;
}

/// The result of `read`; an exception becomes an error.
template <typename Function>
ScenarioRead Guarded(Function read) {
  try {
    return read();
  } catch (const std::exception& exception) {  // e.g. no more memory
    return NoScenario(Error::kInternal, std::string("the scenario cannot be read: ") + exception.what());
  }
}

/// `text`: a bare name on the search path, or a file's text if it contains a line end, a '[' or a '<'. Reads
/// files, which can take seconds. `seed`: of `--seed`, if given.
ScenarioRead ReadRequestedScenario(const std::string& text, RobotLibrary& robots,
                                   std::optional<std::uint64_t> seed) {
  return Guarded([&] {
    Diagnostics diagnostics;
    if (text.find_first_of("\n[<") != std::string::npos) {
      return Finish(ReadScenario(text, "(text)", robots, true, diagnostics, seed), diagnostics);
    }
    if (!IsBareName(text)) {
      return NoScenario(Error::kNoSuchName,
                        "load_scenario takes a name on the daemon's search path, without folders, or the "
                        "text of the file; " +
                            KnownNames(robots));
    }
    if (!robots.path().FindScenario(text)) {
      return NoScenario(Error::kNoSuchName, "there is no scenario " + Printable(text) +
                                                DidYouMean(text, robots.path().ScenarioNames()));
    }
    return Finish(LoadScenario(text, robots, diagnostics, false, seed), diagnostics);
  });
}

/// Reads the file of `current` again from disk.
ScenarioRead ReadScenarioAgain(const Scenario& current, RobotLibrary& robots,
                               std::optional<std::uint64_t> seed) {
  return Guarded([&] {
    if (current.file.empty() || current.file == kPipe) {
      return NoScenario(Error::kNotPossible,
                        "this scenario came as a text, there is no file to read again: upload it again, or "
                        "coopdyn load FILE");
    }
    Diagnostics diagnostics;
    return Finish(LoadScenario(current.file, robots, diagnostics, false, seed, SettingsIn(current.text)),
                  diagnostics);
  });
}

}  // namespace

/// Reads a scenario with random keys again, from the texts it carries, not from disk: a reset is no reload.
class DrawnScenario {
 public:
  /// On the thread that reads scenarios.
  ScenarioRead Read(const Scenario& current, const SearchPath& path, std::uint64_t seed) {
    return Guarded([&] {
      if (library_ == nullptr || text_ != current.text || !SameSources(current.sources)) {
        library_ = std::make_unique<RobotLibrary>(path, current.sources);
        text_ = current.text;
        sources_ = current.sources;
      }
      Diagnostics diagnostics;
      auto scenario = ReadScenario(text_, current.file, *library_, current.file.empty(), diagnostics, seed);
      return Finish(std::move(scenario), diagnostics);
    });
  }

 private:
  bool SameSources(const std::vector<SourceText>& sources) const {
    return std::ranges::equal(sources, sources_, [](const SourceText& a, const SourceText& b) {
      return a.kind == b.kind && a.name == b.name && a.text == b.text;
    });
  }

  std::string text_;
  std::vector<SourceText> sources_;
  std::unique_ptr<RobotLibrary> library_;  // keeps parsed models between resets
};

std::string SavedStates::Objection(const std::string& name) const {
  if (name == kStart) return "start is where the run began: save under another name";
  if (!IsGoodName(name)) {
    return fmt::format(
        "the name of a saved state is a letter, then letters, digits, _ and -, at most {}: save before_turn",
        kMaxName);
  }
  if (states_.size() >= kMaxStates && Find(name) == nullptr) {
    return fmt::format("{} states are saved, more are not kept: save under the name of one of them",
                       kMaxStates);
  }
  return {};
}

void SavedStates::Keep(const std::string& name, SavedStatePtr state) {
  for (auto& [known, kept] : states_) {
    if (known == name) {
      kept = std::move(state);
      return;
    }
  }
  states_.emplace_back(name, std::move(state));
}

SavedStatePtr SavedStates::Find(std::string_view name) const {
  for (const auto& [known, kept] : states_) {
    if (known == name) return kept;
  }
  return nullptr;
}

std::string SavedStates::Names() const {
  std::string names(kStart);
  for (const auto& [name, state] : states_) names += " " + name;
  return names;
}

SimulationModule::SimulationModule(SimulationServices services, StepInbox::Post post)
    : GlobalModule(services, SimulationTable(), std::move(post)),
      services_(std::move(services)),
      drawn_(std::make_shared<DrawnScenario>()) {}

SimulationModule::~SimulationModule() = default;

std::optional<Message> SimulationModule::Change(Peer& peer, const Message& request) {
  if (request.command == command::kQuit) return Done(request);
  if (request.command == command::kSaveState) return Save(peer, request);
  if (request.command == command::kStopAll) peer.text = ResumeText();
  if (request.command == command::kLog) return Log(peer, request);
  if (request.command == command::kEndRun) return Push(peer, edit::EndRun{request.text});
  std::string error;
  if (const std::optional<WorldRequest> world = WorldEditOf(request, error)) {
    if (const auto* load = std::get_if<LoadRequest>(&*world)) return Load(peer, *load);
    if (const auto* restore = std::get_if<RestoreRequest>(&*world)) return Restore(peer, request, *restore);
    return Reset(peer, std::get<edit::Reset>(*world));
  }
  if (std::optional<RunEdit> run = RunEditOf(request, error)) {
    if (const auto* unload = std::get_if<edit::UnloadController>(&*run))
      return Release(peer, request, *unload);
    return Push(peer, *std::move(run));
  }
  return ErrorReply(request.command, Error::kOutOfRange, std::move(error));
}

std::optional<Message> SimulationModule::Load(Peer& peer, const LoadRequest& load) {
  auto done = LaterAllServe(peer, [this] { EndLoad(); });
  // The thread may outlive this module, but not the services.
  loads_.push_back([&robots = services_.robots, &frames = services_.frames, &edits = services_.edits,
                    seed = services_.seed, text = load.text, done = std::move(done)] {
    ScenarioRead read = text ? ReadRequestedScenario(*text, robots, seed)
                             : ReadScenarioAgain(*frames.Latest()->scene->scenario, robots, seed);
    if (read.scenario == nullptr) return done({read.error, std::move(read.text)});
    edits.Push(
        {edit::Load{std::move(read.scenario)}, [done, warnings = std::move(read.text)](EditResult result) {
           if (result.error == Error::kOk) result.text = warnings;
           done(result);
         }});
  });
  if (loads_.size() == 1) BeginLoad();
  return std::nullopt;
}

std::optional<Message> SimulationModule::Reset(Peer& peer, const edit::Reset& reset) {
  if (!reset.seed || services_.frames.Latest()->scene->scenario->random.empty() || services_.run.playback()) {
    return PushNewScene(peer, reset);
  }
  auto done = LaterAllServe(peer, [this] { EndLoad(); });
  loads_.push_back([&robots = services_.robots, &frames = services_.frames, &edits = services_.edits,
                    seed = *reset.seed, drawn = drawn_, done = std::move(done)] {
    const std::shared_ptr<const Scenario> now = frames.Latest()->scene->scenario;
    ScenarioRead read =
        now->simulation.seed == seed ? ScenarioRead() : drawn->Read(*now, robots.path(), seed);
    if (read.error != Error::kOk) return done({read.error, std::move(read.text)});
    edits.Push({edit::Reset{seed, std::move(read.scenario)}, done});
  });
  if (loads_.size() == 1) BeginLoad();
  return std::nullopt;
}

void SimulationModule::EndLoad() {
  loads_.pop_front();
  BeginLoad();
}

void SimulationModule::BeginLoad() {
  if (!loads_.empty()) services_.run_loader(loads_.front());
}

std::string SimulationModule::ResumeText() const {
  const std::vector<CommandBoard::Owner> owners = services_.board.Owners();
  const auto driven = std::count_if(owners.begin(), owners.end(),
                                    [](const CommandBoard::Owner& owner) { return owner.driven; });
  if (driven == 0) return {};
  return fmt::format("robots that loaded controllers drive go on ({}): pause, or release_robot ROBOT",
                     driven);
}

std::optional<Message> SimulationModule::Release(Peer& peer, const Message& request,
                                                 const edit::UnloadController& unload) {
  const std::string& robot = unload.robot;
  const std::vector<CommandBoard::Owner> owners = services_.board.Owners();
  for (const CommandBoard::Owner& owner : owners) {
    if (owner.robot != robot) continue;
    if (owner.driven) return Push(peer, unload);
    if (owner.is_team) {
      // The team continues without the robot, and learns of the loss with its next step.
      const SlotId slot = services_.board.FindSlot(robot);
      services_.board.InputEnded(slot, owner.id);
      services_.board.Closed(slot, owner.id);
    } else if (owner.id != 0) {
      const Client& by = peer.client.client;
      // Frees the robot at once; the policy for a lost client applies when the connection has closed.
      services_.board.InputEnded(services_.board.FindSlot(robot), owner.id);
      services_.actions.CloseClient(robot, owner.id, "released by " + (by.name.empty() ? by.peer : by.name));
    }
    return Done(request, owner.id == 0 ? "nobody owned " + robot : "");
  }
  std::string known;
  for (std::size_t i = 0; i < owners.size() && i < kMaxAwaited; ++i) known += " " + owners[i].robot;
  return ErrorReply(
      request.command, Error::kNoSuchName,
      "there is no robot " + robot + (known.empty() ? ": there are none" : ": there are" + known));
}

std::optional<Message> SimulationModule::Save(Peer& peer, const Message& request) {
  const std::string& name = request.text;
  if (std::string objection = saved_.Objection(name); !objection.empty()) {
    return ErrorReply(request.command, Error::kNotPossible, std::move(objection));
  }
  return Push(peer, edit::Save{}, [this, name](const EditResult& result) {
    // Other clients may have saved meanwhile.
    if (result.error == Error::kOk && saved_.Objection(name).empty()) saved_.Keep(name, result.saved);
  });
}

std::optional<Message> SimulationModule::Restore(Peer& peer, const Message& request,
                                                 const RestoreRequest& restore) {
  if (restore.name == SavedStates::kStart) return PushNewScene(peer, edit::Reset{});
  const SavedStatePtr state = saved_.Find(restore.name);
  if (state == nullptr) {
    if (services_.run.playback()) return ErrorReply(request.command, Error::kNotPossible, kPlayingText);
    return ErrorReply(request.command, Error::kNoSuchName,
                      "nothing is saved as " + restore.name + "; save " + restore.name +
                          " keeps the state of now, restore takes one of: " + saved_.Names());
  }
  return PushNewScene(peer, edit::Restore{state});
}

Message SimulationModule::ReadSaved(const Message& request) const {
  Message reply = ReplyTo(request.command, saved_.Names());
  const std::optional<PlaybackStatus> playback = services_.run.playback();
  reply.data.push_back(playback ? ToSeconds(playback->begin) : 0);  // the start
  for (const auto& [name, state] : saved_.all()) reply.data.push_back(state->frame->time_s());
  return reply;
}

std::optional<Message> SimulationModule::PushNewScene(Peer& peer, EditAction action) {
  edits().Push({std::move(action), LaterAllServe(peer)});
  return std::nullopt;
}

std::optional<Message> SimulationModule::Log(Peer& peer, const Message& request) {
  const std::string& name = request.text;
  if (!IsLogName(name)) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      "a name is a letter, then letters, digits and _, at most 63: write log energy 3.5");
  }
  return Push(peer, edit::Log{name, request.data.front()});
}

void SimulationModule::RepeatClock() {
  const FramePtr now = services_.frames.Latest();
  if (now != nullptr && std::exchange(repeated_step_, now->step) == now->step) PushAgain(command::kGetClock);
}

std::string SimulationModule::DeedOf(command::Id command, const EditResult& result) const {
  switch (command) {
    case command::kLoadScenario:
    case command::kReload:
      return "load " + (result.frame == nullptr ? "" : result.frame->scene->scenario->name);
    case command::kRun:
    case command::kPause:
    case command::kReset:
    case command::kRestoreState:
    case command::kSetMode:
    case command::kSetStep:
    case command::kSetSpeed:
    case command::kSetParticipants:
    case command::kStopAll:
      return table().Find(command)->name;
    default:
      return {};
  }
}

void SimulationModule::OnAnswered(const Message& request, bool done) {
  if (request.command == command::kQuit && done) services_.actions.Quit();
}

}  // namespace coopdyn
