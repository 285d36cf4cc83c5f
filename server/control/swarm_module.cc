// SPDX-License-Identifier: MIT
#include "server/control/swarm_module.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "protocol/module_tables.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

const SwarmEntry* FindSwarm(const Scenario& scenario, const std::string& word) {
  const auto found =
      std::find_if(scenario.swarms.begin(), scenario.swarms.end(),
                   [&](const SwarmEntry& swarm) { return swarm.name == word || swarm.section == word; });
  return found == scenario.swarms.end() ? nullptr : &*found;
}

std::string NoSuch(const Scene& scene, const std::string& word) {
  constexpr std::size_t kShown = 63;  // longest name
  constexpr std::size_t kListed = 20;
  std::vector<std::string> known;
  for (const SwarmEntry& swarm : scene.scenario->swarms) known.push_back(swarm.name);
  for (const SceneRobot& robot : scene.robots) known.push_back(robot.entry.name);
  std::string text = "there is no robot and no swarm " + word.substr(0, kShown);
  if (known.empty()) return text + ": this scenario has none";
  const std::string near = word.size() > kShown ? "" : Nearest(word, known);
  if (!near.empty()) return text + ": did you mean " + near + "?";
  const bool all = known.size() <= kListed;
  if (!all) known.resize(kListed);
  return text + ": there are " + (all ? JoinNames(known) : JoinNames(known) + " and more (list shows all)");
}

/// The robots (indices into the scene, increasing, each once) named by the words of `text`. A word is a
/// robot's name, the NAME of a [SWARM_n], or `swarm1` for [SWARM_1]; a scenario's names are unique. A leading
/// / is ignored. `error` is set, for error 10, if a word is unknown.
std::vector<int> FindNamedRobots(const Scene& scene, std::string_view text, std::string& error) {
  std::unordered_map<std::string_view, int> index;
  index.reserve(scene.robots.size());
  for (const SceneRobot& robot : scene.robots) {
    index.emplace(robot.entry.name, static_cast<int>(index.size()));
  }
  std::set<int> robots;
  for (std::string word : Words(text)) {
    if (word.size() > 1 && word.front() == '/') word.erase(0, 1);
    if (const auto robot = index.find(word); robot != index.end()) {
      robots.insert(robot->second);
      continue;
    }
    const SwarmEntry* swarm = FindSwarm(*scene.scenario, word);
    if (swarm == nullptr) return error = NoSuch(scene, word), std::vector<int>();
    for (std::size_t i = 1; i <= swarm->count; ++i) {
      const auto member = index.find(swarm->name + "_" + std::to_string(i));
      if (member != index.end()) robots.insert(member->second);
    }
  }
  return {robots.begin(), robots.end()};
}

}  // namespace

SwarmModule::SwarmModule(const GlobalServices& services, int threads, StepInbox::Post post)
    : PeerModule({services.board, services.roster, services.guard, services.clock, services.version},
                 "/swarm", table_, inbox_),
      table_(SwarmTable()),
      pool_(threads),
      inbox_(services.board, services.frames, std::move(post)) {}

SwarmModule::~SwarmModule() {
  inbox_.Close();
}

std::optional<Message> SwarmModule::Answer(Peer& peer, const Message& request) {
  FramePtr frame;
  if (std::optional<Message> common = AnswerCommon(peer, request, frame)) return common;
  Refresh(peer, *frame);
  std::optional<Message> answer;
  switch (request.command) {
    case command::kSelectReadings:
      answer = Select(peer, request, *frame);
      break;
    case command::kReadAll:
      answer = ReadAll(peer, request, *frame);
      break;
    case command::kGetTeam:
      answer = Team(peer, request.command);
      break;
    default:
      answer = Change(peer, request, *frame);
  }
  if (answer && answer->error == 0) ModuleCore::Stamp(*answer, *frame);
  return answer;
}

std::optional<Message> SwarmModule::Change(Peer& peer, const Message& request, const Frame& frame) {
  if (request.command == command::kHello) return Hello(peer, request);
  if (request.command == command::kReady && peer.team.empty()) return Ready(peer, request);
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  switch (request.command) {
    case command::kReady:
      return Ready(peer, request);
    case command::kClaim:
    case command::kRelease:
      return ClaimOrRelease(peer, request, frame);
    case command::kStepAll:
      return StepAll(peer, request);
    case command::kStopTeam:
      board().StopTeam(SlotsOf(peer.team), peer.client.client);
      return ReplyTo(request.command);
    default:
      return ErrorReply(request.command, Error::kUnknownCommand, "describe (1) lists the commands of /swarm");
  }
}

Message SwarmModule::Hello(Peer& peer, const Message& request) {
  if (std::optional<Message> refusal = TakeHello(peer, request)) return *refusal;
  const Client& client = peer.client.client;
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  for (const ClientId displaced : board().HelloAll(client)) {
    CloseClient(displaced, "taken over by " + client.name);
  }
  return ReplyTo(request.command);
}

Message SwarmModule::ClaimOrRelease(Peer& peer, const Message& request, const Frame& frame) {
  std::string error;
  const std::vector<int> named = FindNamedRobots(*scene_, request.text, error);
  if (!error.empty()) return ErrorReply(request.command, Error::kNoSuchName, error);
  const bool all = Words(request.text).empty();
  const Client& client = peer.client.client;
  Verdict verdict;
  if (request.command == command::kRelease) {
    verdict = board().ReleaseAll(SlotsOf(all ? peer.team : named), client);
  } else {
    verdict = all ? board().ClaimFree(client) : board().ClaimAll(SlotsOf(named), client);
    peer.lost.clear();
  }
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  Refresh(peer, frame, true);
  return Team(peer, request.command);
}

