// SPDX-License-Identifier: MIT
#include "server/robot/robot_module.h"

#include <array>
#include <utility>

namespace coopdyn {

RobotModule::RobotModule(RobotCore& robot, std::size_t index)
    : robot_(robot),
      device_(*robot.devices()[index]),
      path_("/" + robot.name() + "/" + robot.module_names()[index]),
      core_(device_.table(), *this, robot.services().guard, robot.services().version) {}

RobotModule::~RobotModule() {
  robot_.inbox().Unsubscribe(*this);
}

void RobotModule::OnOpen(Connection& connection) {
  Peer& peer = peers_[connection.id()];
  peer.connection = &connection;
  peer.client.client = {connection.id(), {}, connection.peer(), connection.input_ended()};
  peer.client.trusted = connection.trusted();
  peer.client.push = [&connection](const Message& message) { connection.Push(message); };
  robot_.services().roster.Add({connection.id(), path_, connection.peer(), {}});
}

void RobotModule::OnRequest(Connection& connection, Message request, ReplyFunction reply) {
  const StepInbox::Scope scope(robot_.inbox());
  Peer* const found = FindPeer(connection.id());
  if (found == nullptr) return;
  Peer& peer = *found;
  if (std::optional<Message> refusal = core_.Refuse(request)) {
    reply(std::move(*refusal));
    return;
  }
  peer.client.client.input_ended = connection.input_ended();
  peer.command = request.command;
  peer.reply = std::move(reply);
  std::optional<Message> answer = Answer(peer, request);
  if (answer) std::exchange(peer.reply, nullptr)(std::move(*answer));
}

std::optional<Message> RobotModule::Answer(Peer& peer, const Message& request) {
  switch (request.command) {
    case command::kReady:
      return Ready(peer, request);
    case command::kHello:
      return Hello(peer, request);
    case command::kClaim:
    case command::kRelease:
      return ClaimOrRelease(peer, request);
    default:
      break;
  }
  if (std::optional<Actuation> actuation = device_.Actuate(request)) {
    return Drive(peer, request, std::move(*actuation));
  }
  if (const std::optional<RobotMessage> message = device_.Broadcast(request)) {
    return Send(peer, request, *message);
  }
  const FramePtr frame = robot_.inbox().Current();
  if (frame == nullptr)
    return ErrorReply(request.command, Error::kNotPossible, "the simulation has not begun yet");
  const Mode mode = request.command == command::kGetTime ? board().mode() : Mode::kRealtime;
  if (std::optional<Message> common = core_.AnswerCommon(peer.client, request, *frame, mode)) {
    ListenForSteps();
    return common;
  }
  Message reply = Read(request, *frame);
  if (reply.error == 0) ModuleCore::Stamp(reply, *frame);
  return reply;
}

std::optional<Message> RobotModule::Drive(Peer& peer, const Message& request, Actuation actuation) {
  if (!core_.MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  peer.text = std::move(actuation.limited);
  return Settle(peer, board().Command(robot_.slot(), peer.client.client, actuation.wheel_speed_rad_s,
                                      actuation.steps, robot_.inbox().Waiter(*this, peer.client.client.id)));
}

Message RobotModule::Send(Peer& peer, const Message& request, const RobotMessage& message) {
  if (!core_.MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  const Verdict verdict = board().Send(robot_.slot(), peer.client.client, message);
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  Message reply = ReplyTo(request);
  ModuleCore::Stamp(reply, *robot_.inbox().Current());
  return reply;
}

std::optional<Message> RobotModule::Ready(Peer& peer, const Message& request) {
  const int steps = request.params.empty() ? 1 : request.params.front();
  peer.text.clear();
  StepDone done = robot_.inbox().Waiter(*this, peer.client.client.id);
  if (!device_.is_actuator()) {
    board().WaitSteps(steps, std::move(done));
    return std::nullopt;
  }
  if (!core_.MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  return Settle(peer, board().Ready(robot_.slot(), peer.client.client, steps, std::move(done)));
}

std::optional<Message> RobotModule::Settle(Peer& peer, const Verdict& verdict) {
  if (verdict.error != Error::kOk) return ErrorReply(peer.command, verdict.error, verdict.text);
  if (!verdict.answer_now) return std::nullopt;
  const FramePtr frame = robot_.inbox().Current();
  return core_.StepReply(peer.client, peer.command, std::move(peer.text), *frame, verdict.mode);
}

Message RobotModule::Hello(Peer& peer, const Message& request) {
  if (std::optional<Message> refusal = core_.TakeHello(peer.client, request)) return *refusal;
  const Client& client = peer.client.client;
  robot_.services().roster.SetName(client.id, client.name);
  if (device_.is_actuator()) {
    if (!core_.MayChange(peer.client)) return ModuleCore::NotAllowed(request);
    const Verdict verdict = board().Hello(robot_.slot(), client);
    if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
    if (verdict.displaced != 0) CloseClient(verdict.displaced, "taken over by " + client.name);
  }
  Message reply = ReplyTo(request);
  ModuleCore::Stamp(reply, *robot_.inbox().Current());
  return reply;
}

Message RobotModule::ClaimOrRelease(Peer& peer, const Message& request) {
  if (!device_.is_actuator()) {
    std::string drive = "this robot has none";
    for (std::size_t i = 0; i < robot_.devices().size(); ++i) {
      if (robot_.devices()[i]->is_actuator()) drive = "/" + robot_.name() + "/" + robot_.module_names()[i];
    }
    return ErrorReply(request.command, Error::kNotPossible,
                      "reading is open to all, only actuator modules have an owner: " + drive);
  }
  if (!core_.MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  const Client& client = peer.client.client;
  const Verdict verdict = request.command == command::kClaim ? board().Claim(robot_.slot(), client)
                                                             : board().Release(robot_.slot(), client);
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  Message reply = ReplyTo(request);
  ModuleCore::Stamp(reply, *robot_.inbox().Current());
  return reply;
}

void RobotModule::OnStepEnd(ClientId client, const StepResult& result) {
  Peer* const found = FindPeer(client);
  if (found == nullptr || !found->reply) return;
  Peer& peer = *found;
  const ReplyFunction reply = std::exchange(peer.reply, nullptr);
  if (result.end == StepEnd::kRan) {
    reply(core_.StepReply(peer.client, peer.command, std::move(peer.text), *result.frame, result.mode));
    return;
  }
  std::string owner;
  if (result.end == StepEnd::kReplaced) {
    for (CommandBoard::Owner& entry : board().Owners()) {
      if (entry.robot == robot_.name()) owner = std::move(entry.name);
    }
  }
  reply(WaitEnded(peer.command, result.end, owner));
}

void RobotModule::OnFrame(const FramePtr& frame, int dropped) {
  for (auto& [id, peer] : peers_) {
    if (!peer.client.subscriptions.empty()) core_.PushDue(peer.client, *frame, dropped);
  }
}

Message RobotModule::Read(const Message& request, const Frame& frame) {
  const int index = robot_.IndexIn(frame);
  if (index < 0) {
    return ErrorReply(request.command, Error::kNotPossible,
                      robot_.name() + " is no longer part of the scenario");
  }
  return device_.Read(request, frame, index);
}

void RobotModule::AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) {
  const int index = robot_.IndexIn(frame);
  if (index >= 0) robot_.devices()[attachable]->AppendFirstReading(frame, index, data);
}

RobotModule::Peer* RobotModule::FindPeer(ClientId client) {
  if (recent_ != nullptr && recent_->client.client.id == client) return recent_;
  const auto found = peers_.find(client);
  return found == peers_.end() ? nullptr : recent_ = &found->second;
}

void RobotModule::ListenForSteps() {
  bool subscribed = false;
  for (const auto& [id, peer] : peers_) subscribed |= !peer.client.subscriptions.empty();
  if (subscribed) {
    robot_.inbox().Subscribe(*this);
  } else {
    robot_.inbox().Unsubscribe(*this);
  }
}

void RobotModule::OnInputEnded(Connection& connection) {
  const StepInbox::Scope scope(robot_.inbox());
  const auto found = peers_.find(connection.id());
  if (found == peers_.end()) return;
  found->second.client.client.input_ended = true;
  if (device_.is_actuator()) board().InputEnded(robot_.slot(), connection.id());
}

void RobotModule::OnClosed(Connection& connection) {
  const StepInbox::Scope scope(robot_.inbox());
  recent_ = nullptr;
  peers_.erase(connection.id());
  robot_.services().roster.Remove(connection.id());
  ListenForSteps();
  if (device_.is_actuator()) board().Closed(robot_.slot(), connection.id());
}

std::string RobotModule::WaitingFor() {
  std::size_t total = 0;
  return DescribeWaiting(board().Awaiting(robot_.services().clock.Now(), 1, &total));
}

void RobotModule::CloseClient(ClientId client, const std::string& reason) {
  const auto found = peers_.find(client);
  if (found != peers_.end()) found->second.connection->Close(reason);
}

}  // namespace coopdyn
