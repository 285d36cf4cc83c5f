// SPDX-License-Identifier: MIT
// Outgoing connections of our ports, and connections by datagrams. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/base/mutex.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

/// A connection of one of our ports.
struct YarpLink {
  enum class Way { kOut, kIn };
  std::string port;   // of ours
  std::string other;  // "/reader"
  std::string carrier;
  Way way = Way::kOut;
};

class YarpLinks {
 public:
  using Id = std::uint64_t;
  /// Most incoming connections; beyond it the oldest ends.
  static constexpr std::size_t kMaxInputs = 256;

  /// `session`: the socket that the module's session has or will have.
  Id Add(YarpLink link, const UniqueFd& session);
  void Forget(Id id);
  bool Has(Id id) const;
  /// Ends that connection's session, if it exists, by an end of its input.
  void End(Id id);
  /// Ends that connection's session by an end of its input. Returns false if there is none.
  bool End(const std::string& port, const std::string& other, YarpLink::Way way);
  /// The port's outgoing connections, oldest first.
  std::vector<YarpLink> From(const std::string& port) const;

 private:
  struct Entry {
    YarpLink link;
    UniqueFd socket;  // a duplicate of the session's
  };
  mutable Mutex mutex_;
  std::map<Id, Entry> entries_ GUARDED_BY(mutex_);
  Id last_ GUARDED_BY(mutex_) = 0;
};

}  // namespace coopdyn
