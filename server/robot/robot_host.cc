// SPDX-License-Identifier: MIT
#include "server/robot/robot_host.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <utility>

namespace coopdyn {

namespace {

/// After the start: at most this many busy ports are passed over before a module stays without one.
constexpr int kMaxBusyPorts = 1000;

/// Calls `use` with each port for clients of YARS.
template <typename Use>
void ForChannels(const Robot& robot, Use use) {
  for (std::size_t i = 0; i < robot.module_count(); ++i) {
    if (robot.is_channel(i) && robot.port(i) != 0) use(robot.port(i));
  }
}

}  // namespace

RobotHost::RobotHost(RobotServices services, RobotHostOptions options, PortPlan& ports)
    : services_(std::move(services)), options_(std::move(options)), ports_(ports) {}

RobotHost::~RobotHost() {
  Stop();
}

IoThread& RobotHost::ThreadFor(const Scene& scene, bool own) {
  const std::size_t cores = options_.cores > 0 ? options_.cores : std::thread::hardware_concurrency();
  const auto start = [this] {
    threads_.push_back({std::make_unique<IoThread>("robot-" + std::to_string(threads_.size() + 1),
                                                   services_.net.logger(), options_.spin),
                        nullptr});
    return std::ref(*threads_.back().io);
  };
  if (own) return start();
  const std::size_t pool_size = std::clamp(cores / 2, std::size_t{1}, kMaxPool);
  const std::size_t wanted =
      options_.threads > 0 ? static_cast<std::size_t>(options_.threads)
                           : std::clamp(scene.robots.size() / kRobotsPerThread, std::size_t{1}, pool_size);
  std::vector<IoThread*> pool;
  for (const Thread& thread : threads_) {
    if (thread.only == nullptr) pool.push_back(thread.io.get());
  }
  if (pool.size() < wanted) return start();
  return *pool[next_of_pool_++ % pool.size()];
}

void RobotHost::NoteChannel(const Robot& robot, std::size_t module) {
  const int port = robot.port(module);
  std::erase_if(last_channel_ports_, [port](const auto& each) { return each.second == port; });
  last_channel_ports_[robot.name()] = port;
  services_.net.logger()->info("{} is on port {} for clients of YARS, by UDP and TCP",
                               robot.module_path(module), port);
  if (options_.channel_ports_file.empty()) return;
  const std::string name = ChannelFile(robot.name()), whole = name + ".new";
  std::ofstream file(whole);
  file << port << "\n";
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(whole, name, error);  // a reader finds the old port or the new one
  if (!file || error) services_.net.logger()->error("{} cannot be written", name);
}

void RobotHost::FreeChannels(const Robot& robot) {
  for (std::size_t i = 0; i < robot.module_count(); ++i) {
    if (!robot.is_channel(i) || robot.port(i) == 0) continue;
    freed_channel_ports_.push_back(robot.port(i));
  }
}

void RobotHost::ForgetFile(const std::string& robot) {
  for (const std::unique_ptr<Robot>& each : robots_) {
    bool has_channel = false;
    ForChannels(*each, [&has_channel](int /*port*/) { has_channel = true; });
    if (has_channel && each->name() == robot) return;
  }
  std::error_code ignored;
  if (!options_.channel_ports_file.empty()) std::filesystem::remove(ChannelFile(robot), ignored);
}

void RobotHost::Release(Robot& robot, const std::string& why) {
  for (std::size_t i = 0; i < robot.module_count(); ++i) {
    if (robot.is_channel(i) && robot.port(i) != 0) left_.emplace(robot.port(i), Left{robot.Release(i), why});
  }
}

bool RobotHost::ListenAsBefore(Robot& robot, std::size_t module) {
  if (!robot.is_channel(module)) return false;
  int port = 0;
  if (const auto last = last_channel_ports_.find(robot.name()); last != last_channel_ports_.end()) {
    port = last->second;
  } else if (!freed_channel_ports_.empty()) {
    port = freed_channel_ports_.front();
    freed_channel_ports_.pop_front();
  }
  if (auto left = left_.extract(port); !left.empty()) {
    robot.Listen(module, options_.addresses, std::move(left.mapped().port));
  } else if (port == 0 || !robot.Listen(module, options_.addresses, port).empty()) {
    return false;
  }
  PlanFor(robot, module).Reserve(port);
  return true;
}

std::string RobotHost::OpenModule(Robot& robot, std::size_t module, bool at_start) {
  PortPlan& ports = PlanFor(robot, module);
  // Clients of YARS look for the next free port, and others may have the first.
  const bool must_be_free = at_start && &ports == &ports_;
  if (ListenAsBefore(robot, module)) {
    NoteChannel(robot, module);
    return {};
  }
  const int said = options_.said_channel_ports ? robot.said_port(module) : 0;
  for (int attempt = 0; attempt < kMaxBusyPorts; ++attempt) {
    const bool as_said = said > 0 && !ports.IsForeign(said + attempt);
    const int port = as_said ? said + attempt : ports.Take();
    if (port > PortPlan::kLast || (port == 0 && !ports.any_port())) break;
    const std::string error = robot.Listen(module, options_.addresses, port);
    if (error.empty()) {
      if (as_said) ports.Reserve(port);
      if (robot.is_channel(module)) NoteChannel(robot, module);
      return {};
    }
    if (said == 0 && (must_be_free || ports.any_port())) {
      ports.Release(port);
      return robot.module_path(module) + ": " + error;
    }
    // Stays taken in the plan: trying it again for every module would only cost time.
    services_.net.logger()->warn("{}: {}; trying the next one", robot.module_path(module), error);
  }
  return robot.module_path(module) + ": no port is left up to 65535";
}

std::string RobotHost::Open(Robot& robot, const RobotEntry& entry, bool at_start) {
  for (std::size_t i = 0; HasSockets(entry) && i < robot.module_count(); ++i) {
    const std::string error = OpenModule(robot, i, at_start);
    if (error.empty()) continue;
    if (at_start) return error;
    services_.net.logger()->error("{}; it can be reached through OPEN only", error);
  }
  if (!robot.Register())
    return "the name of a module of " + robot.name() + " is taken: choose another robot name";
  return {};
}

std::string RobotHost::Apply(const Scene& scene, bool at_start) {
  std::unordered_map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) places.emplace(scene.robots[i].entry.name, i);
  std::vector<std::unique_ptr<Robot>> before = std::exchange(robots_, {}), kept(scene.robots.size());
  freed_channel_ports_.clear();
  std::set<int> vacant;  // ports of channels that are gone
  std::vector<std::string> with_channel;
  for (std::unique_ptr<Robot>& robot : before) {
    ForChannels(*robot, [&](int port) {
      vacant.insert(port);
      with_channel.push_back(robot->name());
    });
    const auto found = places.find(robot->name());
    if (found == places.end()) {
      FreeChannels(*robot);
    } else if (robot->Is(*scene.robots[found->second].entry.model)) {
      kept[found->second] = std::move(robot);
    }
  }
  // The leaving ones first: their names and ports may be wanted.
  std::erase(before, nullptr);
  const auto reason = [](const Robot& robot) { return robot.name() + " is not in the new scenario"; };
  for (const std::unique_ptr<Robot>& robot : before) {
    Release(*robot, places.contains(robot->name()) ? robot->name() + " has been edited" : reason(*robot));
  }
  Drop(std::move(before), reason);
  const auto with_sockets =
      std::count_if(scene.robots.begin(), scene.robots.end(),
                    [this](const SceneRobot& robot) { return HasSockets(robot.entry); });
  const bool own_threads = options_.threads <= 0 && static_cast<std::size_t>(with_sockets) <= kMaxOwnThreads;
  std::string error;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const RobotEntry& entry = scene.robots[i].entry;
    if (kept[i] == nullptr && interrupted_) continue;
    if (kept[i] == nullptr) {
      const bool own = own_threads && HasSockets(entry);
      IoThread& io = ThreadFor(scene, own);
      kept[i] = std::make_unique<Robot>(entry, services_, io);
      if (own) threads_.back().only = kept[i].get();
      error = Open(*kept[i], entry, at_start);
    }
    robots_.push_back(std::move(kept[i]));
    if (!error.empty() && at_start) break;
    if (!error.empty()) services_.net.logger()->error("{}", std::exchange(error, {}));
  }
  if (!error.empty()) Stop(error);
  for (const auto& [port, left] : std::exchange(left_, {}))
    services_.net.logger()->info("{}: connections to port {} end", left.why, port);
  for (const std::string& name : with_channel) ForgetFile(name);
  for (const std::unique_ptr<Robot>& robot : robots_)
    ForChannels(*robot, [&vacant](int port) { vacant.erase(port); });
  if (services_.yars != nullptr) {
    for (const int port : vacant) services_.yars->Vacate(options_.addresses, port);
  }
  return error;
}

