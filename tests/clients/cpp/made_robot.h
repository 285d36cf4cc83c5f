// SPDX-License-Identifier: MIT
// A robot made by a script of tests/clients/python, found by daemons that start during its lifetime.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "tests/source_dir.h"

namespace coopdyn::client {

class MadeRobot {
 public:
  /// `name`.py makes robots/`name` and `name`.scenario.
  explicit MadeRobot(const std::string& name) {
    std::string folder = (std::filesystem::temp_directory_path() / ("coopdyn_" + name + "_XXXXXX")).string();
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no folder");
    folder_ = folder;
    scenario_ = (folder_ / (name + ".scenario")).string();
    const std::string command =
        "python3 " + SourceDir() + "/tests/clients/python/" + name + ".py " + folder + " > /dev/null";
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
    setenv("COOPDYN_PATH", folder_.c_str(), 1);
  }
  ~MadeRobot() {
    unsetenv("COOPDYN_PATH");
    std::filesystem::remove_all(folder_);
  }
  MadeRobot(const MadeRobot&) = delete;
  MadeRobot& operator=(const MadeRobot&) = delete;

  const std::string& scenario() const { return scenario_; }

 private:
  std::filesystem::path folder_;
  std::string scenario_;
};

}  // namespace coopdyn::client
