// SPDX-License-Identifier: MIT
#include "server/host/seat.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "server/base/printable.h"
#include "server/base/sanitizers.h"
#include "server/base/spawn.h"
#include "server/base/wrong_tokens.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
using boost::system::error_code;

constexpr std::chrono::milliseconds kLookEvery{10};
constexpr std::uintmax_t kMaxLog = std::uintmax_t{1} << 20;
constexpr const char* kRuns = "runs";
constexpr int kLastRun = 999'999;

void Limit(pid_t process, __rlimit_resource what, std::uint64_t most) {
  const rlimit limit{most, most};
  ::prlimit(process, what, &limit, nullptr);
}

/// The process that listens at the other end.
pid_t ProcessBehind(int fd) {
  ucred who{};
  socklen_t size = sizeof who;
  return ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 ? who.pid : 0;
}

/// It has ended, but its parent, as some containers' first process, does not ask how.
bool IsZombie(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  const std::string stat{std::istreambuf_iterator<char>(file), {}};
  return stat.find(") Z ", std::min(stat.rfind(')'), stat.size())) != std::string::npos;
}

/// Also of a daemon that an earlier host started. One of ours that has ended is gone from then on.
bool IsAlive(pid_t process) {
  if (process <= 0) return false;
  const pid_t ended = ::waitpid(process, nullptr, WNOHANG);
  // 0: ours, and not ended as a whole, though its first thread may look like a zombie.
  if (ended >= 0) return ended == 0;
  return !IsZombie(process) && (::kill(process, 0) == 0 || errno == EPERM);
}

/// The last line of a log that says something.
std::string LastLine(const fs::path& log) {
  constexpr std::streamoff kEnd = 64 << 10;  // the log may be long
  std::ifstream file(log, std::ios::binary | std::ios::ate);
  file.seekg(std::max<std::streamoff>(file.tellg() - kEnd, 0));
  std::string line, last;
  while (std::getline(file, line)) {
    if (!line.empty()) last = line;
  }
  return Printable(last, 300);
}

}  // namespace

const char* ToString(SeatState state) {
  constexpr std::array<const char*, 4> kWords = {"asleep", "starting", "running", "failed"};
  return kWords[static_cast<std::size_t>(state)];
}

std::string RunFileName(int number) {
  return fmt::format("{:06}.run", number);
}

int NewestRun(const fs::path& folder) {
  int newest = 0;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const std::string name = it->path().filename().string();
    int number = 0;
    const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    // Longer numbers are a student's own names.
    if (error == std::errc() && std::string_view(rest) == ".run" && number <= kLastRun)
      newest = std::max(newest, number);
  }
  return newest;
}

std::size_t CountIn(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) ++count;
  return count;
}

std::uintmax_t SizeOf(const fs::path& path) {
  std::error_code code;
  if (fs::is_regular_file(path, code)) return fs::file_size(path, code);
  std::uintmax_t bytes = 0;
  for (fs::recursive_directory_iterator it(path, code), end; !code && it != end; it.increment(code)) {
    std::error_code gone;
    if (it->is_regular_file(gone)) bytes += it->file_size(gone);
  }
  return bytes;
}

Seat::Seat(boost::asio::io_context& context, std::string name, fs::path folder, std::string url,
           SeatPlan plan, const Clock& clock, Logger logger)
    : context_(context),
      name_(std::move(name)),
      folder_(std::move(folder)),
      url_(std::move(url)),
      plan_(std::move(plan)),
      clock_(clock),
      logger_(std::move(logger)),
      timer_(context),
      patience_(context) {
  std::error_code code;
  fs::create_directories(folder_ / kRuns, code);
  fs::permissions(folder_, fs::perms::owner_all, code);
}

Seat::~Seat() {
  *alive_ = false;
}

void Seat::Find() {
  UniqueFd door = ConnectToDoor(door_path());
  if (!door) return;
  process_ = ProcessBehind(door.get());
  Enter(std::move(door));
}

void Seat::Pass(PassedSocket passed) {
  if (closed_ || waiting_.size() >= kMaxWaiting) return;
  if (state_ == SeatState::kFailed) {
    if (HasFailed()) return;
    deaths_.clear();
    SetState(SeatState::kAsleep, trouble_);
  }
  waiting_.push_back(std::move(passed));
  // A daemon that is ending would drop it.
  state_ == SeatState::kRunning && !ends_ ? SendWaiting() : Wake();
}

