// SPDX-License-Identifier: MIT
// Recordings for the UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <functional>
#include <string>

#include "server/web/answers.h"
#include "server/web/web_server.h"

namespace coopdyn {

class RunFiles {
 public:
  /// All outlive it.
  RunFiles(boost::asio::io_context& context, const WebRuns& runs);

  using Done = std::function<void(const WebRunFile&)>;
  /// The list, as text; `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void List(Done done);
  /// Likewise the file NAME.run or NAME.mat; what is temporary is `done`'s to remove.
  void Open(const std::string& name, Done done);
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop() { answers_.Stop(); }

 private:
  const WebRuns& runs_;
  Answers<WebRunFile> answers_;
};

}  // namespace coopdyn
