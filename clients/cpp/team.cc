// SPDX-License-Identifier: MIT
#include "clients/cpp/team.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

#include "clients/cpp/error.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr int kWrongParams = 2;
constexpr const char* kReadings[] = {"pose",   "distances", "targets", "neighbours",
                                     "wheels", "compass",   "support", "joints"};
constexpr const char* kReadingWords =
    "pose, distances, targets, neighbours, wheels, compass, support, joints, and sensors' modules by name";
constexpr const char* kCommands[] = {"velocities",       "wheels",           "positions",
                                     "positions_direct", "joint_velocities", "efforts"};
constexpr const char* kCommandWords =
    "velocities, wheels, positions, positions_direct, joint_velocities, efforts";

Rows TeamReading::*RowsOf(const std::string& name) {
  static constexpr Rows TeamReading::*kRows[] = {
      &TeamReading::pose,   &TeamReading::distances, &TeamReading::targets, &TeamReading::neighbours,
      &TeamReading::wheels, &TeamReading::compass,   &TeamReading::support, &TeamReading::joints};
  const auto* found = std::find(std::begin(kReadings), std::end(kReadings), name);
  return found == std::end(kReadings) ? nullptr : kRows[found - kReadings];
}

/// Throws Error 3 or 4 unless there are two finite numbers per robot, or two for all.
void CheckSpeeds(std::span<const double> values, const std::vector<std::string>& names, const char* what,
                 const char* columns) {
  const std::size_t n = names.size();
  if (values.size() != 2 && values.size() != 2 * n) {
    std::ostringstream why;
    why << what << " has " << values.size() << " numbers, the team has " << n << " robots; write 2 x " << n
        << ", " << columns << " of each robot, or 2 for all";
    throw Error(3, why.str());
  }
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (bad == values.end()) return;
  const auto row = static_cast<std::size_t>(bad - values.begin()) / 2;
  std::ostringstream why;
  if (values.size() == 2 * n) {
    why << "row " << row << " of " << what << " (" << names[row] << ")";
  } else {
    why << what;
  }
  why << " must be finite, not " << values[2 * row] << ", " << values[2 * row + 1];
  throw Error(4, why.str());
}

[[noreturn]] void SayWhoIsGone(const TeamLink& team, const char* what) {
  constexpr std::size_t kNamed = 4;
  std::ostringstream why;
  why << team.label() << " has lost ";
  for (std::size_t i = 0; i < team.gone.size() && i < kNamed; ++i) why << (i > 0 ? ", " : "") << team.gone[i];
  if (team.gone.size() > kNamed) why << " and " << team.gone.size() - kNamed << " more";
  why << ": " << what << " must have " << team.names.size()
      << " rows now, in the order of team.names, or one row for all";
  throw Error(3, why.str());
}

std::size_t WidthOf(const TeamCommand& command) {
  std::size_t width = 0;
  for (const std::vector<double>& row : command.rows) width = std::max(width, row.size());
  return width;
}

/// Throws Error 3 or 4 unless there is one row per robot, or one for all, without inf.
void CheckRows(const TeamCommand& command, const TeamLink& team) {
  const std::size_t n = team.names.size(), count = command.rows.size();
  if (!team.gone.empty() && count != 1 && count != n) SayWhoIsGone(team, command.name.c_str());
  if ((count != 1 && count != n) || WidthOf(command) == 0) {
    throw Error(3, command.name + " has " + std::to_string(count) + " rows of up to " +
                       std::to_string(WidthOf(command)) + ", the team has " + std::to_string(n) +
                       " robots; write a row for each robot, or one for all");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (std::none_of(command.rows[i].begin(), command.rows[i].end(), [](double v) { return std::isinf(v); }))
      continue;
    throw Error(4, "row " + std::to_string(i) + " of " + command.name +
                       " must be finite, or nan: this joint keeps its command");
  }
}

}  // namespace

void Rows::NoSuchRow(std::size_t i) const {
  throw Error(4, rows_ == 0 ? "this reading was not chosen; write e.g. team.select({\"pose\", \"targets\"})"
                            : "there is no row " + std::to_string(i) + " of " + std::to_string(rows_));
}

Team::Team(std::shared_ptr<Session> session, std::shared_ptr<TeamLink> link)
    : session_(std::move(session)), link_(std::move(link)) {}

std::size_t Team::n() const {
  return link_->names.size();
}

const std::vector<std::string>& Team::names() const {
  return link_->names;
}

const std::vector<std::int32_t>& Team::ids() const {
  return link_->ids;
}

TeamReading Team::step(std::span<const double> V, double timeout) {
  return Step(V, "V", "forward and turn", "", timeout);
}

TeamReading Team::step_wheels(std::span<const double> W, double timeout) {
  return Step(W, "W", "left and right", "wheels", timeout);
}

