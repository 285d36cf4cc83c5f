// SPDX-License-Identifier: MIT
// One shared object with a controller, loaded and looked over. One thread.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "clients/plugin/controller.h"

namespace coopdyn {

/// Why a shared object cannot be used, in words for whoever wrote it.
struct PluginError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An option that a controller takes.
struct ControllerOption {
  std::string name, help;
  double value = 0, min = 0, max = 0;
};

/// What a controller says about itself.
struct ControllerDescription {
  std::string help;
  std::uint32_t readings = 0;  // of enum coopdyn_reading
  std::uint32_t state_size = 0;
  std::vector<ControllerOption> options;
};

class Plugin {
 public:
  /// Loads `path` and asks for its description. Throws PluginError. Whatever the object does wrong meanwhile
  /// (a crash in a constructor) happens to this process.
  explicit Plugin(const std::string& path);
  ~Plugin();
  Plugin(Plugin&& other) noexcept;
  Plugin& operator=(Plugin&&) = delete;

  const coopdyn_controller& functions() const { return functions_; }
  const ControllerDescription& description() const { return description_; }

 private:
  void* handle_ = nullptr;
  coopdyn_controller functions_{};
  ControllerDescription description_;
};

}  // namespace coopdyn
