// SPDX-License-Identifier: MIT
#include "server/control/global_module.h"

#include <utility>

namespace coopdyn {

GlobalModule::GlobalModule(GlobalServices services, CommandTable table, StepInbox::Post post)
    : services_(std::move(services)),
      table_(std::move(table)),
      path_("/" + table_.module()),
      core_(table_, *this, services_.guard, services_.version),
      inbox_(services_.board, services_.frames, std::move(post)) {}

GlobalModule::~GlobalModule() {
  inbox_.Close();
}

void GlobalModule::OnOpen(Connection& connection) {
  Peer& peer = peers_[connection.id()];
  peer.client.client = {connection.id(), {}, connection.peer(), connection.input_ended()};
  peer.client.trusted = connection.trusted();
  peer.client.push = [&connection](const Message& message) { connection.Push(message); };
  services_.roster.Add({connection.id(), path_, connection.peer(), {}});
}

void GlobalModule::OnRequest(Connection& connection, Message request, ReplyFunction reply) {
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
  const std::optional<Message> answer = Answer(peer, request);
  if (!answer) return;
  std::exchange(peer.reply, nullptr)(*answer);
  OnAnswered(request, *answer);
}

std::optional<Message> GlobalModule::ReadLater(Peer& /*peer*/, const Message& request) {
  const FramePtr frame = inbox_.Current();
  Message reply = Read(request, *frame);
  if (reply.error == 0) ModuleCore::Stamp(reply, *frame);
  return reply;
}

std::optional<Message> GlobalModule::Answer(Peer& peer, const Message& request) {
  const FramePtr frame = inbox_.Current();
  if (frame == nullptr)
    return ErrorReply(request.command, Error::kNotPossible, "the simulation has not begun yet");
  if (std::optional<Message> common =
          core_.AnswerCommon(peer.client, request, *frame, services_.board.mode())) {
    ListenForSteps();
    return common;
  }
  switch (request.command) {
    case command::kReady:
      services_.board.WaitSteps(request.params.empty() ? 1 : request.params[0], Waiter(peer));
      return std::nullopt;
    case command::kHello:
      if (std::optional<Message> refusal = core_.TakeHello(peer.client, request)) return refusal;
      services_.roster.SetName(peer.id(), peer.client.client.name);
      return Done(request);
    case command::kClaim:
    case command::kRelease:
      return ErrorReply(request.command, Error::kNotPossible,
                        path_ +
                            " has no owner: claim is for the motors of a robot, release_robot ROBOT of "
                            "/simulation frees one");
    default:
      break;
  }
  const CommandSpec* spec = table_.Find(request.command);
  if (spec != nullptr && IsReading(*spec)) return ReadLater(peer, request);
  return core_.MayChange(peer.client) ? Change(peer, request) : ModuleCore::NotAllowed(request);
}

std::optional<Message> GlobalModule::Push(Peer& peer, EditAction action, AfterEdit after) {
  services_.edits.Push({std::move(action), Later(peer, std::move(after))});
  return std::nullopt;
}

std::function<void(const EditResult&)> GlobalModule::Later(const Peer& peer, AfterEdit after) {
  return [this, poster = inbox_.MakePoster(), id = peer.id(),
          after = std::move(after)](const EditResult& result) {
    poster([this, id, result, after] { OnEditDone(id, result, after); });
  };
}

void GlobalModule::OnEditDone(ClientId client, const EditResult& result, const AfterEdit& after) {
  const FramePtr newest = inbox_.Current();  // makes the pushes up to now, before the reply
  const FramePtr& frame = result.frame != nullptr ? result.frame : newest;
  if (after) after(result);
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

void GlobalModule::OnStepEnd(ClientId client, const StepResult& result) {
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

Message GlobalModule::Done(const Message& request, std::string text) {
  Message reply;
  reply.command = request.command;
  reply.text = std::move(text);
  ModuleCore::Stamp(reply, *inbox_.Current());
  return reply;
}

void GlobalModule::OnFrame(const FramePtr& frame, int dropped) {
  for (auto& [id, peer] : peers_) {
    if (!peer.client.subscriptions.empty()) core_.PushDue(peer.client, *frame, dropped);
  }
}

void GlobalModule::ListenForSteps() {
  bool subscribed = false;
  for (const auto& [id, peer] : peers_) subscribed |= !peer.client.subscriptions.empty();
  if (subscribed) {
    inbox_.Subscribe(*this);
  } else {
    inbox_.Unsubscribe(*this);
  }
}

void GlobalModule::OnClosed(Connection& connection) {
  const StepInbox::Scope scope(inbox_);
  peers_.erase(connection.id());
  services_.roster.Remove(connection.id());
  ListenForSteps();
}

std::string GlobalModule::WaitingFor() {
  std::size_t total = 0;
  return DescribeWaiting(services_.board.Awaiting(services_.clock.Now(), 1, &total));
}

}  // namespace coopdyn
