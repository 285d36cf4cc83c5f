// SPDX-License-Identifier: MIT
// Waiting for the replies of a step, and what happens when one of them does not come.
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/session.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr double kCatchUpAfter_s = 0.1;  // some robots have stepped and others have not: see CatchUp()
constexpr double kHeldUp_s =
    0.5;  // lockstep awaits its robots before every step; a shorter wait holds nobody up
constexpr std::size_t kNamedRobots = 4;
/// More replies than kFew are not read one by one as they come in: a step waits for the one that is kAtOnce
/// further on, for kGlance_s at most, so that it sees errors and closed connections, too.
constexpr std::size_t kFew = 8, kAtOnce = 256;
constexpr double kGlance_s = 0.01;

}  // namespace

std::string Session::Label(const Waiting& w) {
  if (w.team != nullptr) return w.team->label() + ": ";
  return w.link != nullptr ? w.link->robot + ": " : "";
}

/// Takes in a reply; an error reply is thrown.
void Session::TakeIn(Waiting& w, Message reply, Message& last) {
  w.done = true;
  if (reply.error != 0) {
    if (w.team != nullptr) w.team->stale = true;  // a robot may have been taken from it
    Checked(reply, Label(w));
  }
  Note(reply);
  earliest_ = std::min(earliest_, steps_);
  if (w.team != nullptr) {
    w.team->reply = std::move(reply);
    return;
  }
  last = reply;
  if (w.link != nullptr && !w.link->attached.empty() && !reply.params.empty() && reply.params[0] == 1)
    w.link->carried = std::move(reply);
}

/// Takes in the replies that have come, up to the first that has not, or of `all`. `missing`
/// becomes the descriptors that still wait. Returns whether any has come.
bool Session::TakeAllIn(std::vector<Waiting>& waiting, bool all, std::vector<int>& missing, Message& last) {
  bool any = false;
  missing.clear();
  for (Waiting& w : waiting) {
    if (w.done) continue;
    std::optional<Message> reply;
    if (all || missing.empty()) reply = w.connection->TryRead();
    if (!reply) {
      missing.push_back(w.connection->fd());
      continue;
    }
    any = true;
    TakeIn(w, std::move(*reply), last);
  }
  return any;
}

/// Takes in the reply of every connection in `waiting` and returns the last. The first error is thrown.
Message Session::Collect(std::vector<Waiting>& waiting, double timeout_s) {
  const Deadline start = Clock::now();
  earliest_ = std::numeric_limits<std::int64_t>::max();
  const Deadline spin_until = After(spin_s(), start), deadline = After(timeout_s, start);
  Deadline notice_at = After(kNoticeAfter_s, start), catch_up_at = Deadline::max();
  Message last;
  std::vector<int> missing;
  /// True if the one that is kAtOnce further on has come.
  const auto glance = [&](const auto& fd_at, std::size_t count) {
    return WaitReadable({fd_at(std::min(count, kAtOnce) - 1)}, std::min(kGlance_s, timeout_s));
  };
  // The request of the last set off the step: its reply comes first.
  bool all = waiting.size() <= kFew ||
             !glance([&](std::size_t i) { return waiting[i].connection->fd(); }, waiting.size() - 1);
  while (true) {
    const bool any = TakeAllIn(waiting, all, missing, last);
    if (missing.empty()) return last;
    const Deadline now = Clock::now();
    if (any) catch_up_at = After(kCatchUpAfter_s, now);
    if (!std::exchange(all, true) && !any) continue;
    if (now < spin_until) continue;
    if (now >= deadline) {
      std::ostringstream why;
      why << "no answer within " << timeout_s << " s; " << Whom();
      throw Error(11, why.str());
    }
    if (now >= notice_at) {
      notice_at = Deadline::max();
      std::cerr << "coopdyn: " << Whom() << std::endl;
    }
    if (now >= catch_up_at) {
      catch_up_at = After(kCatchUpAfter_s, now);
      CatchUp(waiting);
    }
    if (any && missing.size() > kFew) {
      all = !glance([&](std::size_t i) { return missing[i]; }, missing.size());
    } else {
      WaitReadable(missing, Until(std::min({deadline, notice_at, catch_up_at, After(3600, now)}), now));
    }
  }
}

