// SPDX-License-Identifier: MIT
// Requests of YARS clients that concern the whole world: resets, other experiments, the end. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "protocol/message.h"
#include "server/net/endpoint.h"

namespace coopdyn {

/// A request to the world.
struct YarsOrder {
  enum class Kind {
    kReset,  // return to the start; re-reads an experiment whose file has been edited
    kLoadText,
    kLoadFile,
    kLog,  // log a line
    kQuit,
  };
  Kind kind = Kind::kReset;
  std::optional<std::uint64_t> seed = {};  // for a reset; nullopt: unchanged
  std::string text = {};                   // the experiment's text or name, or the line
};

/// The error for a client while another client, `driver`, drives the robot.
inline std::string YarsDrivenText(const std::string& robot, const std::string& driver) {
  return robot + " is driven by " + driver + ": one client at a time";
}

class YarsWorld {
 public:
  virtual ~YarsWorld() = default;
  /// True if kQuit ends the daemon; else kQuit has no effect.
  virtual bool quits() const { return true; }
  /// Passes the reply of /simulation to `done`, on any thread, once: error 12 if `asker` may not order it.
  virtual void Ask(YarsOrder order, const Connection& asker, std::function<void(const Message&)> done) = 0;
};

}  // namespace coopdyn
