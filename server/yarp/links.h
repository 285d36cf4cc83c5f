// SPDX-License-Identifier: MIT
// The connections that ports of ours have opened, and those by datagrams. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/base/mutex.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

/// A connection of a port of ours.
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
  /// Of connections that come in; beyond it the oldest is ended.
  static constexpr std::size_t kMaxInputs = 256;

  /// `session`: the socket that the module's session has, or is about to get.
  Id Add(YarpLink link, const UniqueFd& session);
  void Forget(Id id);
  bool Has(Id id) const;
  /// Ends the session of that connection, if it is there: it sees the end of its input.
  void End(Id id);
  /// Ends the session of that connection: it sees the end of its input. False: there is none.
  bool End(const std::string& port, const std::string& other, YarpLink::Way way);
  /// Those that the port has opened, the oldest first.
  std::vector<YarpLink> From(const std::string& port) const;

 private:
  struct Entry {
    YarpLink link;
    UniqueFd socket;  // the session's, once more
  };
  mutable Mutex mutex_;
  std::map<Id, Entry> entries_ GUARDED_BY(mutex_);
  Id last_ GUARDED_BY(mutex_) = 0;
};

}  // namespace coopdyn
