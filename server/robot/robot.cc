// SPDX-License-Identifier: MIT
#include "server/robot/robot.h"

#include <utility>

namespace coopdyn {

RobotCore::RobotCore(const RobotEntry& entry, const RobotServices& services, StepInbox::Post post,
                     const StepInbox::Post& hand_over)
    : name_(entry.name),
      model_(entry.model),
      services_(services),
      inbox_(services.board, services.frames, std::move(post), hand_over) {
  for (const ModuleModel& module : entry.model->modules()) {
    devices_.push_back(MakeDevice(*entry.model, module.name));
    module_names_.push_back(module.name);
  }
}

int RobotCore::IndexIn(const Frame& frame) {
  if (frame.scene != scene_) {
    scene_ = frame.scene;
    index_ = scene_->FindRobot(name_);
    if (index_ >= 0 && !Is(*scene_->robots[static_cast<std::size_t>(index_)].entry.model)) index_ = -1;
  }
  return index_;
}

Robot::Robot(const RobotEntry& entry, const RobotServices& services, IoThread& io)
    : services_(services), io_(io), core_(entry, services, io.poster(), io.hand_over()) {
  for (std::size_t i = 0; i < core_.devices().size(); ++i) {
    modules_.push_back(std::make_unique<RobotModule>(core_, i));
    servers_.push_back(
        std::make_unique<ModuleServer>(io, *modules_.back(), services.net, modules_.back()->path()));
  }
}

Robot::~Robot() {
  CloseYarpPorts("the module is closed");
  for (const std::string& name : registered_) services_.names.RemoveOwn(name);
  // After this, nothing of this robot may run on its thread.
  io_.Call([this] {
    yars_ports_.clear();
    servers_.clear();
    modules_.clear();
    core_.inbox().Close();
  });
}

int Robot::requested_port(std::size_t module) const {
  if (!is_channel(module)) return 0;
  const auto* const channel = core_.model().Find<ChannelModel>();
  return channel == nullptr ? 0 : channel->port;
}

std::string Robot::Listen(std::size_t module, const std::vector<std::string>& addresses, int port) {
  std::string error = servers_[module]->Listen(addresses, port);
  if (error.empty()) OpenYarsPort(module, addresses);
  return error;
}

void Robot::Listen(std::size_t module, const std::vector<std::string>& addresses, LoosePort port) {
  servers_[module]->Listen(std::move(port));
  OpenYarsPort(module, addresses);
}

void Robot::OpenYarsPort(std::size_t module, const std::vector<std::string>& addresses) {
  if (!is_channel(module) || services_.yars == nullptr) return;
  std::string lack;
  auto udp = YarsUdpPort::Open(name(), *modules_[module], io_, services_.net, *services_.yars, addresses,
                               servers_[module]->port(), lack);
  if (udp != nullptr) {
    yars_ports_.push_back(std::move(udp));
  } else {
    services_.net.logger()->warn("{} has no UDP port for clients of YARS: {}", module_path(module), lack);
  }
}

bool Robot::Register() {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    if (!services_.names.AddOwn(modules_[i]->path(), servers_[i]->port(), servers_[i]->adopter()))
      return false;
    registered_.push_back(modules_[i]->path());
  }
  return true;
}

void Robot::OpenYarpPort(const std::string& name, const std::string& asker) {
  if (services_.yarp == nullptr) return;
  for (const auto& module : modules_) services_.yarp->Open(name, *module, io_, asker);
}

void Robot::CloseYarpPorts(const std::string& reason) {
  if (services_.yarp == nullptr) return;
  for (const auto& module : modules_) services_.yarp->CloseOf(*module, reason);
}

void Robot::CloseConnections(const std::string& reason) {
  CloseYarpPorts(reason);
  io_.Call([&] {
    for (const auto& server : servers_) server->CloseAll(reason);
  });
}

void Robot::CloseClient(ClientId client, const std::string& reason) {
  io_.Call([&] {
    for (const auto& module : modules_) module->CloseClient(client, reason);
  });
}

}  // namespace coopdyn
