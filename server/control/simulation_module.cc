// SPDX-License-Identifier: MIT
#include "server/control/simulation_module.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>

#include <cmath>
#include <utility>

#include "protocol/module_tables.h"
#include "server/control/scenario_request.h"

namespace coopdyn {

namespace {

Message Ok(const Message& request) {
  Message reply;
  reply.command = request.command;
  return reply;
}

}  // namespace

SimulationModule::SimulationModule(SimulationServices services, StepInbox::Post post)
    : services_(std::move(services)),
      table_(SimulationTable()),
      core_(table_, *this, services_.guard, services_.version),
      inbox_(services_.board, services_.frames, std::move(post)) {}

SimulationModule::~SimulationModule() {
  inbox_.Close();
}

void SimulationModule::OnOpen(Connection& connection) {
  Peer& peer = peers_[connection.id()];
  peer.connection = &connection;
  peer.client.client = {connection.id(), {}, connection.peer(), connection.input_ended()};
  peer.client.trusted = connection.trusted();
  peer.client.push = [&connection](const Message& message) { connection.Push(message); };
  services_.roster.Add({connection.id(), "/simulation", connection.peer(), {}});
}

void SimulationModule::OnRequest(Connection& connection, Message request, ReplyFunction reply) {
  const StepInbox::Scope scope(inbox_);
  const auto found = peers_.find(connection.id());
  if (found == peers_.end()) return;
  Peer& peer = found->second;
  if (std::optional<Message> refusal = Refuse(request)) {
    reply(std::move(*refusal));
    return;
  }
  peer.command = request.command;
  peer.text.clear();
  peer.reply = std::move(reply);
  std::optional<Message> answer = Answer(peer, request);
  if (!answer) return;
  const bool quit = request.command == command::kQuit && answer->error == 0;
  std::exchange(peer.reply, nullptr)(std::move(*answer));
  if (quit) services_.actions.Quit();
}

std::optional<Message> SimulationModule::Refuse(const Message& request) const {
  // With params `first, count`: the robots to list.
  if (request.command == command::kGetStatus && request.error == 0 && request.params.size() == 2 &&
      request.text.empty() && request.data.empty()) {
    if (request.params[0] >= 1 && request.params[1] >= 0) return std::nullopt;
    return ErrorReply(
        request.command, Error::kOutOfRange,
        "get_status lists robots from the first, at least 1, so many, at least 0: params 257 256");
  }
  return core_.Refuse(request);
}

std::optional<Message> SimulationModule::Answer(Peer& peer, const Message& request) {
  const FramePtr frame = inbox_.Current();
  if (frame == nullptr)
    return ErrorReply(request.command, Error::kNotPossible, "the simulation has not begun yet");
  if (std::optional<Message> common =
          core_.AnswerCommon(peer.client, request, *frame, services_.board.mode())) {
    ListenForSteps();
    return common;
  }
  switch (request.command) {
    case command::kGetStatus: {
      Message reply = Read(request, *frame);
      ModuleCore::Stamp(reply, *frame);
      return reply;
    }
    case command::kReady:
      services_.board.WaitSteps(request.params.empty() ? 1 : request.params[0],
                                inbox_.Waiter(*this, peer.client.client.id));
      return std::nullopt;
    case command::kHello:
      if (std::optional<Message> refusal = core_.TakeHello(peer.client, request)) return refusal;
      services_.roster.SetName(peer.client.client.id, peer.client.client.name);
      return Stamped(Ok(request));
    case command::kClaim:
    case command::kRelease:
      return ErrorReply(
          request.command, Error::kNotPossible,
          "/simulation has no owner: claim is for the motors of a robot, release_robot ROBOT frees one");
    default:
      return core_.MayChange(peer.client) ? Change(peer, request) : ModuleCore::NotAllowed(request);
  }
}

std::optional<Message> SimulationModule::Change(Peer& peer, const Message& request) {
  switch (request.command) {
    case command::kRun:
      return Push(peer, edit::Run{});
    case command::kPause:
      return Push(peer, edit::Pause{});
    case command::kStep:
      return Push(peer, edit::Step{request.params[0], inbox_.Waiter(*this, peer.client.client.id)});
    case command::kReset:
      return Reset(peer, request);
    case command::kSetMode:
      return Push(peer, edit::SetMode{static_cast<Mode>(request.params[0])});
    case command::kSetStep:
      return SetStep(peer, request);
    case command::kSetSpeed:
      return Push(peer, edit::SetSpeed{request.data[0]});
    case command::kLoadScenario:
    case command::kReload:
      return Load(peer, request);
    case command::kQuit:
      return Stamped(Ok(request));
    case command::kStopAll:
      peer.text = GoOnText();
      return Push(peer, edit::StopAll{});
    case command::kSetParticipants:
      return Push(peer, edit::SetParticipants{Words(request.text)});
    case command::kReleaseRobot:
      return ReleaseRobot(peer, request);
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /simulation");
  }
}

std::optional<Message> SimulationModule::SetStep(Peer& peer, const Message& request) {
  const double step_s = request.data[0];
  const double microseconds = std::round(step_s * 1e6);
  const bool in_range = step_s >= ToSeconds(kMinStep) && step_s <= ToSeconds(kMaxStep);
  if (!in_range) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      fmt::format("a step lasts 0.0005 to 0.1 s, not {:.6g}: set_step 0.01", step_s));
  }
  if (std::abs(step_s * 1e6 - microseconds) > 1e-3) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      fmt::format("a step lasts whole microseconds: set_step {:.6f}", microseconds * 1e-6));
  }
  return Push(peer, edit::SetStep{static_cast<Nanoseconds>(microseconds) * 1000});
}

