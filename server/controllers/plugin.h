// SPDX-License-Identifier: MIT
// One shared object with a controller, loaded and checked. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "clients/plugin/controller.h"
#include "server/controllers/shared_layout.h"

namespace coopdyn {

/// Why a shared object cannot be used, in words for its author.
struct PluginError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Copies a text into a field of this size, printable: what a controller says is shown on terminals.
void CopyText(char* to, std::size_t size, const std::string& text);

class Plugin {
 public:
  /// Loads `path` and writes its description into `result`. Throws PluginError. If the object does anything
  /// else wrong (a crash in a constructor), it happens to this process.
  Plugin(const std::string& path, FileResult& result);

  const coopdyn_controller& functions() const { return functions_; }
  std::uint32_t state_size() const { return state_size_; }
  /// It commands channels by set-points.
  bool gives_setpoints() const { return gives_setpoints_; }
  bool supervises() const { return supervises_; }
  /// It exchanges the values of the robot's channel.
  bool maps() const { return maps_; }

 private:
  struct Close {
    void operator()(void* handle) const;
  };
  std::unique_ptr<void, Close> handle_;
  coopdyn_controller functions_{};
  std::uint32_t state_size_ = 0;
  bool gives_setpoints_ = false, supervises_ = false, maps_ = false;
};

}  // namespace coopdyn
