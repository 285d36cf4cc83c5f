// SPDX-License-Identifier: MIT
// A run of a student's program: the process of clients/programs/run_program.py, which keeps the program in
// a sandbox and talks to us over a socket of packets (that file describes them). The program ends with the
// process, and the process with us. The io_context's thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "server/net/unique_fd.h"

namespace coopdyn {

/// How a program ended.
struct ProgramOutcome {
  std::string sentence;
  bool error = false;  // the program's fault
  int line = 0;        // of the program, where it went wrong; 0: unknown
};

class ProgramRun {
 public:
  /// Connections that are taken at once; the next ones have to wait a little.
  static constexpr int kConnectionsAtOnce = 32;

  struct Handlers {
    std::function<void(std::string_view text)> print;    // UTF-8
    std::function<void(UniqueFd connection)> connected;  // a stream socket, as a client's to the names' port
    std::function<void(ProgramOutcome end)> ended;       // once, last; the run may be destroyed in it
  };

  ProgramRun(boost::asio::io_context& context, Handlers handlers);
  /// Kills the program; no handler is called any more.
  ~ProgramRun();
  ProgramRun(const ProgramRun&) = delete;
  ProgramRun& operator=(const ProgramRun&) = delete;

  /// Starts `words`, the first of which is the Python interpreter; what goes wrong in the process itself is
  /// appended to `log`. Once. An error text.
  std::string Start(const std::vector<std::string>& words, const std::string& log);
  /// Asks the program to end, which it does at once.
  void Stop();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
