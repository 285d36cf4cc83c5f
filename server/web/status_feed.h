// SPDX-License-Identifier: MIT
// The run's status for all watchers: polls /simulation five times a second while there are any. UI thread.
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

/// Receives the status.
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

  /// Sends the status to `watcher` until `watcher` expires.
  void Watch(std::weak_ptr<StatusWatcher> watcher);
  /// Asks once and later, never from within this call, calls `done` with the reply to get_status or an error.
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
