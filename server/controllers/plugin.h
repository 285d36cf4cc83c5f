// SPDX-License-Identifier: MIT
// A loaded and checked shared object with a controller. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "clients/plugin/controller.h"
#include "server/controllers/shared_layout.h"

namespace coopdyn {

/// Why a shared object cannot be used, as a message to its author.
struct PluginError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Copies a text into a field of `size` bytes and makes it printable, because controllers' texts are shown on
/// terminals.
void CopyText(char* to, std::size_t size, const std::string& text);

class Plugin {
 public:
  /// Loads `path` and writes its description into `result`. Throws PluginError. Any other misbehaviour of the
  /// object, such as a crash in a constructor, hits this process.
  Plugin(const std::string& path, FileResult& result);

  const coopdyn_controller& functions() const { return functions_; }
  std::uint32_t state_size() const { return state_size_; }
  /// Commands channels by set-points.
  bool gives_setpoints() const { return gives_setpoints_; }
  bool supervises() const { return supervises_; }
  /// Exchanges the values of the robot's channel.
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
