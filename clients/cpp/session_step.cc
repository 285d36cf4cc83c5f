// SPDX-License-Identifier: MIT
// Steps: sends the commands, collects the replies, and recovers from missing ones.
#include <algorithm>
#include <exception>
#include <iomanip>
#include <iostream>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr double kCatchUpAfter_s = 0.1;  // of silence before CatchUp()
constexpr double kHeldUp_s =
    0.5;  // lockstep waits for its robots before every step; shorter waits are not reported
constexpr std::size_t kNamedRobots = 4;
/// More than kFew replies are not read one by one as they arrive: a step waits for the reply kAtOnce places
/// ahead, at most kGlance_s, so that it notices errors and closed connections, too.
constexpr std::size_t kFew = 8, kAtOnce = 256;
constexpr double kGlance_s = 0.01;

constexpr auto IsDone = [](const auto& waiting) { return waiting.done; };

}  // namespace

/// Returns the connections that step, ready for a request. Sends the commands of robots `beside` that await
/// no reply.
std::vector<Session::Waiting> Session::WhoSteps(const TeamRequest& command) {
  std::vector<Waiting> waiting, of_teams;
  for (const auto& link : links_) link->unstepped = 0;
  if (!watch_) {
    for (const auto& team : teams_) {
      try {
        team->Settle();
        of_teams.push_back({&team->connection, nullptr, team.get()});
      } catch (const Error&) {
        // Other teams continue without a team that is lost, or whose robots another client got after a load.
        if (team.get() == command.team || (!team->lost && !team->names.empty())) throw;
      }
    }
    std::erase_if(teams_, [](const auto& team) { return team->lost.has_value(); });
    for (const auto& link : links_) {
      if (!link->beside && link->TakesPart()) waiting.push_back({link->motors.get(), link.get()});
    }
    const bool others = !waiting.empty() || !of_teams.empty();
    for (const auto& link : links_) {
      if (!link->beside || (others && !link->IsFree()) || !link->TakesPart()) continue;
      link->beside = others;  // without others, this robot makes the step
      if (!others) waiting.push_back({link->motors.get(), link.get()});
      if (!others || !link->kept) continue;
      try {
        link->SendStep(1);
      } catch (const Closed& e) {
        link->Lose(e);
      }
    }
    waiting.insert(waiting.end(), of_teams.begin(), of_teams.end());
  }
  if (waiting.empty()) waiting.push_back({&Of(kSimulation)});
  return waiting;
}

void Session::Step(int n, double timeout_s, const TeamRequest& team_request) {
  RequireOpen();
  if (n > 1 && std::any_of(links_.begin(), links_.end(),
                           [](const auto& link) { return link->has_parts() && link->kept; })) {
    const Deadline deadline = After(timeout_s);
    Step(1, timeout_s);  // such a command lasts one step
    return Step(n - 1, std::max(0.0, SecondsUntil(deadline)));
  }
  std::vector<Waiting> waiting = WhoSteps(team_request);
  const std::int64_t since = reached_ + 1;
  Replies replies;
  try {
    for (Waiting& w : waiting) {
      if (w.team != nullptr && w.team == team_request.team) {
        w.connection->Send(command::kStepAll, {}, team_request.values, team_request.text);
        continue;
      }
      if (w.link != nullptr) {
        w.link->SendStep(n);
      } else {
        w.connection->Send(command::kReady, {n});
      }
    }
    replies = Collect(waiting, timeout_s);
  } catch (const Error& e) {
    GiveUp(waiting, e);
    throw;
  }
  Resume(replies.earliest, since);
}

/// Stores a reply; throws an error reply.
void Session::StoreReply(Waiting& w, Message reply, Replies& replies) {
  w.done = true;
  if (w.link != nullptr) w.link->sent.reset();
  if (reply.error != 0) {
    if (w.team != nullptr) w.team->stale = true;  // it may have lost a robot
    const std::string who = w.team != nullptr ? w.team->label() : w.link != nullptr ? w.link->robot : "";
    Checked(reply, who.empty() ? who : who + ": ");
  }
  Note(reply);
  replies.earliest = std::min(replies.earliest, steps_);
  if (w.team != nullptr) {
    w.team->reply = std::move(reply);
    return;
  }
  if (w.link != nullptr && !w.link->attached.empty() && !reply.params.empty() && reply.params[0] == 1)
    w.link->carried = reply;
  replies.last = std::move(reply);
}

