// SPDX-License-Identifier: MIT
#include "server/control/global_module.h"

#include <utility>

namespace coopdyn {

namespace {

/// "Ana" for "Ana, page 127.0.0.1:53120": whoever gives the page a name wants to be called so.
std::string NameOf(const Client& client) {
  const std::string& shown = client.shown();
  return shown.substr(0, shown.rfind(", page "));
}

}  // namespace

GlobalModule::GlobalModule(GlobalServices services, CommandTable table, StepInbox::Post post)
    : PeerModule({services.board, services.roster, services.guard, services.clock, services.version},
                 "/" + table.module(), table_, inbox_),
      edits_(services.edits),
      apply_scene_(std::move(services.apply_scene)),
      tell_(std::move(services.tell)),
      table_(std::move(table)),
      inbox_(services.board, services.frames, std::move(post)) {}

GlobalModule::~GlobalModule() {
  inbox_.Close();
}

std::optional<Message> GlobalModule::ReadLater(Peer& /*peer*/, const Message& request) {
  const FramePtr frame = inbox_.Current();
  Message reply = Read(request, *frame);
  if (reply.error == 0) ModuleCore::Stamp(reply, *frame);
  return reply;
}

std::optional<Message> GlobalModule::Answer(Peer& peer, const Message& request) {
  FramePtr frame;
  if (std::optional<Message> common = AnswerCommon(peer, request, frame)) return common;
  switch (request.command) {
    case command::kReady:
      board().WaitSteps(request.params.empty() ? 1 : request.params[0], Waiter(peer));
      return std::nullopt;
    case command::kHello:
      if (std::optional<Message> refusal = TakeHello(peer, request)) return refusal;
      return Done(request);
    case command::kClaim:
    case command::kRelease:
      return ErrorReply(request.command, Error::kNotPossible,
                        path() +
                            " has no owner: claim is for the motors of a robot, release_robot ROBOT of "
                            "/simulation frees one");
    default:
      break;
  }
  const CommandSpec* spec = table_.Find(request.command);
  if (spec != nullptr && ModuleCore::OnlyReads(*spec)) return ReadLater(peer, request);
  return core().MayChange(peer.client) ? Change(peer, request) : ModuleCore::NotAllowed(request);
}

std::optional<Message> GlobalModule::Push(Peer& peer, EditAction action, AfterEdit after) {
  edits_.Push({std::move(action), Later(peer, std::move(after)), Waiter(peer)});
  return std::nullopt;
}

std::function<void(const EditResult&)> GlobalModule::Later(const Peer& peer, AfterEdit after) {
  return [this, poster = inbox_.MakePoster(), id = peer.id(),
          after = std::move(after)](const EditResult& result) {
    poster([this, id, result, after] { OnEditDone(id, result, after); });
  };
}

std::function<void(const EditResult&)> GlobalModule::LaterAllServe(const Peer& peer,
                                                                   std::function<void()> then) {
  const AfterEdit after = [then = std::move(then)](const EditResult& /*result*/) {
    if (then) then();
  };
  return [this, poster = inbox_.MakePoster(), reply = Later(peer, after)](const EditResult& result) {
    const bool others = result.error == Error::kOk && result.frame != nullptr && apply_scene_ != nullptr;
    if (!others) return reply(result);
    poster([this, result, reply] { apply_scene_(result.frame->scene, [result, reply] { reply(result); }); });
  };
}

void GlobalModule::OnEditDone(ClientId client, const EditResult& result, const AfterEdit& after) {
  const FramePtr newest = inbox_.Current();  // makes the pushes so far, before the reply
  const FramePtr& frame = result.frame != nullptr ? result.frame : newest;
  if (after) after(result);
  Peer* const peer = FindWaiting(client);
  if (peer == nullptr) return;
  if (result.error != Error::kOk) {
    Finish(*peer, ErrorReply(peer->command, result.error, result.text));
    return;
  }
  std::string deed = tell_ ? DeedOf(peer->command, result) : std::string();
  if (!deed.empty()) tell_(*frame, std::move(deed), NameOf(peer->client.client));
  Message answer = ReplyTo(peer->command, result.text.empty() ? peer->text : result.text);
  answer.params = result.params;
  ModuleCore::Stamp(answer, *frame);
  Finish(*peer, std::move(answer));
}

Message GlobalModule::Stepped(Peer& peer, const StepResult& result) {
  if (peer.command == command::kReady) return PeerModule::Stepped(peer, result);
  Message answer = ReplyTo(peer.command);
  ModuleCore::Stamp(answer, *result.frame);
  return answer;
}

}  // namespace coopdyn
