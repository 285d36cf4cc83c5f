// SPDX-License-Identifier: MIT
// Opens connections from our ports to programs of YARP, when they are told to ("[add]"), and takes datagrams.
// Any thread.
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

/// Whoever makes the daemon open a connection.
enum class YarpAsker {
  kTrusted,   // a program on this machine
  kStranger,  // is not connected with what only this machine reaches
};

struct YarpNetworkOptions {
  std::string server;                  // HOST:PORT of the name server; empty: the table has the names
  std::string own_ip;                  // of names in the table without an address
  std::string address;                 // where datagrams come in
  std::optional<YarpDialect> dialect;  // of readers; nothing: each is asked
  bool trusts_this_machine = true;     // its programs need no token
  /// A reader that acknowledges, named so, has taken the sample of a step; it gets one every so many. And: it
  /// has gone. Any thread.
  std::function<void(std::uint64_t id, const std::string& name, std::uint64_t step, int every)> taken = {};
  std::function<void(std::uint64_t id)> gone = {};
};

/// Outlives whoever has an encoding of it. Its thread starts with the first connection.
class YarpNetwork {
 public:
  /// `names` outlives it.
  YarpNetwork(NameTable& names, Logger logger, YarpNetworkOptions options);
  /// Stop().
  ~YarpNetwork();
  YarpNetwork(const YarpNetwork&) = delete;
  YarpNetwork& operator=(const YarpNetwork&) = delete;

  /// Connects `from`, which is in the table, to `target`: "tcp://reader", or "/reader" for tcp. It replaces a
  /// connection between the two. `done` gets what YARP's programs want to read: without error that it was
  /// added; on the network's thread, or at once. `asker`: for whom; see Find() of the implementation.
  void Connect(const std::string& from, const std::string& target, YarpStream stream, YarpAsker asker,
               ReplyFunction done);
  /// Takes datagrams of `sender` for our port `to`. It replaces another such connection of the two. `done`
  /// gets the number of the UDP port in its params, as for Connect().
  void Accept(const std::string& sender, const std::string& to, YarpAsker asker, ReplyFunction done);
  /// Asks the port `name`, which connects to one of ours, for its version of YARP: `done` gets it, 3 or 4, in
  /// its params, as for Connect().
  void AskVersion(const std::string& name, YarpAsker asker, ReplyFunction done);
  /// Tells whoever has the port `from` to connect to `to`, or to do so no longer, as a name server does for
  /// subscriptions.
  void Tell(const std::string& from, const std::string& to, bool connects);
  /// Of all programs, as the user says. Nothing: each is asked.
  std::optional<YarpDialect> dialect() const;
  /// Logs that a streamed command, which gets no answer, was refused.
  void NoteRefused(const std::string& port, const std::string& sender, const std::string& why);
  /// What the world interface has made.
  const std::shared_ptr<YarpMadeThings>& made() const { return made_; }
  /// What has been connected, to be listed and ended.
  YarpLinks& links();
  /// Nothing is connected any more. Those that are there stay, until their modules end. Neither Connect() nor
  /// Accept() may come meanwhile.
  void Stop();

 private:
  struct Impl;
  const std::shared_ptr<Impl> impl_;
  const std::shared_ptr<YarpMadeThings> made_;
};

}  // namespace coopdyn