/// Stores the replies that have arrived: `all` of them, or those before the first pending one. Sets `missing`
/// to the descriptors of pending replies. Returns whether any reply has arrived.
bool Session::StoreReplies(std::vector<Waiting>& waiting, bool all, std::vector<int>& missing,
                           Replies& replies) {
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
    StoreReply(w, std::move(*reply), replies);
  }
  return any;
}

/// Collects the replies of all connections in `waiting`. Throws the first error.
Session::Replies Session::Collect(std::vector<Waiting>& waiting, double timeout_s) {
  const Deadline start = Clock::now();
  Replies replies{{}, std::numeric_limits<std::int64_t>::max()};
  const Deadline deadline = After(timeout_s, start);
  Deadline notice_at = After(kNoticeAfter_s, start), catch_up_at = Deadline::max();
  const bool any_beside = std::any_of(links_.begin(), links_.end(), [](auto& link) { return link->beside; });
  if (any_beside) catch_up_at = After(kCatchUpAfter_s, start);  // one may be a participant by now
  const bool drives = waiting.front().link != nullptr || waiting.front().team != nullptr;
  std::vector<int> missing;
  /// True if the reply kAtOnce places ahead has arrived.
  const auto glance = [&](const auto& fd_at, std::size_t count) {
    return WaitReadable({fd_at(std::min(count, kAtOnce) - 1)}, std::min(kGlance_s, timeout_s));
  };
  // The last request triggered the step: its reply arrives first.
  bool all = waiting.size() <= kFew ||
             !glance([&](std::size_t i) { return waiting[i].connection->fd(); }, waiting.size() - 1);
  polling()->Start(Clock::now());
  while (true) {
    const bool any = StoreReplies(waiting, all, missing, replies);
    const Deadline now = Clock::now();
    const bool polls = polling_.ShouldPollAgain(now);
    if (missing.empty()) return replies;
    if (any) catch_up_at = After(kCatchUpAfter_s, now);
    if (!std::exchange(all, true) && !any) continue;
    if (polls) continue;
    if (now >= deadline)
      throw Error(kTimedOut, "no answer within " + Written(timeout_s) + " s; " + DescribeWait(false, drives));
    if (now >= notice_at) {
      notice_at = Deadline::max();
      std::cerr << "coopdyn: " << DescribeWait(false, drives) << std::endl;
    }
    if (now >= catch_up_at) {
      catch_up_at = After(kCatchUpAfter_s, now);
      CatchUp(waiting);
      if (std::all_of(waiting.begin(), waiting.end(), IsDone)) {
        replies.earliest = std::min(replies.earliest, steps_);
        return replies;
      }
    }
    if (any && missing.size() > kFew) {
      all = !glance([&](std::size_t i) { return missing[i]; }, missing.size());
    } else {
      WaitReadable(missing,
                   SecondsUntil(std::min({deadline, notice_at, catch_up_at, After(3600, now)}), now));
    }
  }
}

/// Resolves a deadlock: after an error or timeout, an old command may still run while its successor is on the
/// way. Its robot is then one step behind the others, and both would wait for each other forever. If the
/// status says that the world waits for robots of ours that have stepped already, steps these once more with
/// their present commands. If it also waits for a robot whose reply is pending, that reply will arrive: does
/// nothing. Sets robots that are no participants (among the first that the status lists) `beside`, because
/// their commands may have arrived after the others' step and then run in the next.
void Session::CatchUp(std::vector<Waiting>& waiting) {
  std::set<std::string> awaited;
  const Json status = FreshStatus();
  for (const Json& a : status["awaiting"].items()) awaited.insert(a["robot"].text());
  /// For a robot with several actuators the status names ROBOT/MODULE; its channel drives them all.
  const auto is_awaited = [&](const Waiting& w) {
    return std::any_of(awaited.begin(), awaited.end(), [&](const std::string& name) {
      const std::string robot = name.substr(0, name.find('/'));
      if (w.link != nullptr)
        return robot == w.link->robot &&
               (robot == name || w.link->type == kChannel || name == robot + "/" + w.link->actuator);
      return w.team != nullptr && w.team->playing.empty() && w.team->Has(robot);
    });
  };
  const std::int64_t before = reached_;
  std::vector<RobotLink*> joining;
  for (const auto& link : links_) {
    if (link->beside && link->IsFree() && is_awaited({link->motors.get(), link.get()}))
      joining.push_back(link.get());
  }
  const bool has_stepped = reached_ > before || std::any_of(waiting.begin(), waiting.end(), IsDone);
  for (const Json& robot : status["robots"].items()) {
    const Json& participates = robot["participates"];
    if (!has_stepped || participates.is_null() || participates.boolean()) continue;
    for (const auto& link : links_) link->beside |= link->motors && link->robot == robot["name"].text();
  }
  std::erase_if(waiting,
                [](const Waiting& w) { return w.link != nullptr && w.link->beside && w.link->sent; });
  for (RobotLink* link : joining) {
    link->beside = false;
    if (has_stepped) continue;
    waiting.push_back({link->motors.get(), link});
    link->SendStep(1);
  }
  if (std::all_of(waiting.begin(), waiting.end(), IsDone)) return;
  if (std::any_of(waiting.begin(), waiting.end(), [&](auto& w) { return !w.done && is_awaited(w); })) return;
  std::size_t stepped = 0;
  for (const Waiting& w : waiting) {
    if (w.done) stepped += w.team != nullptr ? w.team->names.size() : 1;
  }
  const auto listed = static_cast<double>(std::max(stepped, awaited.size()));  // the status lists some
  if (status["awaiting_count"].number() > listed) return;
  for (Waiting& w : waiting) {
    if (!w.done || !is_awaited(w)) continue;
    w.done = false;
    if (w.team != nullptr) {
      w.connection->Send(command::kStepAll);
    } else {
      w.connection->Send(command::kReady, {1});
    }
  }
}

