// SPDX-License-Identifier: MIT
// An additional YARP port of a module, such as /robot1/pose/state:o.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/naming/named_port.h"
#include "server/net/endpoint.h"
#include "server/yarp/port_name.h"

namespace coopdyn {

/// A module under another name, from which the encoding derives the port's function. All calls go to the
/// module.
class ModuleAlias final : public Endpoint {
 public:
  /// `module` outlives it.
  ModuleAlias(std::string path, Endpoint& module) : path_(std::move(path)), module_(module) {}
  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return module_.table(); }
  void OnOpen(Connection& connection) override { module_.OnOpen(connection); }
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override {
    module_.OnRequest(connection, std::move(request), std::move(reply));
  }
  void OnTakesMore(Connection& connection) override { module_.OnTakesMore(connection); }
  void OnInputEnded(Connection& connection) override { module_.OnInputEnded(connection); }
  void OnClosed(Connection& connection) override { module_.OnClosed(connection); }
  std::string WaitingFor() override { return module_.WaitingFor(); }

 private:
  const std::string path_;
  Endpoint& module_;
};

/// Opened and destroyed on one thread, before the module; its connections are served on the module's thread.
class YarpPort {
 public:
  /// Listens on any free port of `addresses` and lists `name`, a port of the module. Null if the name exists
  /// or no port is free.
  static std::unique_ptr<YarpPort> Open(const std::string& name, Endpoint& module,
                                        const std::vector<std::string>& addresses, IoThread& io,
                                        NetServices& net, NameTable& names) {
    std::unique_ptr<YarpPort> port(new YarpPort(name, module, io, net, names));
    const std::string error = port->port_.Open(addresses, 0);
    if (error.empty()) return port;
    net.LogExhausted(error);
    return nullptr;
  }
  /// Any thread.
  std::size_t session_count() const { return port_.session_count(); }
  /// Closes its connections with this notice.
  void Close(const std::string& notice) { port_.Close(notice); }

 private:
  YarpPort(const std::string& name, Endpoint& module, IoThread& io, NetServices& net, NameTable& names)
      : alias_(name, module), port_(name, alias_, io, net, names, NameKind::kAlias) {}

  ModuleAlias alias_;
  NamedPort port_;
};

}  // namespace coopdyn
