// SPDX-License-Identifier: MIT
// A class: its list, a seat for each student, what students ask for and what the teacher does. Knows nothing
// of HTTP. One thread, that of the io_context.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/json.hpp>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/host/program.h"
#include "server/host/roll.h"
#include "server/host/seat.h"
#include "server/host/seat_call.h"

namespace coopdyn {

struct ClassOptions {
  std::filesystem::path folder;      // of all that the class keeps
  std::vector<std::string> lessons;  // scenarios, in the order of the lesson plan; at least one
  SeatPlan plan = {};                // its lesson is set from `lessons`
  ProgramPlan programs = {};         // that students write in their pages
  Nanoseconds idle = 15 * 60 * kNanosecondsPerSecond;  // a seat where nothing happens is put aside; 0: never
};

/// What a student's page shows and the wall knows besides the daemon's status.
struct Desk {
  struct Note {
    std::string time;  // "14:05"
    std::string text;
  };
  Nanoseconds hand_since = 0;  // 0: the hand is down
  bool frozen = false;
  std::vector<Note> notes = {};     // from the teacher, oldest first
  std::string language = {};        // of the student's program, as it said: "python"
  Nanoseconds active = 0;           // when the student last did something
  Nanoseconds answered = 0;         // when the daemon last said how it is, or did not run
  boost::json::object status = {};  // of the daemon, in brief; empty: none yet
  std::string last_error = {};      // of the student's run
  Nanoseconds error_at = 0;
  std::string refused = {};  // what the daemon answered to the teacher's last order; empty: it was done
  Nanoseconds refused_at = 0;
  std::vector<Nanoseconds> resets = {};  // of late
  std::int64_t last_step = 0;
  Nanoseconds recording_tried = 0;  // when the host last began a recording that had ended
};

class ClassRoom {
 public:
  static constexpr std::size_t kMaxNotes = 50, kMaxNoteBytes = 2000, kMaxHandIns = 200;
  /// Not even a busy daemon takes so long to say how it is.
  static constexpr Nanoseconds kSilent = 30 * kNanosecondsPerSecond;
  /// A student who is connected and does nothing for this long may need help.
  static constexpr Nanoseconds kStuck = 5 * 60 * kNanosecondsPerSecond;
  /// As many resets within kResetWindow are a loop.
  static constexpr std::size_t kResets = 5;
  static constexpr Nanoseconds kResetWindow = 60 * kNanosecondsPerSecond;

  ClassRoom(boost::asio::io_context& context, ClassOptions options, Roll roll, const Clock& clock,
            Logger logger);
  ~ClassRoom();
  ClassRoom(const ClassRoom&) = delete;
  ClassRoom& operator=(const ClassRoom&) = delete;

  /// Takes back the daemons that run and begins to look after all of them. `url`: of the host's pages, with
  /// its last '/'. Once, before everything below.
  void Open(const std::string& url);
  /// Puts all seats aside; `done` is called when their daemons have ended.
  void PutAllAside(std::function<void()> done);
  /// The port for programs, which students' pages tell.
  void set_names_port(int port) { names_port_ = port; }

  const Roll& roll() const { return roll_; }
  const ClassOptions& options() const { return options_; }
  const std::string& url() const { return url_; }
  /// Null: no such seat.
  Seat* FindSeat(std::string_view name);
  /// The seat whose personal link ends with `link`; null: none.
  const RollEntry* FindLink(std::string_view link) const;
  /// What the student has written in the page; null: no such seat.
  Program* FindProgram(std::string_view seat);
  std::filesystem::path folder_of(const std::string& seat) const;

  /// Uses another class list: seats that are not in it any more are put aside.
  void SetRoll(Roll roll);

  // What a student does.
  /// `peer` has shown the PIN or the link.
  void NoteActive(const std::string& seat, const std::string& peer, const std::string& language = {});
  void RaiseHand(const std::string& seat, bool up);
  /// Keeps program and recording of the seat in a folder of their own. `done`: an error text.
  void HandIn(const std::string& seat, std::function<void(std::string error)> done);

  // What the teacher does; an error text, empty if it is done.
  std::string Do(const boost::json::object& order);

  /// What a student's page shows of the seat.
  boost::json::object StudentJson(const std::string& seat) const;
  /// What the wall shows: all seats, those that need help first.
  boost::json::object WallJson() const;
  /// A number that changes when StudentJson() or WallJson() may have changed.
  std::uint64_t version() const { return version_; }

 private:
  struct Place {
    std::unique_ptr<Seat> seat;
    std::unique_ptr<Program> program;
    Desk desk;
    bool asking = false;    // for the status
    bool hands_in = false;  // the daemon ends the recording for it
  };
  struct Need {
    int rank = 0;  // 0: none; higher first
    std::string why;
  };

  void AddSeat(const RollEntry& entry);
  /// The program of a seat has connected to its simulation.
  void ConnectProgram(const std::string& seat, UniqueFd connection);
  /// Puts aside what still runs of students who left the list while no host ran.
  void EndStrays();
  /// Seats for those of the list who have none yet.
  void AddMissing();
  void Tick();
  void AskStatus(const std::string& name, Place& place);
  void TakeStatus(Place& place, const std::string& body);
  void PutIdleAside(Place& place);
  Need NeedOf(const Place& place) const;
  void Order(const std::string& name, Place& place, const boost::json::object& order);
  /// A request to a module of the seat's daemon, if that runs.
  void Command(Place& place, const std::string& module, const std::string& command,
               const std::string& text = {});
  /// `lesson` as the command line takes it; `text`: the same as a text or a bare name, or empty.
  void Push(Place& place, const std::string& lesson, const std::string& text);
  /// The file in which a pushed text is kept; a bare name stays. Empty: it cannot be written.
  std::string KeepLesson(const std::string& text) const;
  void Changed() { ++version_; }
  void SaveDesk(const std::string& name, const Desk& desk) const;
  void LoadDesk(const std::string& name, Desk& desk) const;

  boost::asio::io_context& context_;
  const ClassOptions options_;
  std::string url_;
  Roll roll_;
  const Clock& clock_;
  const Logger logger_;
  std::map<std::string, Place, std::less<>> places_;
  std::map<std::string, std::unique_ptr<Seat>> leaving_;  // of students who are not in the list any more
  std::size_t lesson_ = 0;                                // of options_.lessons
  boost::asio::steady_timer timer_;
  std::uint64_t version_ = 1, ticks_ = 0;
  int names_port_ = 0;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace coopdyn