/// Queries the status on a separate connection, because the others may have replies pending.
Json Session::FreshStatus() const {
  Connection connection(address_, "/simulation", false);
  connection.Open();
  return Json::Parse(
      connection.Ask({.command = command::kGetStatus, .timeout_s = address_.timeout_s()}).text);
}

/// Closes and reopens connections whose reply is pending: otherwise the late reply would be mistaken for the
/// next one. Throws a more specific error than `cause` if it finds one. @pre `cause` is being caught
void Session::GiveUp(std::vector<Waiting>& waiting, const Error& cause) {
  const std::exception_ptr thrown = std::current_exception();
  const auto* closed = dynamic_cast<const Closed*>(&cause);
  std::exception_ptr lost;
  for (Waiting& w : waiting) {
    if (w.done) continue;
    const bool gone = !w.connection->is_open();
    w.connection->Close();
    if (w.link != nullptr) w.link->ForgetCommands();
    if (!gone || closed == nullptr) continue;
    try {
      if (w.team != nullptr) w.team->Lose(*closed);
      if (w.link != nullptr) w.link->Lose(*closed);
    } catch (const Error&) {
      lost = std::current_exception();
    }
  }
  for (Waiting& w : waiting) {
    if (w.done) continue;
    try {
      if (w.team != nullptr && !w.team->lost) w.team->Open();
      if (w.link != nullptr && !w.link->lost) w.link->OpenMotors();
    } catch (const Error&) {
      // The next use tries again, and reports the error.
    }
  }
  try {
    std::rethrow_exception(lost ? lost : thrown);
  } catch (const WorldReset& e) {
    if (e.text() == "reset" || e.text() == kLoad) throw NewWorld(e.text());
    throw;
  } catch (const Error& e) {
    if (std::any_of(teams_.begin(), teams_.end(), [](const auto& team) { return team->stale; }))
      ThrowIfLoaded(e);
  }
  for (const auto& team : teams_) {
    if (!team->stale || team->lost) continue;
    try {
      team->Settle();
    } catch (const Error&) {
      if (team->lost) lost = std::current_exception();  // otherwise its next use reports the error
    }
  }
  if (lost) std::rethrow_exception(lost);
}

std::string Session::DescribeWait(bool held_up, bool in_step) const {
  Json status;
  try {
    status = FreshStatus();
  } catch (const Error& e) {
    return std::string("no answer from the daemon (") + e.what() + ")";
  }
  if (in_step && !watch_ && IsNew(status)) throw WorldReset("reset");  // GiveUp() completes the text
  const std::string& state = status["state"].text();
  const Json& playback = status["playback"];
  if (!playback.is_null() && playback["step"].number() == playback["end_step"].number() &&
      !playback["playing"].boolean() && !playback["growing"].boolean())
    return "the recording has ended; sim.run() plays it again";
  if (state == "paused") return "the simulation is paused; continue with sim.run() or on the page";
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
  const auto all =
      std::max(static_cast<std::int64_t>(awaiting.size()), Whole(status["awaiting_count"].number()));
  if (all > static_cast<std::int64_t>(named))
    out << " and " << all - static_cast<std::int64_t>(named) << " more";
  for (const Json& a : awaiting) {
    if (a["cure"].is_null()) continue;
    out << ": " << a["cure"].text();  // how to continue without this robot
    break;
  }
  return out.str();
}

}  // namespace coopdyn::client
