// SPDX-License-Identifier: MIT
// Carries the page's calls to module connections and the replies back. Opens one connection per module and
// channel on demand; closes all with the bridge, which frees the page's robots. UI thread.
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
  static constexpr std::size_t kMaxWaiting = 1024;       // pending requests
  /// Called for every reply and push, never from within Handle().
  using SendFunction = std::function<void(const PageReply& reply)>;

  /// If `peer` is not trusted, only reading commands get through to the modules of the whole simulation;
  /// robots' modules decide themselves, as for programs. All references outlive the bridge.
  PageBridge(boost::asio::io_context& context, const NameTable& names, const FrameBoard& frames,
             PeerInfo peer, SendFunction send);
  /// Closes all connections. Does not call `send` afterwards.
  ~PageBridge();
  PageBridge(const PageBridge&) = delete;
  PageBridge& operator=(const PageBridge&) = delete;

  /// Sets whether calls may change things from now on. A change closes all connections.
  void SetTrusted(bool trusted);
  bool trusted() const { return peer_.trusted; }
  /// Names the person at the page; connections opened from now on show it.
  void SetPerson(std::string name) { person_ = std::move(name); }
  const std::string& peer() const { return peer_.text; }

  /// Sends a call to its module. Exactly one reply follows.
  void Handle(const PageCall& call);
  /// Closes a connection and answers its pending requests with error 5.
  void CloseLink(const std::string& module, const std::string& channel);

 private:
  using Key = std::pair<std::string, std::string>;  // module, channel
  struct Link {
    std::shared_ptr<ModuleLink> link;
    bool verbose = false;
  };

  /// The commands of the module called `name` ("/robot1/motors"); null if unknown.
  const CommandTable* TableOf(const std::string& name) const;
  /// The open connection; null if it cannot be opened, with the reason in `refusal`.
  Link* FindOrOpen(const Key& key, Message& refusal);
  void Push(const Key& key, const Message& message);
  /// Answers `call` without a module, later.
  void Answer(const PageCall& call, Message message, std::string note = {});

  boost::asio::io_context& context_;
  const NameTable& names_;
  const FrameBoard& frames_;  // its scene holds the types of the robots' modules
  PeerInfo peer_;
  std::string person_;
  SendFunction send_;
  std::map<Key, Link> links_;
  std::size_t waiting_ = 0;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with the bridge
};

}  // namespace coopdyn
