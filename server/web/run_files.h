// SPDX-License-Identifier: MIT
// Recordings for the UI thread: the answers of whoever keeps them are brought here, or dropped once the UI
// has stopped.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>

#include "server/web/web_server.h"

namespace coopdyn {

class RunFiles {
 public:
  /// All outlive it.
  RunFiles(boost::asio::io_context& context, const WebRuns& runs);
  /// Stop().
  ~RunFiles();
  RunFiles(const RunFiles&) = delete;
  RunFiles& operator=(const RunFiles&) = delete;

  using Done = std::function<void(const WebRunFile&)>;
  /// The list, as text; `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void List(Done done);
  /// Likewise the file NAME.run or NAME.mat; what is temporary is `done`'s to remove.
  void Open(const std::string& name, Done done);
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop();

 private:
  class Mailbox;
  std::uint64_t Wait(Done done);
  void Deliver(std::uint64_t ticket, const WebRunFile& file);

  const WebRuns& runs_;
  std::shared_ptr<Mailbox> mailbox_;
  std::unordered_map<std::uint64_t, Done> waiting_;
  std::uint64_t last_ticket_ = 0;
};

}  // namespace coopdyn
