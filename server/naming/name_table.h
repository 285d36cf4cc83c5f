// SPDX-License-Identifier: MIT
// Maps names to addresses: the daemon's own names, and those that other programs register. No sockets.
// Thread-safe.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/net/peer.h"

namespace coopdyn {

/// Whether an own name is a module's, or an alias of it for YARP's programs.
enum class NameKind { kModule, kAlias };

/// One name.
struct NameEntry {
  std::string name;  // "/robot1/motors"
  std::string ip;    // empty: the address at which the name server was asked
  int port = 0;      // 0: reachable only through OPEN
  std::string type = "tcp";
  bool external = false;  // registered by another program
  NameKind kind = NameKind::kModule;
  AdoptFunction adopt = {};                            // passes a connection to it; empty if external
  std::map<std::string, std::string> properties = {};  // `set` key values, of external names
  std::string registrar = {};  // address of the program that registered it; empty: this machine, or our own
  Nanoseconds used = 0;        // time of the last registration, change or query
};

/// The port `from` sends to the port `to`, and reconnects whenever one of them returns.
struct Subscription {
  std::string from, to;  // "/clock", "/me/clock:i"
  auto operator<=>(const Subscription&) const = default;
};

/// Why a program may not register `name`; empty if it may.
std::string NameProblem(const std::string& name);

/// The origin and time of a request.
struct NameAsker {
  std::string ip;
  Nanoseconds now = 0;
};

/// Other programs cannot register, change or unregister the daemon's own names. Another machine may register
/// only its own address; only that machine and this one may change the entry. The table forgets a name that
/// has been unused for a day, because its program has probably ended.
class NameTable {
 public:
  static constexpr std::size_t kMaxExternal = 4096;
  static constexpr std::size_t kMaxExternalBytes = 4u << 20;
  static constexpr std::size_t kMaxOfAddress = 1024;  // per remote machine
  static constexpr std::size_t kMaxBytesOfAddress = 1u << 20;
  static constexpr std::size_t kMaxProperties = 32;  // per name
  static constexpr std::size_t kMaxKeyBytes = 64, kMaxValueBytes = 1024;
  static constexpr Nanoseconds kForgottenAfter = 24 * 3600 * kNanosecondsPerSecond;

  NameTable();

  /// External names registered without a port get one in [first, last] for which `is_free` is true. The
  /// daemon must not use these ports itself. `is_free` is called under the table's lock.
  void SetExternalPorts(int first, int last, std::function<bool(int port)> is_free = {});
  /// True if an external name holds `port`.
  bool IsExternalPort(int port) const;

  // --- the daemon's own names
  /// Adds an own name, replacing an external one. Returns false if the daemon already has that name.
  bool AddOwn(const std::string& name, int port, AdoptFunction adopt, NameKind kind = NameKind::kModule);
  /// Does nothing unless `name` is an own name.
  void RemoveOwn(const std::string& name);

  // --- look-up
  /// The entry of `name` (a missing leading '/' is added).
  std::optional<NameEntry> Find(std::string_view name) const;
  /// All entries whose name starts with `prefix`, by name.
  std::vector<NameEntry> List(std::string_view prefix = "") const;
  /// The most similar name to `name`, for "did you mean"; empty if none is close.
  std::string Nearest(std::string_view name) const;

  // --- other programs
  /// The result of a request to change the table.
  struct Change {
    std::string refused;  // the reason for a refusal; empty: done
    NameEntry entry = {};
  };
  /// Registers an external name; an empty `name` becomes "/tmp/port/N", an empty `ip` the asker's, port 0 a
  /// free one. Refused if the name is in use elsewhere (repeating the same name, ip and port is fine), is
  /// reserved or malformed, or if there are too many.
  Change Register(const std::string& name, const std::string& type, const std::string& ip, int port,
                  const NameAsker& asker);
  /// Unregisters an external name; an unknown name is no error.
  Change Unregister(std::string_view name, const NameAsker& asker);
  /// Sets a property of an external name; an unknown name gives an empty entry.
  Change SetProperty(std::string_view name, const std::string& key, const std::string& value,
                     const NameAsker& asker);
  /// Returns false if there are too many. Repeating a subscription is fine.
  bool Subscribe(const Subscription& subscription);
  void Unsubscribe(const Subscription& subscription);
  /// All subscriptions, or those of one name; sorted.
  std::vector<Subscription> Subscriptions(std::string_view name = "") const;
  static constexpr std::size_t kMaxSubscriptions = 1024;
  /// Notes a query for `name`, so it is not forgotten.
  void Touch(std::string_view name, Nanoseconds now);
  /// Removes the external names that have expired at `now`. Cheap if there are none.
  void Forget(Nanoseconds now);

 private:
  const NameEntry* FindLocked(std::string_view name) const REQUIRES(mutex_);
  int FreePortLocked() const REQUIRES(mutex_);
  /// Releases the port of an external name that is removed.
  void ForgetPortLocked(const NameEntry& entry) REQUIRES(mutex_);
  /// Why `registrar` may not have another `names` names with `bytes` bytes; empty if it may.
  std::string RoomProblemLocked(const std::string& registrar, std::size_t names, std::size_t bytes) const
      REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::map<std::string, NameEntry, std::less<>> entries_ GUARDED_BY(mutex_);
  std::set<Subscription> subscriptions_ GUARDED_BY(mutex_);
  std::multiset<int> external_ports_ GUARDED_BY(mutex_);  // one for each external name
  Nanoseconds next_forgotten_ GUARDED_BY(mutex_) = 0;     // no name expires before this time
  int first_port_ GUARDED_BY(mutex_);
  int last_port_ GUARDED_BY(mutex_);
  std::function<bool(int)> is_free_ GUARDED_BY(mutex_);  // empty: all are free
  int next_temporary_ GUARDED_BY(mutex_) = 1;
};

}  // namespace coopdyn
