// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string_view>

#include "protocol/ascii.h"
#include "server/devices/devices.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

std::string Lower(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = ToLower(c);
  return lower;
}

const Target& TargetOf(const Frame& frame, const Sighting& sighting) {
  return frame.scene->targets[static_cast<std::size_t>(sighting.index)];
}

/// The available targets, for error messages: `red (1), green (2)`.
std::string TargetsOf(const Scene& scene) {
  std::string list;
  for (const Target& target : scene.targets) {
    if (!list.empty()) list += ", ";
    list += fmt::format("{} ({})", target.color_name, target.id.value);
  }
  return list;
}

std::string NoSuchTarget(const std::string& asked, bool exists, const Scene& scene) {
  if (exists) return asked + " is not in sight: get_targets lists what is";
  if (scene.targets.empty()) return "there is no " + asked + ": this scenario has no targets";
  return "there is no " + asked + ": there are " + TargetsOf(scene);
}

}  // namespace

Message TargetDevice::ReadTarget(const Message& request, const Frame& frame, int robot) const {
  const Scene& scene = *frame.scene;
  const std::string color = Lower(request.text);
  const auto is_asked_for = [&](const Target& target) {
    return color.empty() ? static_cast<std::int64_t>(target.id.value) == request.params.front()
                         : target.color_name == color;
  };
  const Sighting* nearest = nullptr;
  const std::vector<Sighting> seen = SeenTargets(frame, robot, number());
  for (const Sighting& sighting : seen) {
    if (!is_asked_for(TargetOf(frame, sighting))) continue;
    if (nearest == nullptr || sighting.distance_m < nearest->distance_m) nearest = &sighting;
  }
  if (nearest == nullptr) {
    const bool exists = std::any_of(scene.targets.begin(), scene.targets.end(), is_asked_for);
    const std::string asked =
        color.empty() ? "target " + std::to_string(request.params.front()) : color + " target";
    return ErrorReply(request.command, Error::kNoSuchName, NoSuchTarget(asked, exists, scene));
  }
  Message reply = ReplyTo(request.command);
  reply.data.reserve(4);
  reply.data = {nearest->distance_m, nearest->bearing_rad};
  return reply;
}

Message TargetDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command == command::kGetTarget) return ReadTarget(request, frame, robot);
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetRobots) {
    for (const Sighting& sighting : SeenRobots(frame, robot, number())) AddRobot(reply, frame, sighting);
    return reply;
  }
  for (const Sighting& sighting : SeenTargets(frame, robot, number())) {
    const Target& target = TargetOf(frame, sighting);
    AddSighting(reply, target.id.value, target.color_name, sighting);
  }
  return reply;
}

}  // namespace coopdyn
