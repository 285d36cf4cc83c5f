// SPDX-License-Identifier: MIT
#include "server/control/published_module.h"

#include <utility>

namespace coopdyn {

PublishedModule::PublishedModule(std::string name, Endpoint& endpoint, IoThread& io, NetServices& net,
                                 NameTable& names)
    : name_(std::move(name)),
      io_(io),
      names_(names),
      server_(std::make_unique<ModuleServer>(io, endpoint, net, name_)) {}

PublishedModule::~PublishedModule() {
  if (listed_) names_.RemoveOwn(name_);
  io_.Call([this] {
    server_->CloseAll("the daemon is stopping");
    server_.reset();
  });
}

std::string PublishedModule::Open(const std::vector<std::string>& addresses, int port) {
  if (!addresses.empty()) {
    const std::string error = server_->Listen(addresses, port);
    if (!error.empty()) return name_ + ": " + error;
  }
  listed_ = names_.AddOwn(name_, server_->port(), server_->adopter());
  return listed_ ? "" : "the name " + name_ + " is taken";
}

}  // namespace coopdyn