void RobotHost::Drop(std::vector<std::unique_ptr<Robot>> robots,
                     const std::function<std::string(const Robot&)>& reason) {
  const auto on_its_thread = [this, &robots](const auto& act) {
    for (const Thread& thread : threads_) {
      thread.io->Call([&] {
        for (std::unique_ptr<Robot>& robot : robots) {
          if (robot != nullptr && robot->RunsOn(*thread.io)) act(robot);
        }
      });
    }
  };
  std::set<const Robot*> gone;
  on_its_thread([&](std::unique_ptr<Robot>& robot) { robot->CloseConnections(reason(*robot)); });
  on_its_thread([&](std::unique_ptr<Robot>& robot) {
    for (std::size_t i = 0; i < robot->module_count(); ++i) PlanFor(*robot, i).Release(robot->port(i));
    gone.insert(robot.get());
    robot.reset();
  });
  std::erase_if(threads_, [&gone](const Thread& thread) { return gone.contains(thread.only); });
}

void RobotHost::OpenYarpPort(const std::string& name, const std::string& asker) {
  if (!options_.sockets) return;
  for (const std::unique_ptr<Robot>& robot : robots_) {
    const bool its = name.starts_with("/" + robot->name() + "/");
    if (its && robot->module_count() > 0 && robot->port(0) > 0) robot->OpenYarpPort(name, asker);
  }
}

bool RobotHost::CloseClient(const std::string& robot, ClientId client, const std::string& reason) {
  const auto found = std::find_if(robots_.begin(), robots_.end(),
                                  [&](const std::unique_ptr<Robot>& each) { return each->name() == robot; });
  if (found == robots_.end()) return false;
  (*found)->CloseClient(client, reason);
  return true;
}

void RobotHost::Stop(const std::string& reason) {
  Drop(std::exchange(robots_, {}), [&reason](const Robot& /*robot*/) { return reason; });
  threads_.clear();
}

void RobotHost::SetSpin(std::chrono::microseconds spin) {
  options_.spin = spin;
  for (const Thread& thread : threads_) thread.io->SetSpin(spin);
}

std::size_t RobotHost::thread_count() const {
  return threads_.size();
}

}  // namespace coopdyn