std::optional<Message> SimulationModule::Reset(Peer& peer, const Message& request) {
  edit::Reset reset;
  if (!request.params.empty()) {
    if (request.params[0] < 0) {
      return ErrorReply(request.command, Error::kOutOfRange, "a seed is at least 0: reset 7");
    }
    reset.seed = static_cast<std::uint64_t>(request.params[0]);
  }
  return Push(peer, reset);
}

std::optional<Message> SimulationModule::Load(Peer& peer, const Message& request) {
  ScenarioRead read =
      request.command == command::kReload
          ? ReadScenarioAgain(*services_.frames.Latest()->scene->scenario, services_.robots, services_.seed)
          : ReadRequestedScenario(request.text, services_.robots, services_.seed);
  if (read.scenario == nullptr) return ErrorReply(request.command, read.error, std::move(read.text));
  peer.text = std::move(read.text);
  return Push(peer, edit::Load{std::move(read.scenario)});
}

std::string SimulationModule::GoOnText() const {
  const std::vector<CommandBoard::Owner> owners = services_.board.Owners();
  const auto driven = std::count_if(owners.begin(), owners.end(),
                                    [](const CommandBoard::Owner& owner) { return owner.driven; });
  if (driven == 0) return {};
  return fmt::format("robots that loaded controllers drive go on ({}): pause, or release_robot ROBOT",
                     driven);
}

std::optional<Message> SimulationModule::ReleaseRobot(Peer& peer, const Message& request) {
  std::string robot = request.text;
  if (robot.starts_with('/')) robot.erase(0, 1);
  const std::vector<CommandBoard::Owner> owners = services_.board.Owners();
  for (const CommandBoard::Owner& owner : owners) {
    if (owner.robot != robot) continue;
    if (owner.driven) return Push(peer, edit::UnloadController{robot});
    if (owner.is_team) {
      // The team goes on without it, and is told with its next step.
      const SlotId slot = services_.board.FindSlot(robot);
      services_.board.InputEnded(slot, owner.id);
      services_.board.Closed(slot, owner.id);
    } else if (owner.id != 0) {
      const Client& by = peer.client.client;
      // Free at once; what the policy for a lost client says acts when the connection has closed.
      services_.board.InputEnded(services_.board.FindSlot(robot), owner.id);
      services_.actions.CloseClient(robot, owner.id, "released by " + (by.name.empty() ? by.peer : by.name));
    }
    Message reply = Ok(request);
    if (owner.id == 0) reply.text = "nobody owned " + robot;
    return Stamped(std::move(reply));
  }
  std::string known;
  for (std::size_t i = 0; i < owners.size() && i < kMaxAwaited; ++i) known += " " + owners[i].robot;
  return ErrorReply(
      request.command, Error::kNoSuchName,
      "there is no robot " + robot + (known.empty() ? ": there are none" : ": there are" + known));
}

