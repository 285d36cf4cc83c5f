// SPDX-License-Identifier: MIT
// Which module is where: the daemon's own names, and those that other programs register with it. No sockets.
// Any thread.
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

/// Whether an own name is a module's, or another one of it for programs of YARP.
enum class NameKind { kModule, kAlias };

/// One name.
struct NameEntry {
  std::string name;  // "/robot1/motors"
  std::string ip;    // empty: the address at which the name server was asked
  int port = 0;      // 0: reached through OPEN only
  std::string type = "tcp";
  bool external = false;  // registered by another program
  NameKind kind = NameKind::kModule;
  AdoptFunction adopt = {};                            // hands it a connection; empty if external
  std::map<std::string, std::string> properties = {};  // `set` key values, of external names
  std::string registrar = {};  // the address that registered it; empty: this machine, or our own
  Nanoseconds used = 0;        // when it was last registered, changed or asked for
};

/// Whoever has the name `from` is to send to the port `to`, as often as one of them comes back.
struct Subscription {
  std::string from, to;  // "/clock", "/me/clock:i"
  auto operator<=>(const Subscription&) const = default;
};

/// Why no program may have `name`; empty if it is fine.
std::string NameProblem(const std::string& name);

/// Who asks for a change, and when.
struct NameAsker {
  std::string ip;
  Nanoseconds now = 0;
};

/// The daemon's own names can be neither registered, changed nor unregistered by others. Another machine
/// registers its own address alone, and what it has registered only it may change, and this machine. The
/// table forgets a name that nobody has used for a day: its program has probably ended.
class NameTable {
 public:
  static constexpr std::size_t kMaxExternal = 4096;
  static constexpr std::size_t kMaxExternalBytes = 4u << 20;
  static constexpr std::size_t kMaxOfAddress = 1024;  // of another machine
  static constexpr std::size_t kMaxBytesOfAddress = 1u << 20;
  static constexpr std::size_t kMaxProperties = 32;  // per name
  static constexpr std::size_t kMaxKeyBytes = 64, kMaxValueBytes = 1024;
  static constexpr Nanoseconds kForgottenAfter = 24 * 3600 * kNanosecondsPerSecond;

  NameTable();

  /// Ports first … last are given to external names that register without one, if `is_free` says so. The
  /// daemon must not use them. `is_free` is called under the table's lock.
  void SetExternalPorts(int first, int last, std::function<bool(int port)> is_free = {});
  /// True if an external name holds `port`.
  bool IsExternalPort(int port) const;

  // --- the daemon's own
  /// Adds an own name; an external one of that name gives way. Returns false if it is there already.
  bool AddOwn(const std::string& name, int port, AdoptFunction adopt, NameKind kind = NameKind::kModule);
  /// Does nothing for a name that is not ours.
  void RemoveOwn(const std::string& name);

  // --- everybody
  /// The entry of `name` (a missing leading '/' is added).
  std::optional<NameEntry> Find(std::string_view name) const;
  /// All entries whose name starts with `prefix`, by name.
  std::vector<NameEntry> List(std::string_view prefix = "") const;
  /// The name most like `name`, for "did you mean"; empty if none is near.
  std::string Nearest(std::string_view name) const;

  // --- other programs
  /// What came of a request to change the table.
  struct Change {
    std::string refused;  // why not; empty = done
    NameEntry entry = {};
  };
  /// Registers an external name; an empty `name` gets "/tmp/port/N", an empty `ip` the asker's, port 0 a free
  /// one. Refused if the name lives (the same name, ip and port again is fine), is reserved or badly formed,
  /// or if there are too many.
  Change Register(const std::string& name, const std::string& type, const std::string& ip, int port,
                  const NameAsker& asker);
  /// Unregisters an external name; an unknown one is no error.
  Change Unregister(std::string_view name, const NameAsker& asker);
  /// Sets a property of an external name; an unknown name gives an empty entry.
  Change SetProperty(std::string_view name, const std::string& key, const std::string& value,
                     const NameAsker& asker);
  /// False: there are too many. One that is there already is fine.
  bool Subscribe(const Subscription& subscription);
  void Unsubscribe(const Subscription& subscription);
  /// All, or those of one name; in order.
  std::vector<Subscription> Subscriptions(std::string_view name = "") const;
  static constexpr std::size_t kMaxSubscriptions = 1024;
  /// Somebody has asked for `name`: it is not forgotten.
  void Touch(std::string_view name, Nanoseconds now);
  /// Drops the external names that are forgotten at `now`. Cheap if there are none.
  void Forget(Nanoseconds now);

 private:
  const NameEntry* FindLocked(std::string_view name) const REQUIRES(mutex_);
  int FreePortLocked() const REQUIRES(mutex_);
  /// Of an external name, which goes.
  void ForgetPortLocked(const NameEntry& entry) REQUIRES(mutex_);
  /// Why there may be no `bytes` more in `names` more names of `registrar`; empty: there may.
  std::string RoomProblemLocked(const std::string& registrar, std::size_t names, std::size_t bytes) const
      REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::map<std::string, NameEntry, std::less<>> entries_ GUARDED_BY(mutex_);
  std::set<Subscription> subscriptions_ GUARDED_BY(mutex_);
  std::multiset<int> external_ports_ GUARDED_BY(mutex_);  // one for each external name
  Nanoseconds next_forgotten_ GUARDED_BY(mutex_) = 0;     // not before that is one forgotten
  int first_port_ GUARDED_BY(mutex_);
  int last_port_ GUARDED_BY(mutex_);
  std::function<bool(int)> is_free_ GUARDED_BY(mutex_);  // empty: all are
  int next_temporary_ GUARDED_BY(mutex_) = 1;
};

}  // namespace coopdyn
