// SPDX-License-Identifier: MIT
// One seat of a class: a daemon of its own for a student or pair. Starts it when somebody comes, passes
// connections to it, puts it aside when nobody does anything, and starts it again where it was, also after a
// crash. The daemon outlives the host; a host that starts again finds it by its socket. One thread, that of
// the io_context.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/net/passed_socket.h"

namespace coopdyn {

/// What one seat may use.
struct SeatLimits {
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  std::uint64_t disk_bytes = std::uint64_t{1} << 30;  // of its recordings together
  std::uint64_t open_files = 1024;
};

/// How seats are started.
struct SeatPlan {
  std::filesystem::path program;            // coopdyn
  std::string lesson;                       // a scenario: path or bare name
  std::vector<std::string> more_arguments;  // of `serve`
  int port = 0;                             // the first of the seat's own ports; 0: it has none
  SeatLimits limits = {};
};

enum class SeatState { kAsleep, kStarting, kRunning, kFailed };
/// "asleep", "starting", "running", "failed"
const char* ToString(SeatState state);

class Seat {
 public:
  /// Connections that may wait for the daemon to start; more are closed.
  static constexpr std::size_t kMaxWaiting = 64;
  /// Deaths within kCrashWindow after which the run is not continued but the lesson begun again; the same
  /// number once more, and the seat has failed.
  static constexpr int kCrashes = 3;
  static constexpr Nanoseconds kCrashWindow = 60 * kNanosecondsPerSecond;
  /// How long a daemon may take to start.
  static constexpr Nanoseconds kStartTime = 60 * kNanosecondsPerSecond;

  /// How long a daemon that was told to end may take; then it is killed.
  static constexpr std::chrono::seconds kEndTime{20};

  /// `folder` holds what belongs to the seat; it is made if it is not there. `url`: of its page. `clock`
  /// outlives the seat.
  Seat(boost::asio::io_context& context, std::string name, std::filesystem::path folder, std::string url,
       SeatPlan plan, const Clock& clock, Logger logger);
  ~Seat();
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;

  const std::string& name() const { return name_; }
  const std::filesystem::path& folder() const { return folder_; }
  SeatState state() const { return state_; }
  /// Whether it crashes again and again; after kCrashWindow it is tried once more.
  bool HasFailed() const;
  /// What has gone wrong last, for the wall; empty: nothing.
  const std::string& trouble() const { return trouble_; }
  /// Called when state or trouble has changed.
  void set_on_change(std::function<void()> on_change) { on_change_ = std::move(on_change); }

  /// Takes a daemon back that an earlier host started, if it still runs.
  void Find();
  /// Passes a connection to the daemon, which is started if it does not run.
  void Pass(PassedSocket passed);
  /// Passes a connection only if the daemon runs. False: it does not.
  bool PassNow(const PassedSocket& passed);
  /// Starts the daemon if it does not run.
  void Wake();
  /// Ends the daemon in order. Its run is recorded; the next Wake() continues it.
  void PutAside();
  /// PutAside(), and nothing starts it again.
  void Close();
  /// Ends the daemon; the next Wake() begins `lesson`, and not where this run was.
  void BeginAnew(const std::string& lesson);
  /// `peer`, who has shown the PIN, may use the seat's own ports from its machine.
  void Admit(const std::string& peer);
  int port() const { return plan_.port; }
  /// The teacher drives, or the student does again.
  void SetTaken(bool taken);
  bool taken() const { return taken_; }
  /// Removes the oldest recordings beyond the disk's share, but not the one from which the seat continues.
  void TidyRuns() const;
  /// It sleeps, or is about to: it starts again when somebody comes.
  bool put_aside() const { return !wanted_ && (state_ == SeatState::kAsleep || ends_); }
  const std::string& lesson() const { return plan_.lesson; }

 private:
  using Descriptor = boost::asio::posix::stream_descriptor;

  void Start();
  std::vector<std::string> Arguments();
  void AwaitDoor();
  /// Uses a connection to the daemon's door.
  void Enter(UniqueFd door);
  void OnDeath();
  void KillIfItStays();
  void SendWaiting();
  void SetState(SeatState state, const std::string& trouble);
  std::filesystem::path door_path() const { return folder_ / "door"; }

  boost::asio::io_context& context_;
  const std::string name_;
  const std::filesystem::path folder_;
  const std::string url_;
  SeatPlan plan_;
  const Clock& clock_;
  const Logger logger_;
  std::function<void()> on_change_;

  SeatState state_ = SeatState::kAsleep;
  std::string trouble_;
  pid_t process_ = 0;  // 0: none
  std::unique_ptr<Descriptor> door_;
  boost::asio::steady_timer timer_, patience_;
  Nanoseconds started_ = 0;
  std::deque<PassedSocket> waiting_;
  std::deque<Nanoseconds> deaths_;  // of late
  bool ends_ = false;               // we have told the daemon to end
  bool wanted_ = false;             // it is to start again when it has ended
  bool anew_ = false;               // the next start does not continue the newest run
  bool taken_ = false;
  bool closed_ = false;
  std::map<std::string, std::string> admitted_;  // by NetworkOf(): the peer that showed the PIN
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

/// The number of the newest recording in `folder` (000001.run, …); 0: there is none.
int NewestRun(const std::filesystem::path& folder);
/// Its file's name.
std::string RunFileName(int number);
/// Bytes of a file, or of all files in a folder; 0 if there is none.
std::uintmax_t SizeOf(const std::filesystem::path& path);
/// The number of entries directly in a folder.
std::size_t CountIn(const std::filesystem::path& folder);

}  // namespace coopdyn
