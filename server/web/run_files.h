// SPDX-License-Identifier: MIT
// Recordings for the UI thread, which waits for no disk.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/log.h"
#include "server/net/io_thread.h"
#include "server/net/unique_fd.h"
#include "server/web/answers.h"
#include "server/web/web_options.h"

namespace coopdyn {

class RunFiles {
 public:
  /// All outlive it.
  RunFiles(boost::asio::io_context& context, const WebRuns& runs, Logger logger);

  using Done = std::function<void(const WebRunFile&)>;
  /// The list, as text; `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void List(Done done);
  /// Likewise the file NAME.run or NAME.mat; what is temporary is `done`'s to remove.
  void Open(const std::string& name, Done done);
  using Piece = std::shared_ptr<const std::string>;
  /// Likewise the next bytes of `file`, at most `bytes`; none at its end or after an error.
  void Read(std::shared_ptr<const UniqueFd> file, std::size_t bytes, std::function<void(const Piece&)> done);
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop() {
    answers_.Stop();
    pieces_.Stop();
  }

 private:
  const WebRuns& runs_;
  const Logger logger_;
  Answers<WebRunFile> answers_;
  Answers<Piece> pieces_;
  std::optional<IoThread> disk_;  // reads; started with the first
};

}  // namespace coopdyn
