// SPDX-License-Identifier: MIT
#include "server/robot/robot_module.h"

#include <array>
#include <utility>

namespace coopdyn {

namespace {

/// The slots that module `index` of `robot` drives.
std::vector<SlotId> SlotsOf(const RobotCore& robot, std::size_t index) {
  const CommandBoard& board = robot.services().board;
  const auto& devices = robot.devices();
  if (!devices[index]->drives_all()) return {board.FindSlot(robot.name(), robot.module_names()[index])};
  std::vector<SlotId> slots;
  for (const ActuatorModel& actuator : robot.model().actuators) {
    if (!actuator.module.empty()) slots.push_back(board.FindSlot(robot.name(), actuator.module));
  }
  if (slots.empty()) slots.push_back(board.FindSlot(robot.name()));
  return slots;
}

}  // namespace

RobotModule::RobotModule(RobotCore& robot, std::size_t index)
    : PeerModule({robot.services().board, robot.services().roster, robot.services().guard,
                  robot.services().clock, robot.services().version},
                 "/" + robot.name() + "/" + robot.module_names()[index], robot.devices()[index]->table(),
                 robot.inbox()),
      robot_(robot),
      device_(*robot.devices()[index]),
      slots_(SlotsOf(robot, index)),
      slot_(slots_.front()),
      index_(index) {}

RobotModule::~RobotModule() {
  StopListening();
}

std::string RobotModule::DriverBeside(const Connection& connection) const {
  Client client;
  client.id = connection.id();
  client.party = connection.party();
  for (const SlotId slot : slots_) {
    if (std::string other = robot_.services().board.ClientBeside(slot, client); !other.empty()) return other;
  }
  return {};
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
  if (device_.is_actuator()) {
    if (std::optional<edit::TuneJoints> tuning = device_.Tune(request)) {
      return Tune(peer, request, *std::move(tuning));
    }
    const FramePtr now = inbox().Current();
    const int index = now == nullptr ? -1 : robot_.IndexIn(*now);
    if (index >= 0) {
      if (std::optional<Actuation> actuation = device_.Actuate(request, *now, index)) {
        return Drive(peer, request, std::move(*actuation));
      }
    }
  }
  if (const std::optional<RobotMessage> message = device_.Broadcast(request)) {
    return Send(peer, request, *message);
  }
  FramePtr frame;
  if (std::optional<Message> common = AnswerCommon(peer, request, frame)) return common;
  const int index = robot_.IndexIn(*frame);
  if (std::optional<ImageRequest> picture =
          index < 0 ? std::nullopt : device_.Picture(request, frame, index)) {
    Draw(peer, *std::move(picture));
    return std::nullopt;
  }
  Message reply = Read(request, *frame);
  if (reply.error == 0) ModuleCore::Stamp(reply, Shown(*frame));
  return reply;
}

std::optional<Message> RobotModule::Drive(Peer& peer, const Message& request, Actuation actuation) {
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  if (!actuation.refusal.empty()) return ErrorReply(request.command, Error::kWrongData, actuation.refusal);
  peer.text = std::move(actuation.limited);
  const Client& client = peer.client.client;
  if (device_.drives_all() && peer.client.attached.empty()) peer.client.attached = {index_};
  if (slots_.size() == 1)
    return Settle(peer, board().Command(slot_, client, actuation.setpoints, actuation.steps, Waiter(peer)));
  return Settle(peer, board().StepAll({.slots = slots_, .setpoints = actuation.setpoints}, client,
                                      actuation.steps.value_or(1), Waiter(peer)));
}

Message RobotModule::Stepped(Peer& peer, const StepResult& result) {
  if (device_.drives_all()) {
    const int index = robot_.IndexIn(*result.frame);
    if (index >= 0) peer.text = StepNote(*result.frame, index);
  }
  return PeerModule::Stepped(peer, result);
}

std::optional<Message> RobotModule::Tune(Peer& peer, const Message& request, edit::TuneJoints tuning) {
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  const Verdict verdict = board().MayTune(slot_, peer.client.client);
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  tuning.robot = robot_.name();
  // The poster does nothing once the robot and its modules are gone.
  const auto done = [this, poster = inbox().MakePoster(), id = peer.id()](const EditResult& result) {
    poster([this, id, result] {
      const FramePtr newest = inbox().Current();
      Peer* const waiting = FindWaiting(id);
      if (waiting == nullptr) return;
      Message reply = result.error == Error::kOk ? ReplyTo(waiting->command)
                                                 : ErrorReply(waiting->command, result.error, result.text);
      if (reply.error == 0) ModuleCore::Stamp(reply, result.frame != nullptr ? *result.frame : *newest);
      Finish(*waiting, std::move(reply));
    });
  };
  robot_.services().edits.Push({RunEdit(std::move(tuning)), done});
  return std::nullopt;
}

void RobotModule::Draw(Peer& peer, ImageRequest picture) {
  // The poster: as in Tune().
  const auto done = [this, poster = inbox().MakePoster(), id = peer.id()](const ImageResult& result) {
    poster([this, id, result] {
      Peer* const waiting = FindWaiting(id);
      if (waiting != nullptr) Finish(*waiting, ImageReply(waiting->command, result));
    });
  };
  robot_.services().images.Request(std::move(picture), done);
}

Message RobotModule::Send(Peer& peer, const Message& request, const RobotMessage& message) {
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  const Verdict verdict = board().Send(slot_, peer.client.client, message);
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  return Done(request);
}

std::optional<Message> RobotModule::Ready(Peer& peer, const Message& request) {
  const int steps = request.params.empty() ? 1 : request.params.front();
  StepDone done = Waiter(peer);
  if (!device_.is_actuator()) {
    board().WaitSteps(steps, std::move(done));
    return std::nullopt;
  }
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  if (slots_.size() > 1)
    return Settle(peer, board().StepAll({.slots = slots_, .setpoints = {}}, peer.client.client, steps,
                                        std::move(done)));
  return Settle(peer, board().Ready(slot_, peer.client.client, steps, std::move(done)));
}

std::optional<Message> RobotModule::Settle(Peer& peer, const Verdict& verdict) {
  if (verdict.error != Error::kOk) return ErrorReply(peer.command, verdict.error, verdict.text);
  if (!verdict.answer_now) return std::nullopt;
  const FramePtr frame = inbox().Current();
  return core().StepReply(peer.client, peer.command, std::move(peer.text), *frame, verdict.mode);
}

Message RobotModule::Hello(Peer& peer, const Message& request) {
  if (std::optional<Message> refusal = TakeHello(peer, request)) return *refusal;
  const Client& client = peer.client.client;
  if (device_.is_actuator()) {
    if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
    for (const SlotId slot : slots_) {
      const Verdict verdict = board().Hello(slot, client);
      if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
      if (verdict.displaced != 0) CloseClient(verdict.displaced, "taken over by " + client.name);
    }
  }
  return Done(request);
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
  if (!core().MayChange(peer.client)) return ModuleCore::NotAllowed(request);
  const Client& client = peer.client.client;
  const bool claims = request.command == command::kClaim;
  const Verdict verdict =
      slots_.size() > 1 ? (claims ? board().ClaimAll(slots_, client) : board().ReleaseAll(slots_, client))
      : claims          ? board().Claim(slot_, client)
                        : board().Release(slot_, client);
  if (verdict.error != Error::kOk) return ErrorReply(request.command, verdict.error, verdict.text);
  return Done(request);
}

std::optional<Message> RobotModule::Refuse(const Message& request) const {
  std::optional<Message> refusal = PeerModule::Refuse(request);
  return refusal ? refusal : device_.Refuse(request);
}

std::string RobotModule::NewOwner() {
  return board().OwnerOf(slot_);
}

Message RobotModule::Read(const Message& request, const Frame& frame) {
  const int index = robot_.IndexIn(frame);
  if (index < 0) {
    return ErrorReply(request.command, Error::kNotPossible, robot_.name() + std::string(kGoneText));
  }
  const Frame& shown = device_.Shown(frame, index);
  Message reply = device_.Read(request, shown, index);
  if (reply.error == 0 && request.command == command::kGetValues) reply.text = StepNote(shown, index);
  return reply;
}

std::string RobotModule::StepNote(const Frame& frame, int robot) const {
  if (device_.drives_all() && robot_.services().board.run_ended()) return kAborted;
  return device_.StepNote(frame, robot);
}

const Frame& RobotModule::Shown(const Frame& frame) {
  const int index = robot_.IndexIn(frame);
  return index < 0 ? frame : device_.Shown(frame, index);
}

void RobotModule::AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) {
  const int index = robot_.IndexIn(frame);
  if (index >= 0) robot_.devices()[attachable]->AppendFirstReading(frame, index, data);
}

void RobotModule::InputEnded(ClientId client) {
  if (!device_.is_actuator()) return;
  for (const SlotId slot : slots_) board().InputEnded(slot, client);
}

void RobotModule::Closed(ClientId client) {
  if (!device_.is_actuator()) return;
  for (const SlotId slot : slots_) board().Closed(slot, client);
}

}  // namespace coopdyn