bool Seat::HasFailed() const {
  return state_ == SeatState::kFailed && !deaths_.empty() && clock_.Now() - deaths_.back() < kCrashWindow;
}

bool Seat::PassNow(const PassedSocket& passed) {
  return state_ == SeatState::kRunning && !ends_ && SendPassed(door_->native_handle(), passed) == 0;
}

void Seat::Close() {
  closed_ = true;
  waiting_.clear();
  PutAside();
}

void Seat::Wake() {
  wanted_ = true;
  if (state_ == SeatState::kAsleep && !IsAlive(process_)) Start();
}

void Seat::PutAside() {
  wanted_ = false;
  if (state_ == SeatState::kAsleep || process_ == 0) return;
  if (!std::exchange(ends_, true)) KillIfItStays();
  ::kill(process_, SIGTERM);
}

void Seat::KillIfItStays() {
  patience_.expires_after(kEndTime);
  patience_.async_wait([this, alive = alive_, process = process_](const error_code& error) {
    if (error || !*alive || process_ != process) return;
    logger_->warn("seat {}: its daemon did not end within {} s and was killed", name_, kEndTime.count());
    ::kill(process, SIGKILL);
  });
}

void Seat::BeginAnew(const std::string& lesson) {
  const bool was_running = state_ == SeatState::kRunning || state_ == SeatState::kStarting;
  plan_.lesson = lesson;
  anew_ = true;
  deaths_.clear();
  if (state_ == SeatState::kFailed) SetState(SeatState::kAsleep, {});
  PutAside();
  wanted_ = was_running;
}

void Seat::Admit(const std::string& peer) {
  if (plan_.port == 0 || !admitted_.emplace(NetworkOf(peer), peer).second || state_ != SeatState::kRunning)
    return;
  SendPassed(door_->native_handle(), {.kind = PassedKind::kAdmit, .peer = {.text = peer}});
}

void Seat::SetTaken(bool taken) {
  taken_ = taken;
  if (state_ == SeatState::kRunning)
    SendPassed(door_->native_handle(), {.kind = taken ? PassedKind::kTaken : PassedKind::kGiven});
}

std::vector<std::string> Seat::Arguments() {
  const fs::path runs = folder_ / kRuns;
  const int newest = NewestRun(runs);
  std::vector<std::string> words = {"serve"};
  if (newest > 0 && !anew_) {
    words.insert(words.end(), {"--from", (runs / RunFileName(newest)).string() + "@end"});
  } else {
    words.push_back(plan_.lesson);
  }
  const std::vector<std::string> own = {"--seat",          door_path().string(),
                                        "--seat-url",      url_,
                                        "--record",        (runs / RunFileName(newest + 1)).string(),
                                        "--recordings",    runs.string(),
                                        "--robot-threads", "1"};
  words.insert(words.end(), own.begin(), own.end());
  if (plan_.port != 0) words.insert(words.end(), {"--seat-ports", "--port", std::to_string(plan_.port)});
  words.insert(words.end(), plan_.more_arguments.begin(), plan_.more_arguments.end());
  return words;
}

