// SPDX-License-Identifier: MIT
// A module's port with its name, such as /simulation's.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/naming/name_table.h"
#include "server/net/io_thread.h"
#include "server/net/module_server.h"

namespace coopdyn {

/// Built, opened and destroyed on one thread; its connections are served on `io`.
class NamedPort {
 public:
  /// All references must outlive it.
  NamedPort(std::string name, Endpoint& endpoint, IoThread& io, NetServices& net, NameTable& names,
            NameKind kind = NameKind::kModule)
      : name_(std::move(name)),
        kind_(kind),
        io_(io),
        names_(names),
        server_(std::make_unique<ModuleServer>(io, endpoint, net, name_)) {}
  ~NamedPort() { Close("the module is closed"); }
  /// Removes the name and closes all connections with this notice.
  void Close(const std::string& notice) {
    if (server_ == nullptr) return;
    if (listed_) names_.RemoveOwn(name_);
    io_.Call([this, &notice] {
      server_->CloseAll(notice);
      server_.reset();
    });
  }
  NamedPort(const NamedPort&) = delete;
  NamedPort& operator=(const NamedPort&) = delete;

  /// Listens and registers the name. Without `addresses` the module is reachable only through OPEN. Returns
  /// an error text, empty on success.
  std::string Open(const std::vector<std::string>& addresses, int port) {
    if (!addresses.empty()) {
      const std::string error = server_->Listen(addresses, port);
      if (!error.empty()) return name_ + ": " + error;
    }
    listed_ = names_.AddOwn(name_, server_->port(), server_->adopter(), kind_);
    return listed_ ? "" : "the name " + name_ + " is taken";
  }
  /// Number of open connections. Any thread.
  std::size_t session_count() const { return server_ == nullptr ? 0 : server_->session_count(); }
  /// 0: reachable only through OPEN.
  int port() const { return server_->port(); }

 private:
  const std::string name_;
  const NameKind kind_;
  IoThread& io_;
  NameTable& names_;
  std::unique_ptr<ModuleServer> server_;
  bool listed_ = false;
};

}  // namespace coopdyn
