// SPDX-License-Identifier: MIT
// The run's status for everybody who looks: asked of /simulation five times a second while somebody does. UI
// thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "server/naming/name_table.h"

namespace coopdyn {

class ModuleLink;

/// Somebody who looks.
class StatusWatcher {
 public:
  virtual ~StatusWatcher() = default;
  /// `status`: the JSON object of get_status, or `null`.
  virtual void OnStatus(const std::shared_ptr<const std::string>& status) = 0;
};

class StatusFeed {
 public:
  static constexpr std::chrono::milliseconds kPeriod{200};

  /// Both outlive the feed.
  StatusFeed(boost::asio::io_context& context, const NameTable& names);
  ~StatusFeed();
  StatusFeed(const StatusFeed&) = delete;
  StatusFeed& operator=(const StatusFeed&) = delete;

  /// Tells `watcher` the status until it is gone.
  void Watch(std::weak_ptr<StatusWatcher> watcher);
  /// Asks once. `done` gets the reply to get_status, or an error reply; not from within this call.
  void Ask(std::function<void(const Message&)> done);

 private:
  void Poll();
  void Broadcast(const Message& reply);
  void CloseLink();

  boost::asio::io_context& context_;
  const NameTable& names_;
  boost::asio::steady_timer timer_;
  std::vector<std::weak_ptr<StatusWatcher>> watchers_;
  std::shared_ptr<ModuleLink> link_;
  bool polling_ = false;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with the feed
};

}  // namespace coopdyn
