// SPDX-License-Identifier: MIT
#include "server/control/world_module.h"

#include <exception>
#include <utility>

#include "protocol/module_tables.h"
#include "server/sensing/pick.h"

namespace coopdyn {

namespace {

ResolvedEdit Resolve(const Message& request, const Frame& frame, RobotLibrary& robots) {
  try {
    switch (request.command) {
      case command::kInsert:
        return ResolveInsert(frame, request.text, robots);
      case command::kRemove:
        return ResolveRemove(frame, request.text, request.params);
      case command::kSetPose:
        return ResolveSetPose(frame, request.text, request.params, request.data);
      case command::kSetThing:
        return ResolveSet(frame, request.text, robots);
      default:
        return ResolveRename(frame, request.text);
    }
  } catch (const std::exception& exception) {  // e.g. out of memory
    return {{}, Error::kInternal, std::string("the text cannot be read: ") + exception.what()};
  }
}

Message PickReply(const Message& request, const Frame& frame) {
  const Scene& scene = *frame.scene;
  const Vector3 from_W(request.data[0], request.data[1], request.data[2]);
  const Vector3 along_W(request.data[3], request.data[4], request.data[5]);
  if (!(along_W.norm() > 0) || !along_W.allFinite() || !from_W.allFinite()) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      "a direction is not 0 0 0: pick 0 0 5 0 0 -1 looks down");
  }
  const Ray ray_W{from_W, along_W.normalized()};
  const Picked picked = Pick(frame, ray_W);
  Message reply = ReplyTo(request.command);
  const Vector3 p_W = ray_W.origin + picked.distance_m * ray_W.direction;
  const bool hit = picked.distance_m < kNoHit;
  std::int32_t id = hit ? 0 : -1;
  if (hit) reply.text = "floor";
  if (picked.object >= 0) {
    const SceneObject& thing = scene.objects[static_cast<std::size_t>(picked.object)];
    id = static_cast<std::int32_t>(thing.id.value);
    reply.text = thing.object.name;
  } else if (picked.robot >= 0) {
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(picked.robot)];
    id = WorldId::kRobots + static_cast<std::int32_t>(robot.id.value);
    reply.text = robot.entry.name;
  }
  reply.params = {id};
  reply.data = {hit ? p_W.x() : kNoHit, hit ? p_W.y() : kNoHit, hit ? p_W.z() : kNoHit, picked.distance_m};
  return reply;
}

}  // namespace

WorldModule::WorldModule(WorldServices services, StepInbox::Post post)
    : GlobalModule(services, WorldTable(), std::move(post)), services_(std::move(services)) {}

Message WorldModule::Read(const Message& request, const Frame& frame) {
  const RunStatus status = services_.run.status();
  switch (request.command) {
    case command::kListWorld:
      return ReplyTo(request.command, WorldJson(frame, status));
    case command::kSaveWorld:
      return ReplyTo(request.command, WorldText(frame, status));
    case command::kPick:
      return PickReply(request, frame);
    default:
      break;
  }
  const Scene& scene = *frame.scene;
  Message reply = ReplyTo(request.command);
  for (const std::size_t count : {scene.objects.size(), scene.robots.size(), scene.targets.size(),
                                  scene.lights.size(), status.undo, status.redo}) {
    reply.data.push_back(static_cast<double>(count));
  }
  return reply;
}

std::optional<Message> WorldModule::Change(Peer& peer, const Message& request) {
  if (services_.run.playback()) return ErrorReply(request.command, Error::kNotPossible, kPlayingText);
  auto done = LaterAllServe(peer, [this] {
    requests_.pop_front();
    Begin();
  });
  // The thread may outlive this module, but not the services.
  requests_.push_back([&robots = services_.robots, &frames = services_.frames, &edits = services_.edits,
                       request, done = std::move(done)] {
    const auto push = [&edits, &done](SceneEdit edit, std::string warnings) {
      edits.Push({std::move(edit), [done, warnings = std::move(warnings)](EditResult result) {
                    if (result.error == Error::kOk) {
                      result.params = IdsOf(result.change);
                      result.text = NamesOf(result.change);
                      if (result.text.empty()) result.text = result.change.label;
                      if (!warnings.empty()) result.text += "\n" + warnings;
                    }
                    done(result);
                  }});
    };
    if (request.command == command::kUndo) return push(edit::Undo{}, "");
    if (request.command == command::kRedo) return push(edit::Redo{}, "");
    ResolvedEdit resolved = Resolve(request, *frames.Latest(), robots);
    if (resolved.error != Error::kOk) return done({resolved.error, std::move(resolved.text)});
    push(edit::Change{std::move(resolved.change)}, std::move(resolved.text));
  });
  if (requests_.size() == 1) Begin();
  return std::nullopt;
}

void WorldModule::Begin() {
  if (!requests_.empty()) services_.run_loader(requests_.front());
}

}  // namespace coopdyn