std::optional<Message> SimulationModule::Push(Peer& peer, EditAction action) {
  const bool new_scene =
      std::holds_alternative<edit::Load>(action) || std::holds_alternative<edit::Reset>(action);
  services_.edits.Push({std::move(action), [this, poster = inbox_.MakePoster(), id = peer.client.client.id,
                                            new_scene](const EditResult& result) {
                          poster([this, id, result, new_scene] { OnEditDone(id, result, new_scene); });
                        }});
  return std::nullopt;
}

void SimulationModule::OnEditDone(ClientId client, const EditResult& result, bool new_scene) {
  const FramePtr newest = inbox_.Current();  // makes the pushes up to now, before the reply
  const FramePtr& frame = result.frame != nullptr ? result.frame : newest;
  if (new_scene && result.error == Error::kOk) services_.actions.ApplyScene(*frame->scene);
  const auto found = peers_.find(client);
  if (found == peers_.end() || !found->second.reply) return;
  Peer& peer = found->second;
  const ReplyFunction reply = std::exchange(peer.reply, nullptr);
  if (result.error != Error::kOk) {
    reply(ErrorReply(peer.command, result.error, result.text));
    return;
  }
  Message answer;
  answer.command = peer.command;
  answer.text = result.text.empty() ? peer.text : result.text;
  ModuleCore::Stamp(answer, *frame);
  reply(std::move(answer));
}

void SimulationModule::OnStepEnd(ClientId client, const StepResult& result) {
  const auto found = peers_.find(client);
  if (found == peers_.end() || !found->second.reply) return;
  Peer& peer = found->second;
  const ReplyFunction reply = std::exchange(peer.reply, nullptr);
  if (result.end != StepEnd::kRan) {
    reply(WaitEnded(peer.command, result.end, {}));
  } else if (peer.command == command::kReady) {
    reply(core_.StepReply(peer.client, peer.command, {}, *result.frame, result.mode));
  } else {
    Message answer;
    answer.command = peer.command;
    ModuleCore::Stamp(answer, *result.frame);
    reply(std::move(answer));
  }
}

Message SimulationModule::Stamped(Message reply) {
  ModuleCore::Stamp(reply, *inbox_.Current());
  return reply;
}

void SimulationModule::OnFrame(const FramePtr& frame, int dropped) {
  for (auto& [id, peer] : peers_) {
    if (!peer.client.subscriptions.empty()) core_.PushDue(peer.client, *frame, dropped);
  }
}

void SimulationModule::ListenForSteps() {
  bool subscribed = false;
  for (const auto& [id, peer] : peers_) subscribed |= !peer.client.subscriptions.empty();
  if (subscribed) {
    inbox_.Subscribe(*this);
  } else {
    inbox_.Unsubscribe(*this);
  }
}

void SimulationModule::OnClosed(Connection& connection) {
  const StepInbox::Scope scope(inbox_);
  peers_.erase(connection.id());
  services_.roster.Remove(connection.id());
  ListenForSteps();
}

std::string SimulationModule::WaitingFor() {
  std::size_t total = 0;
  return DescribeWaiting(services_.board.Awaiting(services_.clock.Now(), 1, &total));
}

}  // namespace coopdyn