std::optional<Message> SwarmModule::Ready(Peer& peer, const Message& request) {
  const int steps = request.params.empty() ? 1 : request.params.front();
  StepDone done = Waiter(peer);
  if (peer.team.empty()) {
    board().WaitSteps(steps, std::move(done));
    return std::nullopt;
  }
  const std::vector<SlotId> slots = SlotsOf(peer.team);
  const Verdict verdict = board().StepAll({slots, {}, {}}, peer.client.client, steps, std::move(done));
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  return std::nullopt;
}

std::optional<Message> SwarmModule::StepAll(Peer& peer, const Message& request) {
  if (const auto refusal = commands_.Read(request.text))
    return ErrorReply(request.command, refusal->error, refusal->text);
  if (std::optional<Message> refusal = FindRows(peer, request, peer.rows)) return refusal;
  peer.rows_scene = scene_;
  if (std::optional<Message> refusal = RefuseSize(peer, request.command, *scene_, peer.rows)) return refusal;
  setpoints_.clear();
  std::size_t limited = 0;
  if (!request.data.empty()) {
    if (const auto refusal = commands_.Translate(*scene_, peer.rows, request.data, setpoints_, limited)) {
      const std::string lost = LostText(peer.lost);
      return ErrorReply(request.command, refusal->error,
                        refusal->text + (lost.empty() ? lost : " (" + lost + ")"));
    }
  }
  std::vector<SlotId> others;
  if (!request.params.empty()) {
    for (const int robot : peer.team) {
      if (marks_[static_cast<std::size_t>(robot)] != mark_) AddSlots(robot, others);
    }
  }
  if (limited > 0) peer.text = fmt::format("limited {} robot{}", limited, limited == 1 ? "" : "s");
  const std::vector<SlotId> slots = SlotsOf(peer.rows);
  // The step may run before this returns; PeerModule then makes the reply.
  const Verdict verdict = board().StepAll({slots, setpoints_, others}, peer.client.client, 1, Waiter(peer));
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  if (!peer.lost.empty()) {
    peer.text += (peer.text.empty() ? "" : "; ") + LostText(peer.lost);
    peer.lost.clear();
  }
  return std::nullopt;
}

Message SwarmModule::Select(Peer& peer, const Message& request, const Frame& frame) {
  const int nearest = request.params.empty() ? TeamReadings::kDefaultNearest : request.params.front();
  if (nearest > TeamReadings::kMaxNearest) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      fmt::format("select_readings keeps at most {} neighbours, not {}: select_readings (8) "
                                  "pose neighbours",
                                  TeamReadings::kMaxNearest, nearest));
  }
  const std::string error = peer.readings.Select(request.text, nearest, *frame.scene);
  if (!error.empty()) return ErrorReply(request.command, Error::kWrongParams, error);
  Message reply = ReplyTo(request.command);
  reply.text = peer.readings.Names();
  reply.params = peer.readings.Columns(*frame.scene, peer.sensors);
  return reply;
}

Message SwarmModule::ReadAll(Peer& peer, const Message& request, const Frame& frame) {
  std::vector<int> rows;
  if (std::optional<Message> refusal = FindRows(peer, request, rows)) return *refusal;
  return Table(peer, request.command, frame, board().mode(), rows);
}

Message SwarmModule::Team(const Peer& peer, command::Id command) const {
  Message reply = ReplyTo(command);
  reply.params.reserve(peer.team.size());
  for (const int index : peer.team) {
    const SceneRobot& robot = peer.scene->robots[static_cast<std::size_t>(index)];
    reply.params.push_back(static_cast<std::int32_t>(robot.id.value));
    if (!reply.text.empty()) reply.text += ' ';
    reply.text += robot.entry.name;
  }
  return reply;
}

Message SwarmModule::Table(const Peer& peer, command::Id command, const Frame& frame, Mode mode,
                           std::span<const int> rows) {
  if (std::optional<Message> refusal = RefuseSize(peer, command, *frame.scene, rows)) return *refusal;
  const std::size_t sensors = MostSensors(*frame.scene, rows, peer.sensors);
  const std::vector<std::int32_t> columns = peer.readings.Columns(*frame.scene, sensors);
  const std::int32_t width = std::accumulate(columns.begin(), columns.end(), 0);
  Message reply = ReplyTo(command);
  reply.params = {static_cast<std::int32_t>(mode), static_cast<std::int32_t>(rows.size()), width};
  const std::size_t size = rows.size() * static_cast<std::size_t>(width);
  reply.data.reserve(size + 2);  // time_s and step follow
  reply.data.resize(size);
  peer.readings.Fill(frame, rows, sensors, pool_, reply.data);
  return reply;
}

Message SwarmModule::Stepped(Peer& peer, const StepResult& result) {
  if (peer.command == command::kReady) return PeerModule::Stepped(peer, result);
  MoveRows(peer, *result.frame);
  Message answer = Table(peer, peer.command, *result.frame, result.mode, peer.rows);
  if (answer.error == 0) {
    answer.text = std::move(peer.text);
    ModuleCore::Stamp(answer, *result.frame);
  }
  return answer;
}

void SwarmModule::BeforePush(Peer& peer, const Frame& frame) {
  Refresh(peer, frame);
  pushed_to_ = &peer;
}

Message SwarmModule::Read(const Message& request, const Frame&) {
  return Team(*pushed_to_, request.command);
}

}  // namespace coopdyn
