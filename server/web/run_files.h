// SPDX-License-Identifier: MIT
// Recordings for the UI thread, which never waits for the disk.
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
  /// All outlive this object.
  RunFiles(boost::asio::io_context& context, const WebRuns& runs, Logger logger);

  using Done = std::function<void(const WebRunFile&)>;
  /// Passes the list as text to `done`, once, later, on the UI thread, unless Stop() comes first. UI thread.
  void List(Done done);
  /// Likewise passes the file NAME.run or NAME.mat; `done` must remove a temporary file.
  void Open(const std::string& name, Done done);
  using Piece = std::shared_ptr<const std::string>;
  /// Likewise passes the next bytes of `file`, at most `bytes`; none at its end or after an error.
  void Read(std::shared_ptr<const UniqueFd> file, std::size_t bytes, std::function<void(const Piece&)> done);
  /// Drops all further answers. UI thread, or after that thread has stopped.
  void Stop() {
    answers_.Stop();
    pieces_.Stop();
  }

 private:
  const WebRuns& runs_;
  const Logger logger_;
  Answers<WebRunFile> answers_;
  Answers<Piece> pieces_;
  std::optional<IoThread> disk_;  // reads files; started by the first Read()
};

}  // namespace coopdyn
