// SPDX-License-Identifier: MIT
// The connections of all modules, for get_status. Thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/mutex.h"

namespace coopdyn {

class ConnectionRoster {
 public:
  struct Entry {
    ClientId id = 0;
    std::string module;  // "/robot1/motors"
    std::string peer;    // "127.0.0.1:53120"
    std::string name;    // from `hello`; empty: none
  };

  void Add(Entry entry) EXCLUDES(mutex_);
  void SetName(ClientId id, const std::string& name) EXCLUDES(mutex_);
  void Remove(ClientId id) EXCLUDES(mutex_);
  /// Up to `max` entries by increasing id; `total` receives the number of all.
  std::vector<Entry> List(std::size_t max, std::size_t& total) const EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  std::map<ClientId, Entry> entries_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
