// SPDX-License-Identifier: MIT
// The daemon's services for YARP programs.
#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "server/app/daemon.h"
#include "server/net/turn.h"

namespace coopdyn {

void Daemon::OpenYarpPort(const std::string& name, const std::string& asker) {
  if (!opens_yarp_ports_) return;
  robots_->OpenYarpPort(name, asker);
  for (Endpoint* const module : GlobalModules()) yarp_ports_.Open(name, *module, control_, asker);
  if (name == kYarpClock && !clock_timer_) RepeatClock();
  if (!sweep_timer_ && !yarp_ports_.empty()) SweepYarpPorts();
}

void Daemon::SweepYarpPorts() {
  constexpr std::chrono::seconds kPeriod{5};
  if (!sweep_timer_) sweep_timer_.emplace(control_.context());
  sweep_timer_->expires_after(kPeriod);
  sweep_timer_->async_wait([this](const boost::system::error_code& aborted) {
    if (aborted || !opens_yarp_ports_) return;
    yarp_ports_.CloseUnused(clock_.Now());
    SweepYarpPorts();
  });
}

void Daemon::RepeatClock() {
  constexpr std::chrono::milliseconds kPeriod{100};
  if (!clock_timer_) clock_timer_.emplace(control_.context());
  clock_timer_->expires_after(kPeriod);
  clock_timer_->async_wait([this](const boost::system::error_code& aborted) {
    if (aborted) return;
    Turn::Of(control_.context()).Run([this] { simulation_->RepeatClock(); });
    RepeatClock();
  });
}

void Daemon::TellYarpServer() {
  if (name_client_ == nullptr) return;
  for (const NameEntry& entry : names_.List()) {
    if (entry.external || entry.port == 0 || entry.kind == NameKind::kAlias) continue;
    for (const char* const end :
         {"/state:o", "/command:i", "/stateExt:o", "/rpc:i", "/nws/rpc:i", "/measures:o", "/rpc:o",
          "/inertial:o", "/analog:o", "/analog:o/rpc:i", "/odometry:o", "/rpc", "/depth:o", "/data:o",
          "/rgbImage:o", "/depthImage:o"}) {
      if (!yarp_ports_.IsKept(entry.name + end)) OpenYarpPort(entry.name + end, "");
    }
    const std::string base = entry.name.substr(0, entry.name.rfind('/')) + "/base";
    for (const char* const end : {"/command:i", "/rpc:i"}) {
      if (!yarp_ports_.IsKept(base + end)) OpenYarpPort(base + end, "");
    }
  }
  for (const std::string_view name : {kYarpClock, kYarpClockRpc, kYarpWorldInterface}) {
    if (!yarp_ports_.IsKept(std::string(name))) OpenYarpPort(std::string(name), "");
  }
  std::map<std::string, int> names;
  for (const NameEntry& entry : names_.List()) {
    if (entry.external || entry.port == 0) continue;
    if (entry.kind == NameKind::kAlias && !yarp_ports_.IsKept(entry.name)) continue;
    names.emplace(entry.name, entry.port);
  }
  const std::string ip = options_.advertise.empty() && BeyondLoopback(options_) ? "" : advertised_host();
  for (const auto& [name, port] : registered_names_) {
    const auto still = names.find(name);
    if (still == names.end() || still->second != port) name_client_->Unregister(name);
  }
  for (const auto& [name, port] : names) {
    const auto before = registered_names_.find(name);
    if (before == registered_names_.end() || before->second != port) name_client_->Register(name, ip, port);
  }
  registered_names_ = std::move(names);
}

}  // namespace coopdyn
