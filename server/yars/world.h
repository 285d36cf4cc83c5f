// SPDX-License-Identifier: MIT
// What clients of YARS ask of the whole world: resets, other experiments, the end. Any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "protocol/message.h"
#include "server/net/endpoint.h"

namespace coopdyn {

/// Such a request.
struct YarsOrder {
  enum class Kind {
    kReset,  // back to the start; an experiment whose file has been edited is read anew
    kLoadText,
    kLoadFile,
    kLog,  // a line for whoever watches
    kQuit,
  };
  Kind kind = Kind::kReset;
  std::optional<std::uint64_t> seed = {};  // of a reset; empty: the same one
  std::string text = {};                   // of the experiment, its name, or the line
};

/// The error for a client while another client, `driver`, drives the robot.
inline std::string YarsDrivenText(const std::string& robot, const std::string& driver) {
  return robot + " is driven by " + driver + ": one client at a time";
}

class YarsWorld {
 public:
  virtual ~YarsWorld() = default;
  /// kQuit ends the daemon; else it is nothing.
  virtual bool quits() const { return true; }
  /// `done` gets the reply of /simulation, on any thread, once: error 12 if `asker` may not order it.
  virtual void Ask(YarsOrder order, const Connection& asker, std::function<void(const Message&)> done) = 0;
};

}  // namespace coopdyn
