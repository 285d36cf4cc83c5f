// SPDX-License-Identifier: MIT
// The real daemon as a child process, for the benchmarks. One thread.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace coopdyn {

class DaemonProcess {
 public:
  /// Starts `coopdyn serve` on free ports with this scenario text; returns when it is ready. Exits on
  /// failure.
  DaemonProcess(const std::string& scenario_text, const std::vector<std::string>& options);
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  int name_port() const { return name_port_; }
  /// A connection to a module, in the binary encoding.
  int Open(const std::string& module) const;

 private:
  std::string file_;
  pid_t pid_ = 0;
  int name_port_ = 0;
};

/// A TCP connection to a port of this machine, without delay. Exits on failure.
int ConnectTo(int port);
void SendAll(int fd, const std::string& bytes);

}  // namespace coopdyn
