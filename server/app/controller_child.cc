// SPDX-License-Identifier: MIT
#include "server/app/controller_child.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "server/controllers/controller_child.h"

namespace coopdyn {

void AddControllerChild(CLI::App& app, std::function<int()>& chosen) {
  auto fd = std::make_shared<int>(-1);
  // Without a group it does not stand in --help.
  CLI::App* child =
      app.add_subcommand("controller-child", "Started by serve: runs loaded controllers")->group("");
  child->add_option("fd", *fd)->required();
  child->callback([&chosen, fd] { chosen = [fd] { return RunControllerChild(*fd); }; });
}

}  // namespace coopdyn
