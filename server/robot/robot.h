// SPDX-License-Identifier: MIT
// A robot: its modules on their ports, and their names. Lives over a reset, and over a load that keeps its
// name and type.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/net/io_thread.h"
#include "server/net/module_server.h"
#include "server/robot/robot_core.h"
#include "server/robot/robot_module.h"

namespace coopdyn {

/// Built and used on one thread (control, or main before it runs); what it does for clients happens on `io`.
class Robot {
 public:
  /// Its modules without ports and names yet. `services` and `io` outlive it.
  Robot(const RobotEntry& entry, const RobotServices& services, IoThread& io);
  /// Takes the names away and closes all connections with the notice of Close(), or "the module is closed".
  ~Robot();
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  const std::string& name() const { return core_.name(); }
  bool Is(const RobotModel& model) const { return core_.Is(model); }
  std::size_t module_count() const { return modules_.size(); }
  /// "/robot1/motors"
  const std::string& module_path(std::size_t module) const { return modules_[module]->path(); }
  /// 0: reached through OPEN only.
  int port(std::size_t module) const { return servers_[module]->port(); }

  /// It has motors and values for clients of YARS.
  bool is_channel(std::size_t module) const { return core_.devices()[module]->drives_all(); }
  /// Where its model says that it is to listen; 0: nowhere in particular.
  int said_port(std::size_t module) const;
  /// Makes a module listen, a channel also by UDP; returns an error text, empty if it listens. At most once
  /// each.
  std::string Listen(std::size_t module, const std::vector<std::string>& addresses, int port);
  /// The same, with the port and the connections that a channel before it has left.
  void Listen(std::size_t module, const std::vector<std::string>& addresses, LoosePort port);
  /// What the channel on `module` leaves to the next one: its client goes on there. To be followed by its
  /// end.
  LoosePort Release(std::size_t module) { return servers_[module]->Release(); }
  /// Lists the modules in the name table; their ports must be settled. False if a name is taken by one of our
  /// own.
  bool Register();
  /// YarpPorts::Open() if `name` is a port of one of its modules.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  bool RunsOn(const IoThread& io) const { return &io == &io_; }
  /// Closes all connections with a notice, in time for it to be written.
  void CloseConnections(const std::string& reason);
  /// Closes that connection with a notice, if it is one of this robot's.
  void CloseClient(ClientId client, const std::string& reason);

 private:
  void OpenYarsPort(std::size_t module, const std::vector<std::string>& addresses);
  void CloseYarpPorts(const std::string& reason);

  const RobotServices& services_;
  IoThread& io_;
  RobotCore core_;
  std::vector<std::unique_ptr<RobotModule>> modules_;
  std::vector<std::unique_ptr<ModuleServer>> servers_;
  std::vector<std::unique_ptr<YarsUdpPort>> yars_ports_;
  std::vector<std::string> registered_;
};

}  // namespace coopdyn