TeamReading Team::Step(std::span<const double> values, const char* what, const char* columns,
                       const char* text, double timeout) {
  std::vector<double> for_all;
  const auto rows = [&]() -> std::span<const double> {
    if (values.empty() && *text == '\0') return values;  // they keep their speeds
    if (!link_->gone.empty() && values.size() != 2 && values.size() != 2 * n()) SayWhoIsGone(*link_, what);
    CheckSpeeds(values, link_->names, what, columns);
    if (values.size() != 2 || n() <= 1) return values;
    for_all.resize(2 * n());
    for (std::size_t i = 0; i < for_all.size(); ++i) for_all[i] = values[i % 2];
    return for_all;
  };
  return Step(rows, text, values.empty() && *text == '\0', timeout);
}

TeamReading Team::step(std::initializer_list<TeamCommand> commands, double timeout) {
  std::string text;
  for (const TeamCommand& command : commands) {
    const std::string kind = command.name.substr(0, command.name.find('/'));
    if (std::find(std::begin(kCommands), std::end(kCommands), kind) == std::end(kCommands))
      throw Error(4, "there is no command '" + command.name + "'; there are: " + kCommandWords +
                         "; of one group of joints: positions/arm");
    text += (text.empty() ? "" : " ") + command.name;
  }
  std::vector<double> all;
  const auto rows = [&]() -> std::span<const double> {
    all.clear();
    for (const TeamCommand& command : commands) CheckRows(command, *link_);
    for (std::size_t i = 0; i < n(); ++i) {
      for (const TeamCommand& command : commands) {
        const std::vector<double>& row = command.rows[command.rows.size() == 1 ? 0 : i];
        all.insert(all.end(), row.begin(), row.end());
        all.insert(all.end(), WidthOf(command) - row.size(), std::numeric_limits<double>::quiet_NaN());
      }
    }
    return all;
  };
  return Step(rows, text, commands.size() == 0, timeout);
}

TeamReading Team::Step(const std::function<std::span<const double>()>& rows, const std::string& text,
                       bool reads, double timeout) {
  link_->Settle();
  if (!link_->playing.empty()) {
    rows();  // throws first if the rows are invalid
    try {
      link_->Own();
    } catch (const Error& e) {
      if (link_->playing.empty() || !reads) throw;
      session_->Step(1, timeout);  // to the playback's next step
      return read();
    }
  }
  const std::size_t before = n();
  auto kept = session_->Kept();
  try {
    session_->Step(1, timeout, {link_.get(), text, rows()});
  } catch (const Error& e) {
    const bool smaller = e.code() == 3 && e.text().find("no longer in the team") != std::string::npos &&
                         !link_->lost && n() != before;
    if (!smaller) throw;
    session_->Keep(std::move(kept));  // the step did not run
    session_->Step(1, timeout, {link_.get(), text, rows()});
  }
  link_->gone.clear();
  return ToReading(std::move(*std::exchange(link_->reply, std::nullopt)));
}

TeamReading Team::read() {
  return ToReading(link_->Read());
}

TeamReading Team::ToReading(Message reply, int tries_left) {
  TeamLink& link = *link_;
  Require(reply, 2, 0);
  const auto rows = static_cast<std::size_t>(std::max(0, reply.params[reply.params.size() - 2]));
  const auto stride = static_cast<std::size_t>(std::max(0, reply.params.back()));
  const auto fits = [&] {
    return rows == link.names.size() &&
           stride == std::accumulate(link.columns.begin(), link.columns.end(), std::size_t{0});
  };
  if (!fits()) link.Refresh();
  if (!fits()) {  // the team has changed again meanwhile
    if (tries_left == 0)
      throw Error(7, "the replies of the daemon do not say which robots are in " + link.label());
    return ToReading(link.Read(), tries_left - 1);
  }
  if (reply.data.size() != rows * stride + 2) throw Error(7, "a reply of the daemon has too few values");

  TeamReading reading;
  reading.time = TimeOf(reply);
  reading.step = StepOf(reply);
  reading.text = std::move(reply.text);
  auto values = std::make_shared<const std::vector<double>>(std::move(reply.data));
  const double* first = values->data();
  for (std::size_t i = 0; i < link.readings.size(); ++i) {
    const std::size_t count = link.columns[i];
    Rows TeamReading::*const member = RowsOf(link.readings[i]);
    (member != nullptr ? reading.*member : reading.modules[link.readings[i]]) =
        Rows(first, rows, count, stride);
    first += count;
  }
  reading.values = std::move(values);
  return reading;
}

void Team::select(const std::vector<std::string>& readings, int neighbours) {
  const std::string words = Join(readings, " ");
  if (words.empty()) throw Error(3, std::string("nothing was chosen; there are: ") + kReadingWords);
  if (neighbours < 1) throw Error(4, "neighbours must be at least 1");
  link_->Settle();
  try {
    link_->Select(words, neighbours);
  } catch (const Error& e) {
    if (e.code() != kWrongParams) throw;
    throw Error(4, e.text() + "; there are: " + kReadingWords);
  }
}

void Team::stop() {
  link_->Own();
  link_->Ask(command::kStopTeam);
}

void Team::release() {
  session_->CloseTeam(*link_, false);
}

void Team::close() {
  session_->CloseTeam(*link_, true);
}

}  // namespace coopdyn::client