void Seat::Start() {
  TidyRuns();
  std::error_code code;
  const fs::path log = folder_ / "daemon.log";
  if (const std::uintmax_t size = fs::file_size(log, code); !code && size > kMaxLog) fs::remove(log, code);
  const UniqueFd nothing(::open("/dev/null", O_RDWR | O_CLOEXEC));
  const UniqueFd lines(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  ends_ = false;
  started_ = clock_.Now();
  const int error = Spawn(plan_.program, Arguments(), {nothing.get(), nothing.get(), lines.get()}, process_,
                          SpawnApart::kSession);
  if (error != 0) {
    process_ = 0;
    return SetState(SeatState::kFailed, std::string("its daemon cannot be started: ") + std::strerror(error));
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // their shadow memory is larger
  Limit(process_, RLIMIT_DATA, plan_.limits.memory_bytes);
#endif
  Limit(process_, RLIMIT_FSIZE, plan_.limits.disk_bytes);
  Limit(process_, RLIMIT_NOFILE, plan_.limits.open_files);
  Limit(process_, RLIMIT_CORE, 0);
  SetState(SeatState::kStarting, trouble_);
  AwaitDoor();
}

void Seat::AwaitDoor() {
  timer_.expires_after(kLookEvery);
  timer_.async_wait([this, alive = alive_](const error_code& error) {
    if (error || !*alive || state_ != SeatState::kStarting) return;
    const bool lives = IsAlive(process_);
    UniqueFd door = ConnectToDoor(door_path());
    // Another daemon may be there, which a host started that was killed at once: ours ends then.
    const pid_t behind = door ? ProcessBehind(door.get()) : 0;
    if (behind > 0 && (behind == process_ || !lives)) {
      process_ = behind;
      return Enter(std::move(door));
    }
    if (!lives) return OnDeath();
    if (clock_.Now() - started_ > kStartTime) ::kill(process_, SIGKILL);
    AwaitDoor();
  });
}

void Seat::Enter(UniqueFd door) {
  door_ = std::make_unique<Descriptor>(context_, door.get());
  door.Release();
  door_->async_wait(Descriptor::wait_read, [this, alive = alive_](const error_code& error) {
    if (!error && *alive) OnDeath();  // the daemon writes nothing: this is the end of it
  });
  anew_ = false;
  SetState(SeatState::kRunning, trouble_);
  if (taken_) SetTaken(true);
  for (const auto& [machine, peer] : admitted_)
    SendPassed(door_->native_handle(), {.kind = PassedKind::kAdmit, .peer = {.text = peer}});
  SendWaiting();
}

void Seat::OnDeath() {
  door_.reset();
  const bool by_us = std::exchange(ends_, false);
  const bool in_start = state_ == SeatState::kStarting;
  // What has closed its door may still write its recording: the next one starts when it is gone.
  if (IsAlive(process_)) {
    if (!by_us && state_ == SeatState::kRunning) KillIfItStays();
    ends_ = by_us;
    state_ = SeatState::kStarting;  // so that nobody starts another one
    timer_.expires_after(kLookEvery);
    timer_.async_wait([this, alive = alive_](const error_code& error) {
      if (!error && *alive) OnDeath();
    });
    return;
  }
  process_ = 0;
  state_ = SeatState::kAsleep;
  if (by_us) {
    SetState(SeatState::kAsleep, {});
    if (!closed_ && (wanted_ || !waiting_.empty())) Wake();
    return;
  }
  const Nanoseconds now = clock_.Now();
  deaths_.push_back(now);
  while (now - deaths_.front() > kCrashWindow) deaths_.pop_front();
  std::error_code code;
  constexpr std::uintmax_t kNothing = std::uintmax_t{64} << 10;
  const std::string why =
      fs::space(folder_, code).available < kNothing ? "the disk is full" : LastLine(folder_ / "daemon.log");
  logger_->warn("seat {}: its daemon has ended{}{}", name_, in_start ? " while it started: " : ": ", why);
  if (deaths_.size() >= 2 * kCrashes) {
    waiting_.clear();
    return SetState(SeatState::kFailed, "its daemon has ended " + std::to_string(deaths_.size()) +
                                            " times within a minute: " + why);
  }
  anew_ = deaths_.size() >= kCrashes;
  trouble_ = anew_ ? "its daemon crashed again and again: the lesson was begun anew"
                   : "its daemon crashed: it continues at the last recorded moment";
  Start();
}

void Seat::SendWaiting() {
  while (!waiting_.empty() && door_ != nullptr) {
    const int error = SendPassed(door_->native_handle(), waiting_.front());
    if (error == EAGAIN) {
      timer_.expires_after(kLookEvery);
      timer_.async_wait([this, alive = alive_](const error_code& aborted) {
        if (!aborted && *alive) SendWaiting();
      });
      return;
    }
    if (error != 0 && error != EMSGSIZE) return;  // it has ended: OnDeath() follows, and sends them again
    waiting_.pop_front();
  }
}

void Seat::SetState(SeatState state, const std::string& trouble) {
  state_ = state;
  trouble_ = trouble;
  if (on_change_) on_change_();
}

void Seat::TidyRuns() const {
  struct Run {
    fs::file_time_type time;
    fs::path file;
    std::uintmax_t bytes;
  };
  const fs::path folder = folder_ / kRuns;
  const fs::path newest = folder / RunFileName(NewestRun(folder));  // the seat continues from it
  std::vector<Run> runs;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    std::error_code gone;
    if (!it->path().filename().string().starts_with(newest.filename().string()))
      runs.push_back({it->last_write_time(gone), it->path(), it->file_size(gone)});
  }
  std::ranges::sort(runs, {}, &Run::time);
  std::uintmax_t all = SizeOf(folder);
  for (auto run = runs.begin(); run != runs.end() && all > plan_.limits.disk_bytes; ++run) {
    all -= std::min(all, run->bytes);
    fs::remove(run->file, code);
  }
}

}  // namespace coopdyn
