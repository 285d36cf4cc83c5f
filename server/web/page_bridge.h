// SPDX-License-Identifier: MIT
// From the page's calls to module connections and back: one connection per module and channel, opened when
// first needed and closed with the bridge, so that the page's robots are freed. UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "server/naming/name_table.h"
#include "server/state/frame_board.h"
#include "server/web/page_message.h"

namespace coopdyn {

class CommandTable;
class ModuleLink;

class PageBridge {
 public:
  static constexpr std::size_t kMaxLinks = 512;
  static constexpr std::size_t kMaxStrangersLinks = 32;  // without the right to change things
  static constexpr std::size_t kMaxWaiting = 1024;       // requests not yet answered
  /// Called for every reply and push, never from within Handle().
  using SendFunction = std::function<void(const PageReply& reply)>;

  /// `trusted`: may change things; else only what reads gets through. All references outlive the bridge.
  PageBridge(boost::asio::io_context& context, const NameTable& names, const FrameBoard& frames,
             PeerInfo peer, SendFunction send);
  /// Closes all connections; nothing is sent any more.
  ~PageBridge();
  PageBridge(const PageBridge&) = delete;
  PageBridge& operator=(const PageBridge&) = delete;

  /// Whether calls may change things from now on: connections made without that right are closed.
  void SetTrusted(bool trusted);
  bool trusted() const { return peer_.trusted; }
  const std::string& peer() const { return peer_.text; }

  /// Sends a call to its module; exactly one reply follows.
  void Handle(const PageCall& call);
  /// Closes a connection; what waits on it is answered with error 5.
  void CloseLink(const std::string& module, const std::string& channel);

 private:
  using Key = std::pair<std::string, std::string>;  // module, channel
  struct Link {
    std::shared_ptr<ModuleLink> link;
    bool verbose = false;
  };

  /// The commands of the module called `name` ("/robot1/motors"); null if unknown.
  const CommandTable* TableOf(const std::string& name) const;
  /// The open connection, or the reply that says why there is none.
  Link* FindOrOpen(const Key& key, Message& refusal);
  void Push(const Key& key, const Message& message);
  /// Answers `call` without a module, later.
  void Answer(const PageCall& call, Message message, std::string note = {});

  boost::asio::io_context& context_;
  const NameTable& names_;
  const FrameBoard& frames_;  // the types of robots' modules are in its scene
  PeerInfo peer_;
  SendFunction send_;
  std::map<Key, Link> links_;
  std::size_t waiting_ = 0;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with the bridge
};

}  // namespace coopdyn