/// After an error or a timeout a command that had not run may still run while its successor is on the way:
/// its robot is then one step behind the others, and each would wait for the other for ever. The world says
/// whether it waits for robots of ours that have stepped already: these go on by one step with what they
/// have. If it waits for one whose reply has not come, too, then that reply is on its way.
void Session::CatchUp(std::vector<Waiting>& waiting) {
  std::set<std::string> awaited;
  const Json status = FreshStatus();
  for (const Json& a : status["awaiting"].items()) awaited.insert(a["robot"].text());
  const auto is_awaited = [&](const Waiting& w) {
    if (w.link != nullptr) return awaited.contains(w.link->robot);
    return w.team != nullptr && w.team->playing.empty() &&
           std::any_of(w.team->names.begin(), w.team->names.end(),
                       [&](const std::string& name) { return awaited.contains(name); });
  };
  if (std::any_of(waiting.begin(), waiting.end(), [&](auto& w) { return !w.done && is_awaited(w); })) return;
  std::size_t stepped = 0;
  for (const Waiting& w : waiting) {
    if (w.done) stepped += w.team != nullptr ? w.team->names.size() : 1;
  }
  const auto listed = static_cast<double>(std::max(stepped, awaited.size()));  // the first of those awaited
  if (status["awaiting_count"].number() > listed) return;
  for (Waiting& w : waiting) {
    if (!w.done || !is_awaited(w)) continue;
    w.done = false;
    if (w.team != nullptr) {
      w.connection->Send(command::kStepAll, {}, {});
    } else {
      w.connection->Send(command::kReady, {1}, {});
    }
  }
}

/// The status, asked on a connection of its own: others may be waiting.
Json Session::FreshStatus() const {
  Connection connection(address_, "/simulation", false);
  connection.Open();
  return Json::Parse(connection.Request(command::kGetStatus, {}, {}, "", address_.timeout_s()).text);
}

/// Connections that still wait for a reply are closed and opened again: reading on would take the next reply
/// for the one that is missing. Throws what happened, if it is more than the cause.
void Session::GiveUp(std::vector<Waiting>& waiting, const std::exception_ptr& cause) {
  std::exception_ptr lost;
  for (Waiting& w : waiting) {
    if (w.done) continue;
    const bool gone = !w.connection->is_open();
    w.connection->Close();
    if (w.link != nullptr) w.link->ForgetCommands();
    if (!gone || (w.link == nullptr && w.team == nullptr)) continue;
    try {
      std::rethrow_exception(cause);
    } catch (const Closed& closed) {
      try {
        if (w.team != nullptr) Lose(closed, w.team->label(), w.team->TakeAgain(), w.team->lost);
        Lose(*w.link, closed);
      } catch (const Error&) {
        lost = std::current_exception();
      }
    } catch (...) {
      // Not the cause of this one.
    }
  }
  for (Waiting& w : waiting) {
    if (w.done || (w.link == nullptr && w.team == nullptr)) continue;
    try {
      if (w.team != nullptr && !w.team->lost) OpenTeam(*w.team);
      if (w.link != nullptr && !w.link->lost) OpenMotors(*w.link);
    } catch (const Error&) {
      // Tried again at the next use, which says what is wrong.
    }
  }
  try {
    std::rethrow_exception(lost ? lost : cause);
  } catch (const WorldReset& e) {
    if (e.text() == "reset" || e.text() == kLoad) throw NewWorld(e.text());
    throw;
  } catch (const Error& e) {
    if (std::any_of(teams_.begin(), teams_.end(), [](const auto& team) { return team->stale; }))
      ThrowIfLoaded(e);
  } catch (...) {
    // Something else.
  }
  for (const auto& team : teams_) {
    if (!team->stale || team->lost) continue;
    try {
      SettleTeam(*team);
    } catch (const Error&) {
      if (team->lost) lost = std::current_exception();  // otherwise its next use says what is wrong
    }
  }
  if (lost) std::rethrow_exception(lost);
}

std::string Session::Whom(bool held_up) const {
  Json status;
  try {
    status = FreshStatus();
  } catch (const Error& e) {
    return std::string("no answer from the daemon (") + e.what() + ")";
  }
  const std::string& state = status["state"].text();
  const Json& playback = status["playback"];
  if (!playback.is_null() && playback["step"].number() == playback["end_step"].number() &&
      !playback["playing"].boolean() && !playback["growing"].boolean())
    return "the recording has ended; sim.run() plays it again";
  if (state == "paused") return "the simulation is paused; sim.run() or the page goes on";
  if (state == "ended") return "the run has ended; sim.reset() starts again";
  const std::vector<Json>& awaiting = status["awaiting"].items();
  double longest_s = 0;
  for (const Json& a : awaiting) longest_s = std::max(longest_s, a["seconds"].number());
  if (held_up && longest_s < kHeldUp_s) return "";
  if (awaiting.empty()) return "waiting for the next step, " + state;
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << "waiting for ";
  const std::size_t named = std::min(awaiting.size(), kNamedRobots);
  for (std::size_t i = 0; i < named; ++i) {
    const Json& a = awaiting[i];
    out << (i > 0 ? ", " : "") << a["robot"].text() << " (" << a["why"].text() << "), "
        << a["seconds"].number() << " s";
  }
  const std::size_t all =
      std::max(awaiting.size(), static_cast<std::size_t>(std::max(0.0, status["awaiting_count"].number())));
  if (all > named) out << " and " << all - named << " more";
  for (const Json& a : awaiting) {
    if (a["cure"].is_null()) continue;
    out << ": " << a["cure"].text();  // how to go on without one of them
    break;
  }
  return out.str();
}

}  // namespace coopdyn::client
