// SPDX-License-Identifier: MIT
#include "server/app/daemon.h"

#include <pthread.h>
#include <spdlog/fmt/fmt.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <sstream>
#include <thread>
#include <utility>

#include "server/app/addresses.h"
#include "server/net/listener.h"
#include "server/sensing/channel_filters.h"

namespace coopdyn {

namespace {

constexpr int kExternalPorts = 8000;  // for names of other programs, above the daemon's own ports
constexpr int kChannelPort = 4500;    // YARS's first port
constexpr std::chrono::microseconds kLockstepSpin{50};
constexpr std::size_t kMaxSpinningRobots = 4;

std::string RandomToken() {
  std::array<unsigned char, 8> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::string TokenOf(const ServeOptions& options) {
  const bool asked_for = BeyondLoopback(options) || options.token_for_all;
  if (!options.token.empty() || options.no_net || !asked_for) return options.token;
  return RandomToken();
}

/// The daemon's search path; ends with `uploads` unless that is empty.
SearchPath PathOf(const ServeOptions& options, const std::filesystem::path& uploads) {
  SearchPath path = DataPath(options.scenario_folders);
  if (!uploads.empty()) path.folders.push_back(uploads);
  path.uploads = uploads;
  path.is_strict = options.strict;
  return path;
}

std::optional<YarpDialect> DialectOf(const ServeOptions& options) {
  if (options.yarp_dialect == "auto") return {};
  return options.yarp_dialect == "4" ? YarpDialect::k4 : YarpDialect::k3;
}

/// Listens on `port` or, if it is in use and `any_port`, on another port.
template <typename Server>
std::string ListenOn(Server& server, const std::vector<std::string>& addresses, int port, bool any_port) {
  std::string error = server.Listen(addresses, port);
  return error.empty() || !any_port ? error : server.Listen(addresses, 0);
}

}  // namespace

Daemon::Daemon(const ServeOptions& options, Logger logger, Shutdown& shutdown)
    : options_(options),
      logger_(std::move(logger)),
      shutdown_(shutdown),
      token_(TokenOf(options)),
      uploads_(options.no_net || options.no_http ? std::filesystem::path() : Uploads::ChooseFolder()),
      models_(PathOf(options, uploads_)),
      yarp_(names_, logger_,
            {options.yarp_server, advertised_host(), Addresses(options.hosts).front(), DialectOf(options),
             !options.token_for_all,
             [this](std::uint64_t id, const std::string& name, std::uint64_t step, int every) {
               board_.NoteSampleTaken(id, name, step, every);
             },
             [this](std::uint64_t id) { board_.ForgetReader(id); }}),
      net_(logger_, clock_, AllEncodings(), options.read_only, !options.token_for_all),
      wrong_tokens_(logger_),
      robot_guard_(token_, options.private_robots, &wrong_tokens_),
      control_guard_(token_, true, &wrong_tokens_),
      ports_(options.port == 0 || options.any_port ? 0 : options.port + 2,
             [this](int port) {
               return names_.IsExternalPort(port) || (ports_.any_port() && !IsPortFree(port));
             }),
      channel_ports_(options.channel_port.value_or(options.port == 0 ? 0 : kChannelPort),
                     [this](int port) { return IsOwnPort(options_, port); }),
      yarp_ports_(addresses(), net_, names_),
      pool_(ThreadsOf(options)),
      controllers_(ControllersOf(options), clock_, logger_, pool_, DrawOn(images_)),
      stepper_({frames_, board_, edits_, run_, bell_}, clock_, logger_, options.run,
               {&pool_, &controllers_, AdvanceFilters}),
      recordings_(recording_options(), edits_, run_, frames_, clock_, logger_),
      branches_({BranchStateMaker(replay_services()), OpenOn(models_.path())}, edits_, run_, logger_),
      runs_(
          options_.record.folder, models_.path(), [this] { return recordings_.status().file.file; }, logger_),
      loader_("load", logger_),
      control_("control", logger_),
      yars_desk_(control_, net_, frames_, options.channel_quits),
      yars_ports_(yars_desk_, control_, net_) {
  board_.MeasureWaits(clock_);
  stepper_.set_on_ended([this] { shutdown_.Request(); });
}

Encodings Daemon::AllEncodings() {
  Encodings all = EncodingsWithYarp(yarp_);
  all.insert(all.begin(), YarsTcpEncodingKind(yars_desk_));
  return all;
}

Daemon::~Daemon() {
  Stop();
}

std::string Daemon::Start() {
  if (std::string error = StartWorld(); !error.empty()) return error;
  const bool undriven = options_.no_net || options_.read_only;
  if (undriven && player_ == nullptr && board_.mode() == Mode::kLockstep && !board_.AllReady()) {
    return std::string(options_.no_net ? "--no-net" : "--read-only") +
           " leaves nobody to drive the robots in lockstep: use --mode free";
  }

  if (!options_.no_render) {
    RenderOptions render;
    render.renderer = *ParseRenderer(options_.renderer);
    render.fps = options_.render_fps;
    render.on_failure = [this](const std::string& text) {
      const FramePtr frame = frames_.Latest();
      run_.AddEvent({frame ? frame->step : 0, frame ? frame->time_s() : 0, "error", text});
    };
    render_ = std::make_unique<RenderThread>(images_, frames_, clock_, render, logger_);
  } else {
    images_.Close("the daemon was started with --no-render: it makes no pictures");
  }
  stepper_.WaitForRun();
  if (std::string error = OpenNames(); !error.empty()) return error;
  if (std::string error = OpenRobots(); !error.empty()) return error;
  if (std::string error = OpenPage(); !error.empty()) return error;
  if (!options_.record.file.empty()) {
    const std::string error = recordings_.StartFile(options_.record.file, options_.record.force);
    if (!error.empty()) return error;
  }
  if (name_server_ != nullptr) name_server_->Serve();
  if (std::string error = OpenSeat(); !error.empty()) return error;
  physics_ = std::jthread([this](const std::stop_token& stop) {
    pthread_setname_np(pthread_self(), "physics");
    RunWorld(stop);
  });
  return {};
}

std::string Daemon::OpenNames() {
  const int first = (options_.port == 0 ? 10000 : options_.port) + kOwnPorts;
  names_.SetExternalPorts(std::min(first, PortPlan::kLast - 1),
                          std::min(first + kExternalPorts, PortPlan::kLast), IsPortFree);
  if (options_.no_net) return {};
  if (!options_.seat.empty()) net_.AdmitOnlyKnown();
  name_server_ = std::make_unique<NameServer>(
      control_.context(), names_, net_, options_.advertise,
      NameHooks{
          [this](const std::string& name, const std::string& asker) { OpenYarpPort(name, asker); },
          [this](const Subscription& each, bool connects) { yarp_.Tell(each.from, each.to, connects); }});
  if (!listens()) return {};
  const int port = options_.name_port.value_or(options_.port);
  std::string error = ListenOn(*name_server_, addresses(), port, options_.any_port);
  if (!error.empty()) return WithAdvice(error, "--port, or --name-port");
  ports_.Reserve(name_server_->port());
  ports_.Reserve(options_.http_port.value_or(options_.port == 0 ? 0 : options_.port + 1));
  return {};
}

std::string Daemon::OpenRobots() {
  RobotHostOptions host;
  host.sockets = listens();
  if (host.sockets) host.addresses = addresses();
  host.threads = options_.robot_threads.value_or(0);
  host.spin = Spin();
  host.channel_ports = &channel_ports_;
  host.requested_channel_ports = !options_.channel_port;
  host.channel_ports_file = options_.channel_ports_file;
  const RobotServices robot_services{board_,  frames_,      edits_, images_,  names_,       net_,
                                     roster_, robot_guard_, clock_, kVersion, &yars_ports_, &yarp_ports_};
  robots_ = std::make_unique<RobotHost>(robot_services, host, ports_);
  if (std::string error = robots_->Apply(frames_.Latest()->scene, true); !error.empty()) {
    return WithAdvice(error, "--port");
  }
  if (std::string error = OpenGlobalModules(); !error.empty()) return WithAdvice(error, "--port");
  if (!options_.yarp_server.empty() && host.sockets) {
    std::string yarp_host;
    int yarp_port = 0;
    std::string unreadable = NameClient::ParseServer(options_.yarp_server, yarp_host, yarp_port);
    if (!unreadable.empty()) return unreadable;
    name_client_ = std::make_unique<NameClient>(yarp_host, yarp_port, logger_);
  }
  control_.Post([this] {
    opens_yarp_ports_ = true;
    TellYarpServer();
  });
  return {};
}

std::string Daemon::OpenGlobalModules() {
  const IoThread::Poster post = control_.poster();
  const GlobalServices services{
      board_,
      frames_,
      edits_,
      roster_,
      control_guard_,
      clock_,
      kVersion,
      [this](auto scene, auto done) { ApplyScene(std::move(scene), std::move(done)); },
      [this](const Frame& frame, std::string deed, const std::string& by) {
        run_.AddDeed({frame.step, frame.time_s(), "info", std::move(deed)}, by);
      }};
  simulation_ = std::make_unique<SimulationModule>(
      SimulationServices{services, run_, names_, models_, *this,
                         [this](std::function<void()> load) { loader_.Post(std::move(load)); },
                         options_.run.seed},
      post);
  world_ = std::make_unique<WorldModule>(
      WorldServices{services, run_, models_,
                    [this](std::function<void()> read) { loader_.Post(std::move(read)); }},
      post);
  swarm_ = std::make_unique<SwarmModule>(
      GlobalServices{board_, frames_, edits_, roster_, robot_guard_, clock_, kVersion}, ThreadsOf(options_),
      post);
  playback_ = std::make_unique<PlaybackModule>(services, run_, branches_, runs_, post);
  recorder_ = std::make_unique<RecorderModule>(
      services, recordings_, runs_, [this] { return http(); }, post);
  for (Endpoint* const module : GlobalModules()) {
    published_.push_back(std::make_unique<NamedPort>(module->path(), *module, control_, net_, names_));
    NamedPort& port = *published_.back();
    std::string error =
        !listens() ? port.Open({}, 0) : port.Open(addresses(), ports_.any_port() ? 0 : ports_.Take());
    if (!error.empty()) return error;
  }
  control_.Call([this] { yars_desk_.Open(*simulation_); });
  return {};
}

std::vector<Endpoint*> Daemon::GlobalModules() const {
  return {simulation_.get(), swarm_.get(), playback_.get(), recorder_.get(), world_.get()};
}

std::string Daemon::OpenPage() {
  if (options_.no_net || options_.no_http) return {};
  WebOptions web;
  web.host_names = options_.hosts;
  if (!options_.advertise.empty()) web.host_names.push_back(options_.advertise);
  std::array<char, 256> own_name{};
  if (::gethostname(own_name.data(), own_name.size() - 1) == 0) web.host_names.emplace_back(own_name.data());
  web.guard = &control_guard_;
  web.version = kVersion;
  web.name_port = name_server_->port();
  web.names = [this](const std::string& what) { return NamesOf(models_.path(), what); };
  web.runs.list = [this](std::function<void(const std::string&)> done) {
    runs_.List(
        [this, done = std::move(done)](const std::vector<RunFile>& runs) { done(RunsJson(runs, http())); });
  };
  web.runs.open = [this](const std::string& name, std::function<void(const WebRunFile&)> done) {
    runs_.Open(name, [done = std::move(done)](const RunToCopy& run) {
      const bool missing = run.error == Error::kNoSuchName;
      const unsigned status = run.error == Error::kOk ? 200 : missing ? 404 : 409;
      done({status, run.text, run.file.string(), run.temporary});
    });
  };
  page_ = std::make_unique<PageServices>(models_.path(), uploads_, options_.no_render ? nullptr : &images_,
                                         runs_, run_, replay_services(), logger_);
  web.files = page_->files();
  web.costs = [this] { return Costs(); };
  web_ = std::make_unique<WebServer>(std::move(web), names_, frames_, options_.no_render ? nullptr : &images_,
                                     net_);
  if (!listens()) return {};
  const int port = options_.http_port.value_or(options_.port == 0 ? 0 : options_.port + 1);
  const std::string error = ListenOn(*web_, addresses(), port, options_.any_port);
  return WithAdvice(error, "--port, or --http-port");
}

std::string Daemon::OpenSeat() {
  if (options_.seat.empty()) return {};
  seat_door_ = std::make_unique<PassedDoor>(control_.context(), [this](PassedSocket passed) {
    switch (passed.kind) {
      case PassedKind::kNames:
        return name_server_->Adopt(std::move(passed.fd), std::move(passed.peer),
                                   std::move(passed.already_read));
      case PassedKind::kPage:
        if (web_ != nullptr)
          web_->Adopt(std::move(passed.fd), std::move(passed.peer), std::move(passed.already_read));
        return;
      case PassedKind::kTaken:
      case PassedKind::kGiven:
        return net_.SetTaken(passed.kind == PassedKind::kTaken);
      case PassedKind::kAdmit:
        return net_.Admit(passed.peer.text);
    }
  });
  return seat_door_->Listen(options_.seat);
}

CostSnapshot Daemon::Costs() const {
  const RunStatus status = run_.status();
  CostSnapshot snapshot{.now = clock_.Now(),
                        .mode = status.mode,
                        .playing = run_.playback().has_value(),
                        .recording = !recordings_.recording().empty(),
                        .costs = status.costs,
                        .waits = board_.waits()};
  for (CpuUser& thread : ReadThreadUse())
    snapshot.threads.push_back({std::move(thread.name), thread.id, thread.cpu});
  return snapshot;
}

void Daemon::Stop() {
  if (std::exchange(stopped_, true)) return;
  run_.End(RunEnd::kSignal);  // keeps an earlier reason
  controllers_.Interrupt();
  // Stopping physics answers all pending requests before the robots close their connections.
  physics_.request_stop();
  bell_.Ring();
  if (physics_.joinable()) physics_.join();
  recordings_.Close();
  // The robot host belongs to the control thread, which may be bringing up a scene.
  control_.Call([this] {
    seat_door_.reset();
    name_server_.reset();  // first: clients must not see names disappear
    applied_.clear();
    opens_yarp_ports_ = false;
    if (robots_ != nullptr) robots_->Stop(run_.stopping_text());
  });
  for (const Endpoint* const module : GlobalModules()) {
    if (module != nullptr) yarp_ports_.CloseOf(*module, run_.stopping_text());
  }
  while (!published_.empty()) {
    published_.back()->Close(run_.stopping_text());
    published_.pop_back();
  }
  control_.Call([this] {
    yars_desk_.Close();
    clock_timer_.reset();
    sweep_timer_.reset();
  });
  control_.Stop();
  name_client_.reset();
  yarp_.Stop();
  if (web_ != nullptr) web_->Stop();
  runs_.Stop();  // before the modules that it answers are destroyed
  page_.reset();
  recorder_.reset();
  playback_.reset();
  swarm_.reset();
  world_.reset();
  simulation_.reset();
  if (render_ != nullptr) render_->Stop();
}

std::chrono::microseconds Daemon::Spin() const {
  if (options_.spin_us) return std::chrono::microseconds(*options_.spin_us);
  const std::size_t robots = frames_.Latest()->scene->robots.size();
  // Each robot may have its own thread: spinning threads must not take cores from each other and from
  // clients.
  const bool few = robots <= kMaxSpinningRobots && robots < std::thread::hardware_concurrency();
  return few && board_.mode() == Mode::kLockstep ? kLockstepSpin : std::chrono::microseconds(0);
}

void Daemon::UpdateSpin() {
  const auto spin = Spin();
  control_.Post([this, spin] { robots_->SetSpin(spin); });
}

void Daemon::WatchPace() {
  const std::string warning = overload_.Look(clock_.Now(), run_.status());
  if (warning.empty()) return;
  logger_->warn("{}", warning);
  const FramePtr frame = frames_.Latest();
  run_.AddEvent({frame->step, frame->time_s(), "warning", warning});
}

void Daemon::LogWaiting() {
  constexpr double kLogAfter_s = 2;
  constexpr Nanoseconds kAgainAfter = 60 * kNanosecondsPerSecond;
  const Nanoseconds now = clock_.Now();
  std::size_t total = 0;
  const std::vector<Awaited> awaited = board_.Awaiting(now, 1, &total);
  const bool waits =
      !awaited.empty() && awaited[0].seconds >= kLogAfter_s && status().state == RunState::kRunning;
  if (!waits) {
    waiting_logged_ = 0;
  } else if (waiting_logged_ == 0 || now - waiting_logged_ >= kAgainAfter) {
    waiting_logged_ = now;
    const std::string others = total > 1 ? fmt::format(" and {} more", total - 1) : "";
    const std::string& cure = awaited[0].cure;
    logger_->info("waiting for {} ({}){}, {:.1f} s{}{}", awaited[0].robot, awaited[0].why, others,
                  awaited[0].seconds, cure.empty() ? "" : ": ", cure);
  }
}

void Daemon::ApplyScene(std::shared_ptr<const Scene> scene, std::function<void()> done) {
  robots_->Begin(std::move(scene));
  applied_.push_back(std::move(done));
  if (applied_.size() == 1) ResumeApplying();
}

void Daemon::ResumeApplying() {
  if (applied_.empty()) return;  // the daemon is stopping
  if (!robots_->Resume()) return control_.Post([this] { ResumeApplying(); });
  robots_->SetSpin(Spin());
  TellYarpServer();
  for (const auto& done : std::exchange(applied_, {})) done();
}

void Daemon::CloseClient(const std::string& robot, ClientId client, const std::string& reason) {
  robots_->CloseClient(robot, client, reason);
}

RunReport Daemon::report(double wall_s) const {
  return {frames_.Latest(), run_.status(),        run_.end(), run_.stopped_or_failed(),
          run_.logged(),    recordings_.failed(), {},         wall_s};
}

void Daemon::Quit() {
  run_.End(RunEnd::kQuit);
  shutdown_.Request();
}

std::vector<std::string> Daemon::addresses() const {
  return Addresses(options_.hosts);
}

std::string Daemon::advertised_host() const {
  if (!options_.advertise.empty()) return options_.advertise;
  if (options_.hosts.empty()) return "127.0.0.1";
  const std::string address = ListenAddresses(options_.hosts.front()).front();
  return address == "0.0.0.0" || address == "::" ? "127.0.0.1" : address;
}

std::string Daemon::http() const {
  if (!options_.seat.empty()) return options_.seat_url;
  return web_ == nullptr ? "" : fmt::format("http://{}:{}/", Bracketed(advertised_host()), web_->port());
}

std::vector<std::string> Daemon::ChannelLines() const {
  std::vector<std::string> lines;
  for (const auto& robot : robots_->robots()) {
    for (std::size_t i = 0; i < robot->module_count(); ++i) {
      if (robot->is_channel(i))
        lines.push_back(fmt::format("opened port {} for {}", robot->port(i), robot->name()));
    }
  }
  return lines;
}

std::string Daemon::ReadyLine() const {
  const std::string names =
      !listens() ? "off" : fmt::format("{}:{}", Bracketed(advertised_host()), name_server_->port());
  return fmt::format("ready names={} http={} robots={}", names,
                     web_ == nullptr || !listens() ? "off" : http(), frames_.Latest()->scene->robots.size());
}

std::string Daemon::ConnectHints() const {
  std::ostringstream out;
  if (!listens()) return {};
  // With --host 0.0.0.0 other machines need an address of this machine, not 127.0.0.1.
  std::string host = advertised_host();
  if (BeyondLoopback(options_) && IsLoopback(host)) {
    if (const std::string lan = LanAddress(); !lan.empty()) host = lan;
  }
  const int port = name_server_->port();
  const std::string server =
      port == 10000 && IsLoopback(host) ? "" : fmt::format("\"{}:{}\"", Bracketed(host), port);
  const auto& robots = frames_.Latest()->scene->robots;
  const auto driven = std::ranges::find_if(
      robots, [](const SceneRobot& one) { return one.entry.sockets && one.entry.model->has_actuators(); });
  const auto first = driven != robots.end() ? driven : robots.begin();
  const std::string robot = robots.empty() ? "robot1" : first->entry.name;
  const std::vector<ModuleModel> modules =
      robots.empty() ? std::vector<ModuleModel>() : first->entry.model->modules();
  const std::string module = modules.empty() ? "motors" : modules.front().name;  // drives the robot
  if (web_ != nullptr) out << fmt::format("page:    http://{}:{}/\n", Bracketed(host), web_->port());
  out << "MATLAB:  sim = coopdyn.connect(" << server << "); r = sim.robot(\"" << robot << "\");\n"
      << "Python:  import coopdyn; sim = coopdyn.connect(" << server << "); r = sim.robot(\"" << robot
      << "\")\n"
      << "telnet:  telnet " << host << ' ' << port << "   then: OPEN /" << robot << '/' << module << "\n";
  if (!token_.empty()) {
    out << "token:   " << token_ << "   (" << (options_.token_for_all ? "all programs" : "other machines")
        << " need it to change the world)\n";
  }
  return out.str();
}

}  // namespace coopdyn
