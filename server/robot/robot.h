// SPDX-License-Identifier: MIT
// A robot: its modules on their ports, and their names. Survives a reset, and a load that keeps its name and
// type.
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

/// Built and used on one thread (control, or main before control runs); serves its clients on `io`.
class Robot {
 public:
  /// Makes its modules, without ports and names. `services` and `io` outlive it.
  Robot(const RobotEntry& entry, const RobotServices& services, IoThread& io);
  /// Removes the names and closes all connections with the notice of CloseConnections(), or "the module is
  /// closed".
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

  /// True if the module has motors and values for clients of YARS.
  bool is_channel(std::size_t module) const { return core_.devices()[module]->drives_all(); }
  /// The port that the robot's model asks for; 0: none.
  int requested_port(std::size_t module) const;
  /// Makes a module listen, a channel also by UDP. Returns an error text, or empty on success. At most once
  /// per module.
  std::string Listen(std::size_t module, const std::vector<std::string>& addresses, int port);
  /// The same with the port and connections of the channel's predecessor.
  void Listen(std::size_t module, const std::vector<std::string>& addresses, LoosePort port);
  /// Releases the port and connections of the channel on `module` for its successor, where its client
  /// continues. Destroy the robot next.
  LoosePort Release(std::size_t module) { return servers_[module]->Release(); }
  /// Lists the modules in the name table, after their ports are assigned. Returns false if the daemon already
  /// has one of the names.
  bool Register();
  /// YarpPorts::Open() if `name` is a port of one of its modules.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  bool RunsOn(const IoThread& io) const { return &io == &io_; }
  /// Closes all connections with a notice, early enough for it to be written.
  void CloseConnections(const std::string& reason);
  /// Closes the client's connection with a notice, if it is one of this robot's.
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
