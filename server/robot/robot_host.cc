// SPDX-License-Identifier: MIT
#include "server/robot/robot_host.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include "server/net/listener.h"

namespace coopdyn {

namespace {

/// After the start: number of busy ports tried before a module stays without port.
constexpr int kMaxBusyPorts = 1000;

/// Calls `use` with each port for clients of YARS.
template <typename Use>
void ForChannels(const Robot& robot, Use use) {
  for (std::size_t i = 0; i < robot.module_count(); ++i) {
    if (robot.is_channel(i) && robot.port(i) != 0) use(robot.port(i));
  }
}

/// Removes and returns the first robots.
std::vector<std::unique_ptr<Robot>> TakeSome(std::deque<std::unique_ptr<Robot>>& robots) {
  std::vector<std::unique_ptr<Robot>> some;
  for (; !robots.empty() && some.size() < RobotHost::kGoAtOnce; robots.pop_front())
    some.push_back(std::move(robots.front()));
  return some;
}

std::string CureOf(const std::string& error) {
  return error == kTooManyFiles ? ": raise `ulimit -n`, or give fewer robots `sockets`" : "";
}

}  // namespace

RobotHost::RobotHost(RobotServices services, RobotHostOptions options, PortPlan& ports)
    : services_(std::move(services)), options_(std::move(options)), ports_(ports) {
  if (options_.cores == 0) options_.cores = std::thread::hardware_concurrency();
}

RobotHost::~RobotHost() {
  Stop();
}

IoThread& RobotHost::ThreadFor(const Scene& scene, bool own) {
  const auto start = [this] {
    threads_.push_back({std::make_unique<IoThread>("robot-" + std::to_string(threads_.size() + 1),
                                                   services_.net.logger(), options_.spin),
                        nullptr});
    return std::ref(*threads_.back().io);
  };
  if (own) return start();
  const std::size_t pool_size = std::clamp(options_.cores / 2, std::size_t{1}, kMaxPool);
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
  if (file) std::filesystem::rename(whole, name, error);  // atomic: readers find the old port or the new one
  if (!file || error) services_.net.logger()->error("{} cannot be written", name);
}

void RobotHost::ForgetFile(const std::string& robot) {
  for (const std::unique_ptr<Robot>& each : robots_) {
    bool has_channel = false;
    if (each == nullptr) continue;
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

std::string RobotHost::OpenModule(Robot& robot, std::size_t module) {
  PortPlan& ports = PlanFor(robot, module);
  // Clients of YARS look for the next free port, and other programs may have the first.
  const bool must_be_free = change_->at_start && &ports == &ports_;
  if (ListenAsBefore(robot, module)) {
    NoteChannel(robot, module);
    return {};
  }
  if (change_->out_of_files) return kTooManyFiles;
  const int said = options_.requested_channel_ports ? robot.requested_port(module) : 0;
  for (int attempt = 0; attempt < kMaxBusyPorts; ++attempt) {
    const bool as_said = said > 0 && !ports.IsForeign(said + attempt);
    const int port = as_said ? said + attempt : ports.Take();
    if (port > PortPlan::kLast || (port == 0 && !ports.any_port())) break;
    const std::string error = robot.Listen(module, options_.addresses, port);
    if (error.empty()) {
      if (as_said) ports.Reserve(port);
      if (port == 0) ports.NoteAny(robot.port(module));
      if (robot.is_channel(module)) NoteChannel(robot, module);
      return {};
    }
    const bool no_other = port == 0 || (must_be_free && !ports.any_port());
    change_->out_of_files = error == kTooManyFiles;
    if (change_->out_of_files || (said == 0 && no_other)) {
      ports.Release(port);
      return error;
    }
    // The port stays taken in the plan: retrying it for every module would only cost time.
    if (!ports.any_port()) {
      NoteFailure(robot.module_path(module) + ": " + error, "the next free port is taken");
    }
  }
  return "no port is left up to 65535";
}

void RobotHost::Open(Robot& robot, const RobotEntry& entry) {
  for (std::size_t i = 0; HasSockets(entry) && i < robot.module_count(); ++i) {
    const std::string error = OpenModule(robot, i);
    if (error.empty()) continue;
    Fail(robot.module_path(i),
         (change_->at_start ? "" : "has no port of its own, OPEN reaches it: ") + error + CureOf(error));
    if (change_->at_start) return;
  }
  if (!robot.Register()) Fail(robot.name(), "the name of one of its modules is taken: choose another name");
}

std::string RobotHost::Apply(std::shared_ptr<const Scene> scene, bool at_start) {
  Begin(std::move(scene));
  change_->at_start = at_start;
  while (!Resume()) {
    if (change_->error.empty()) continue;
    std::string error = std::move(change_->error);
    Stop(error);
    return error;
  }
  return {};
}

void RobotHost::Begin(std::shared_ptr<const Scene> scene) {
  Change change;
  // The board has forgotten robots that were not in the previous scene, even if they are in this one.
  if (change_) change.leaving = std::move(change_->leaving);
  change.scene = std::move(scene);
  const std::vector<SceneRobot>& robots = change.scene->robots;
  for (std::size_t i = 0; i < robots.size(); ++i) change.places.emplace(robots[i].entry.name, i);
  std::vector<std::unique_ptr<Robot>> before = std::exchange(robots_, {});
  std::erase(before, nullptr);
  robots_.resize(robots.size());
  for (std::unique_ptr<Robot>& robot : before) {
    const auto found = change.places.find(robot->name());
    const bool stays = found != change.places.end() && robot->Is(*robots[found->second].entry.model);
    (stays ? robots_[found->second] : change.leaving.emplace_back()) = std::move(robot);
  }
  const auto with_sockets =
      std::ranges::count_if(robots, [this](const SceneRobot& robot) { return HasSockets(robot.entry); });
  change.own_threads = options_.threads <= 0 && static_cast<std::size_t>(with_sockets) <= kMaxOwnThreads;
  change_ = std::move(change);
}

bool RobotHost::Resume() {
  if (!change_) return true;
  if (!change_->leaving.empty()) LetGo();
  if (!change_->leaving.empty()) return false;
  BringUp();
  if (change_->next < robots_.size()) return false;
  End();
  return true;
}

void RobotHost::LetGo() {
  const auto reason = [](const Robot& robot) { return robot.name() + " is not in the new scenario"; };
  std::vector<std::unique_ptr<Robot>> gone = TakeSome(change_->leaving);
  for (const std::unique_ptr<Robot>& robot : gone) {
    const bool edited = change_->places.contains(robot->name());
    ForChannels(*robot, [&](int port) {
      vacant_.insert(port);
      had_channel_.push_back(robot->name());
      if (!edited) freed_channel_ports_.push_back(port);
    });
    Release(*robot, edited ? robot->name() + " has been edited" : reason(*robot));
  }
  Drop(std::move(gone), reason);
}

void RobotHost::BringUp() {
  for (std::size_t come = 0; change_->next < robots_.size() && come < kComeAtOnce; ++change_->next) {
    std::unique_ptr<Robot>& robot = robots_[change_->next];
    if (robot != nullptr) continue;
    ++come;
    const RobotEntry& entry = change_->scene->robots[change_->next].entry;
    try {
      const bool own = change_->own_threads && HasSockets(entry);
      IoThread& io = ThreadFor(*change_->scene, own);
      robot = std::make_unique<Robot>(entry, services_, io);
      if (own) threads_.back().only = robot.get();
      Open(*robot, entry);
    } catch (const std::exception& exception) {  // e.g. too few file descriptors for a thread
      Fail(entry.name, std::string("cannot be reached: ") + exception.what());
    }
    if (!change_->error.empty()) return;
  }
}

void RobotHost::Fail(const std::string& who, const std::string& what) {
  if (!change_->at_start) return NoteFailure(who, what);
  change_->error = who + ": " + what;
}

void RobotHost::NoteFailure(const std::string& who, const std::string& what) {
  const auto [found, is_new] = failures_.try_emplace(what, Affected{who});
  if (!is_new) ++found->second.more;
}

void RobotHost::LogFailures() {
  for (const auto& [what, affected] : std::exchange(failures_, {})) {
    const std::string more = affected.more > 0 ? fmt::format(" (and {} more)", affected.more) : "";
    services_.net.logger()->warn("{}{}: {}", affected.first, more, what);
  }
}

void RobotHost::End() {
  change_.reset();
  LogFailures();
  freed_channel_ports_.clear();
  for (const auto& [port, left] : std::exchange(left_, {}))
    services_.net.logger()->info("{}: connections to port {} end", left.why, port);
  for (const std::string& name : std::exchange(had_channel_, {})) ForgetFile(name);
  for (const std::unique_ptr<Robot>& robot : robots_) {
    if (robot != nullptr) ForChannels(*robot, [this](int port) { vacant_.erase(port); });
  }
  for (const int port : std::exchange(vacant_, {})) {
    if (services_.yars != nullptr) services_.yars->Vacate(options_.addresses, port);
  }
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
  std::vector<const Robot*> gone;
  on_its_thread([&](std::unique_ptr<Robot>& robot) { robot->CloseConnections(reason(*robot)); });
  on_its_thread([&](std::unique_ptr<Robot>& robot) {
    for (std::size_t i = 0; i < robot->module_count(); ++i) PlanFor(*robot, i).Release(robot->port(i));
    gone.push_back(robot.get());
    robot.reset();
  });
  std::erase_if(threads_, [&gone](const Thread& thread) {
    return thread.only != nullptr && std::ranges::count(gone, thread.only) > 0;
  });
}

void RobotHost::OpenYarpPort(const std::string& name, const std::string& asker) {
  if (!options_.sockets) return;
  for (const std::unique_ptr<Robot>& robot : robots_) {
    const bool its = robot != nullptr && name.starts_with("/" + robot->name() + "/");
    if (its && robot->module_count() > 0 && robot->port(0) > 0) robot->OpenYarpPort(name, asker);
  }
}

bool RobotHost::CloseClient(const std::string& robot, ClientId client, const std::string& reason) {
  const auto found = std::ranges::find_if(
      robots_, [&](const auto& each) { return each != nullptr && each->name() == robot; });
  if (found == robots_.end()) return false;
  (*found)->CloseClient(client, reason);
  return true;
}

void RobotHost::Stop(const std::string& reason) {
  std::vector<std::unique_ptr<Robot>> all = std::exchange(robots_, {});
  if (change_) std::ranges::move(change_->leaving, std::back_inserter(all));
  change_.reset();
  std::erase(all, nullptr);
  Drop(std::move(all), [&reason](const Robot& /*robot*/) { return reason; });
  left_.clear();
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
