// SPDX-License-Identifier: MIT
// Opens connections from our ports to YARP programs on request ("[add]"), and receives datagrams.
// Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/log.h"
#include "server/naming/name_table.h"
#include "server/net/endpoint.h"
#include "server/yarp/bottle.h"
#include "server/yarp/links.h"
#include "server/yarp/port_name.h"

namespace coopdyn {

class YarpMadeThings;

/// The program on whose behalf the daemon opens a connection.
enum class YarpAsker {
  kTrusted,   // a program on this machine
  kStranger,  // not connected to addresses that only this machine reaches
};

struct YarpNetworkOptions {
  std::string server;                  // HOST:PORT of the name server; empty: our own table
  std::string own_ip;                  // for names in the table without an address
  std::string address;                 // receives datagrams
  std::optional<YarpDialect> dialect;  // of readers; nullopt: each is asked
  bool trusts_this_machine = true;     // its programs need no token
  /// Reader `name` acknowledged step `step`; it receives every `every`th step. gone: the reader has gone. Any
  /// thread.
  std::function<void(std::uint64_t id, const std::string& name, std::uint64_t step, int every)> taken = {};
  std::function<void(std::uint64_t id)> gone = {};
};

/// Outlives all users of its encoding. Its thread starts with the first connection.
class YarpNetwork {
 public:
  /// `names` outlives it.
  YarpNetwork(NameTable& names, Logger logger, YarpNetworkOptions options);
  /// Calls Stop().
  ~YarpNetwork();
  YarpNetwork(const YarpNetwork&) = delete;
  YarpNetwork& operator=(const YarpNetwork&) = delete;

  /// Connects `from`, a name in the table, to `target`: "tcp://reader", or "/reader" for tcp. Replaces an
  /// existing connection between the two. Passes to `done` the text that YARP's programs expect, without
  /// error on success; on the network's thread, or at once. `asker` limits the targets: see Find() in
  /// network.cc.
  void Connect(const std::string& from, const std::string& target, YarpStream stream, YarpAsker asker,
               ReplyFunction done);
  /// Receives datagrams of `sender` for our port `to`. Replaces an existing such connection. `done` receives
  /// the UDP port in its params, as in Connect().
  void Accept(const std::string& sender, const std::string& to, YarpAsker asker, ReplyFunction done);
  /// Asks the port `name`, which connects to one of ours, for its YARP version: `done` receives 3 or 4 in its
  /// params, as in Connect().
  void AskVersion(const std::string& name, YarpAsker asker, ReplyFunction done);
  /// Tells the port `from` to connect to `to`, or to disconnect, as a name server does for subscriptions.
  void Tell(const std::string& from, const std::string& to, bool connects);
  /// The YARP version of all programs, as set by the user. Nullopt: each is asked.
  std::optional<YarpDialect> dialect() const;
  /// Logs the refusal of a streamed command, which gets no answer.
  void NoteRefused(const std::string& port, const std::string& sender, const std::string& why);
  /// The things made through the world interface.
  const std::shared_ptr<YarpMadeThings>& made() const { return made_; }
  /// Open connections, for lists and ends.
  YarpLinks& links();
  /// Opens no more connections; existing ones stay until their modules end. Connect() and Accept() must not
  /// run at the same time.
  void Stop();

 private:
  struct Impl;
  const std::shared_ptr<Impl> impl_;
  const std::shared_ptr<YarpMadeThings> made_;
};

}  // namespace coopdyn
