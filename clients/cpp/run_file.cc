// SPDX-License-Identifier: MIT
#include "clients/cpp/run_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "clients/cpp/run_database.h"
#include "clients/cpp/words.h"

namespace coopdyn::client {
namespace {

constexpr std::size_t kPoseBytes = 18, kCommandBytes = 13, kChannelBytes = 9, kScoreBytes = 9;
constexpr double kPositionUnit = 1e-5;  // rad or m
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::vector<std::string> kReadings = {"distances", "targets", "channels"};

double Seconds(std::int64_t ns) {
  return static_cast<double>(ns) / 1e9;
}

/// The number of a table's last row, from `ends` of table meta: "step 1200 34, event 3 78"; 0: unknown.
std::int64_t EndOf(const std::string& table, const std::string& ends) {
  const std::size_t at = (", " + ends).find(", " + table + " ");
  return at == std::string::npos ? 0 : std::strtoll(ends.c_str() + at + table.size(), nullptr, 10);
}

/// The names in "reach, distance m", `scores` of table meta.
std::vector<std::string> ScoreNames(const std::map<std::string, std::string>& info) {
  std::vector<std::string> names;
  const auto found = info.find("scores");
  std::string rest = found == info.end() ? "" : found->second;
  for (rest += rest.empty() ? "" : ", "; !rest.empty(); rest.erase(0, rest.find(", ") + 2))
    names.push_back(rest.substr(0, rest.find_first_of(" ,")));
  return names;
}

/// The indices of a thing's values in the rows of one scene of a recording.
struct Place {
  std::size_t body = 0;
  std::int64_t robot = -1;  // number of the robot; -1: not a robot
  Pose7 X_BR{0, 0, 0, 1, 0, 0, 0};
  std::size_t first_sensor = 0, sensors = 0, first_channel = 0, channels = 0;
};
using Places = std::map<std::int64_t, Place>;  // by scene

std::size_t MostChannels(const Places& places) {
  std::size_t most = 0;
  for (const auto& [scene, place] : places) most = std::max(most, place.channels);
  return most;
}

}  // namespace

struct Run::Impl {
  explicit Impl(const std::string& file) : database(file) {
    database.ForEach("SELECT max(step) FROM step WHERE poses IS NOT NULL", [&](const RunRow& row) {
      if (row.is_null(0))
        throw Error(7,
                    file + " holds no step yet; if its daemon has ended, `coopdyn info` shows its contents");
      last = row.integer(0);
    });
    database.ForEach("SELECT key, value FROM meta",
                     [&](const RunRow& row) { info[row.text(0)] = row.text(1); });
    database.ForEach("SELECT name FROM robot GROUP BY name ORDER BY min(scene), place",
                     [&](const RunRow& row) { names.push_back(row.text(0)); });
    CheckScenes();
  }

  /// Throws Error 7 if rows are missing, as a damaged page may hide them.
  void CheckScenes() const {
    database.ForEach(
        "SELECT s.id, (SELECT count(DISTINCT robot) FROM body WHERE scene = s.id), (SELECT count(*) FROM "
        "robot "
        "WHERE scene = s.id), (SELECT count(*) FROM body WHERE scene = s.id), length(poses), (SELECT "
        "count(*) "
        "FROM channel WHERE scene = s.id), length(channels) FROM scene AS s LEFT JOIN step ON step = "
        "s.first_step",
        [&](const RunRow& row) {
          const std::int64_t bytes = 1 + static_cast<std::int64_t>(kPoseBytes) * row.count(3);
          const std::int64_t channel_bytes = static_cast<std::int64_t>(kChannelBytes) * row.count(5);
          if (row.count(1) > row.count(2) || (!row.is_null(4) && row.integer(4) != bytes) ||
              (!row.is_null(6) && row.integer(6) < channel_bytes))
            database.Damaged("robots, bodies or channels of scene " + row.text(0) + " are missing");
        });
  }

  /// Throws Error 7 if steps or poses are missing that were not lost while recording, as a damaged page may
  /// hide them. Checks once.
  void CheckSteps() const {
    if (counted) return;
    const auto given = info.find("pose_every_ns");
    const std::int64_t every = given == info.end() ? 0 : std::strtoll(given->second.c_str(), nullptr, 10);
    std::int64_t rows = 0, first = 0, previous = -1, wanted = 0;
    std::int64_t shown = -1;  // the time of the newest row with poses
    bool ends_there = true;
    database.ForEach(
        "SELECT step, time_ns, poses IS NOT NULL, (SELECT min(first_step) FROM scene), (SELECT sum(CASE key "
        "WHEN 'lost' THEN value ELSE -value END) FROM meta WHERE key IN ('lost', 'lost_after')), (SELECT "
        "value FROM meta WHERE key = 'last_step'), (SELECT value FROM meta WHERE key = 'ends') FROM step "
        "ORDER BY step",
        [&](const RunRow& row) {
          const std::int64_t step = row.integer(0), time = row.integer(1);
          const std::string number = std::to_string(step);
          if (step <= previous)
            database.Damaged("step " + number + " comes after step " + std::to_string(previous));
          const bool has_poses = row.integer(2) != 0;
          if (!has_poses && (every <= 0 || shown < 0 || time / every != shown / every))
            database.Damaged("the poses of step " + number + " are missing");
          if (rows++ == 0) first = step;
          previous = step;
          if (has_poses) shown = time;
          wanted = step - first + 1 - (row.is_null(4) ? 0 : row.integer(4));
          ends_there = (row.is_null(3) || first <= row.integer(3)) &&
                       (row.is_null(5) || step == row.integer(5)) && step >= EndOf("step", row.text(6));
        });
    if (rows < wanted || !ends_there) database.Damaged("steps are missing");
    counted = true;
  }

  void CheckEvents() const {
    database.ForEach("SELECT count(*), (SELECT value FROM meta WHERE key = 'ends') FROM event",
                     [&](const RunRow& row) {
                       if (row.integer(0) < EndOf("event", row.text(1)))
                         database.Damaged("events are missing");
                     });
  }

  /// Queries columns of the recorded moments.
  void ForEachMoment(const std::string& columns, const std::function<void(const RunRow&)>& use) const {
    CheckSteps();
    database.ForEach("SELECT " + columns + " FROM step WHERE step <= " + std::to_string(last) +
                         " AND poses IS NOT NULL ORDER BY step",
                     use);
  }

  /// The indices of `name` in each scene that has it. Throws Error 10 if none has.
  Places PlacesOf(const std::string& name) const {
    Places places;
    database.ForEach(
        "SELECT scene, body, place, p_x, p_y, p_z, q_w, q_x, q_y, q_z, sensors, (SELECT "
        "ifnull(sum(b.sensors), 0) FROM robot AS b WHERE b.scene = a.scene AND b.place < a.place), (SELECT "
        "ifnull(min(place), 0) FROM channel AS c WHERE c.scene = a.scene AND c.robot = a.place), (SELECT "
        "count(*) FROM channel AS c WHERE c.scene = a.scene AND c.robot = a.place) FROM robot AS a WHERE "
        "name "
        "= ?1",
        [&](const RunRow& row) {
          Place& place = places[row.count(0)];
          place.body = static_cast<std::size_t>(row.count(1));
          place.robot = row.count(2);
          for (int i = 0; i < 7; ++i) place.X_BR[static_cast<std::size_t>(i)] = row.number(3 + i);
          place.sensors = static_cast<std::size_t>(row.count(10));
          place.first_sensor = static_cast<std::size_t>(row.count(11));
          place.first_channel = static_cast<std::size_t>(row.count(12));
          place.channels = static_cast<std::size_t>(row.count(13));
        },
        &name);
    if (!places.empty()) return places;
    database.ForEach(
        "SELECT scene, place FROM body WHERE name = ?1",
        [&](const RunRow& row) { places[row.count(0)].body = static_cast<std::size_t>(row.count(1)); },
        &name);
    if (!places.empty()) return places;
    std::vector<std::string> known = names;
    database.ForEach("SELECT name FROM body WHERE robot IS NULL GROUP BY name ORDER BY min(scene), place",
                     [&](const RunRow& row) { known.push_back(row.text(0)); });
    throw Error(10, "there is no '" + name + "' in " + file() + "; " + Nearest(name, known) +
                        "there are: " + ListOf(known));
  }

  Places RobotPlacesOf(const std::string& name) const {
    Places places = PlacesOf(name);
    if (places.begin()->second.robot < 0) throw Error(10, name + " is no robot; there are: " + ListOf(names));
    return places;
  }

  /// The `count` bytes of a column from `first` on. Throws Error 7 if the column is shorter.
  Bytes Part(const RunRow& row, int column, std::size_t first, std::size_t count,
             const std::string& what) const {
    const Bytes all = row.bytes(column);
    if (first > all.size() || count > all.size() - first) Damaged(what, row.integer(0));
    return all.subspan(first, count);
  }

  bool Has(const std::string& what) const {
    const auto recorded = info.find("what");
    return recorded != info.end() &&
           ("," + recorded->second + ",").find("," + what + ",") != std::string::npos;
  }

  /// The loaded controller of a robot, if controllers' commands were not recorded; else empty.
  std::string UnrecordedController(const std::string& name) const {
    std::string controller;
    if (Has("controllers")) return controller;
    database.ForEach(
        "SELECT robot.id, type, description FROM robot JOIN scene ON scene.id = robot.scene WHERE name = ?1",
        [&](const RunRow& row) {
          if (controller.empty()) controller = ControllerIn(row.bytes(2), row.count(0), name, row.text(1));
        },
        &name);
    return controller;
  }

  [[noreturn]] void Damaged(const std::string& what, std::int64_t step) const {
    database.Damaged("the " + what + " of step " + std::to_string(step) + " do not add up");
  }

  const std::string& file() const { return database.file(); }

  RunDatabase database;
  mutable bool counted = false;  // CheckSteps()
  std::int64_t last = 0;         // newest step when the file was opened
  std::map<std::string, std::string> info;
  std::vector<std::string> names;
};

Run::Run(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Run::~Run() = default;
Run::Run(Run&&) noexcept = default;
Run& Run::operator=(Run&&) noexcept = default;

Run read_run(const std::string& file) {
  return Run(std::make_unique<Run::Impl>(file));
}

const std::string& Run::file() const {
  return impl_->file();
}

const std::map<std::string, std::string>& Run::info() const {
  return impl_->info;
}

const std::vector<std::string>& Run::names() const {
  return impl_->names;
}

std::string Run::scenario() const {
  std::string text;
  impl_->database.ForEach("SELECT content FROM text WHERE kind = 'scenario'",
                          [&](const RunRow& row) { text = row.text(0); });
  return text;
}

std::vector<double> Run::time() const {
  std::vector<double> times;
  impl_->ForEachMoment("time_ns", [&](const RunRow& row) { times.push_back(Seconds(row.integer(0))); });
  return times;
}

std::vector<std::int64_t> Run::steps() const {
  std::vector<std::int64_t> steps;
  impl_->ForEachMoment("step", [&](const RunRow& row) { steps.push_back(row.integer(0)); });
  return steps;
}

std::vector<std::string> Run::hash() const {
  std::vector<std::string> hashes;
  impl_->ForEachMoment("hash", [&](const RunRow& row) {
    char text[17];
    std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(row.integer(0)));
    hashes.emplace_back(text);
  });
  return hashes;
}

RunRows Run::pose_3d(const std::string& name) const {
  const Places places = impl_->PlacesOf(name);
  std::vector<double> values;
  impl_->ForEachMoment("step, scene, poses", [&](const RunRow& row) {
    const auto found = places.find(row.integer(1));
    if (found == places.end()) {
      values.insert(values.end(), 7, kNaN);
      return;
    }
    const Place& place = found->second;
    const int exponent = impl_->Part(row, 2, 0, 1, "poses")[0];
    if (exponent > 31) impl_->Damaged("poses", row.integer(0));
    const Bytes raw = impl_->Part(row, 2, 1 + kPoseBytes * place.body, kPoseBytes, "poses");
    const Pose7 pose = RobotPose(BodyPose(raw, exponent), place.X_BR);
    values.insert(values.end(), pose.begin(), pose.end());
  });
  const std::size_t k = values.size() / 7;
  return {std::move(values), 7, k};
}

RunRows Run::pose(const std::string& name) const {
  const RunRows poses = pose_3d(name);
  std::vector<double> values;
  values.reserve(3 * poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto p = poses[i];
    const double w = p[3], x = p[4], y = p[5], z = p[6];
    values.insert(values.end(), {p[0], p[1], std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))});
  }
  return {std::move(values), 3, poses.size()};
}

RunRows Run::reading(const std::string& name, const std::string& what) const {
  if (std::find(kReadings.begin(), kReadings.end(), what) == kReadings.end())
    throw Error(4, "there is no reading '" + what + "'; there are: " + Join(kReadings, ", "));
  const Places places = impl_->RobotPlacesOf(name);
  if (!impl_->Has(what))
    throw Error(5, what + " were not recorded in " + file() + "; record with --record-what all");
  std::map<std::int64_t, std::vector<std::size_t>> columns;  // of the robot's numbers, by scene
  std::size_t width = 0;
  if (what == "distances") {
    for (const auto& [scene, place] : places) {
      columns[scene].resize(place.sensors);
      std::iota(columns[scene].begin(), columns[scene].end(), 0);
      width = std::max(width, place.sensors);
    }
  } else if (what == "targets") {
    std::set<std::int64_t> ids;
    impl_->database.ForEach("SELECT DISTINCT id FROM target",
                            [&](const RunRow& row) { ids.insert(row.integer(0)); });
    impl_->database.ForEach("SELECT scene, id FROM target ORDER BY scene, place", [&](const RunRow& row) {
      const auto at = static_cast<std::size_t>(std::distance(ids.begin(), ids.find(row.integer(1))));
      std::vector<std::size_t>& of_scene = columns[row.integer(0)];
      of_scene.insert(of_scene.end(), {2 * at, 2 * at + 1});
    });
    width = 2 * ids.size();
  } else {
    width = 2 * MostChannels(places);
  }
  std::vector<double> values;
  std::size_t k = 0;
  impl_->ForEachMoment("step, scene, " + what, [&](const RunRow& row) {
    const std::size_t start = width * k++;
    values.resize(start + width, kNaN);
    const auto place = places.find(row.integer(1));
    if (place == places.end() || row.is_null(2)) return;
    const auto robot = static_cast<std::size_t>(place->second.robot);
    if (what == "channels") {
      const Place& of = place->second;
      const Bytes raw =
          impl_->Part(row, 2, kChannelBytes * of.first_channel, kChannelBytes * of.channels, what);
      for (std::size_t i = 0; i < of.channels; ++i) {
        const Bytes one = raw.subspan(kChannelBytes * i, kChannelBytes);
        values[start + i] = static_cast<double>(Signed(Little(one.first(5)), 40)) * kPositionUnit;
        values[start + width / 2 + i] = Single(one.subspan(5));
      }
      return;
    }
    const std::vector<std::size_t>& at = columns[place->first];
    const std::size_t first = what == "distances" ? place->second.first_sensor : at.size() * robot;
    const Bytes raw = impl_->Part(row, 2, 4 * first, 4 * at.size(), what);
    for (std::size_t i = 0; i < at.size(); ++i) values[start + at[i]] = Single(raw.subspan(4 * i, 4));
  });
  return {std::move(values), width, k};
}

std::vector<std::string> Run::joints(const std::string& name) const {
  const Places places = impl_->RobotPlacesOf(name);
  const auto most = std::max_element(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return a.second.channels < b.second.channels;
  });
  std::vector<std::string> joints;
  impl_->database.ForEach("SELECT joint FROM channel WHERE scene = " + std::to_string(most->first) +
                              " AND robot = " + std::to_string(most->second.robot) + " ORDER BY place",
                          [&](const RunRow& row) { joints.push_back(row.text(0)); });
  return joints;
}

RunRows Run::commands(const std::string& name) const {
  const Places places = impl_->RobotPlacesOf(name);
  const std::string controller = impl_->UnrecordedController(name);
  bool unknown = !controller.empty();
  const std::size_t m = MostChannels(places);
  std::vector<double> values, in_force(2 * m, kNaN);
  impl_->CheckSteps();
  impl_->database.ForEach(
      "SELECT step, time_ns, scene, commands FROM step WHERE step <= " + std::to_string(impl_->last) +
          " AND commands IS NOT NULL ORDER BY step",
      [&](const RunRow& row) {
        const Bytes raw = row.bytes(3);
        if (raw.size() % kCommandBytes != 0) impl_->Damaged("commands", row.integer(0));
        const auto place = places.find(row.integer(2));
        if (place == places.end()) return;
        bool sent = false;
        for (std::size_t at = 0; at < raw.size(); at += kCommandBytes) {
          const std::uint64_t word = Little(raw.subspan(at, 4));
          const std::size_t channel = (word & 0x7FFFFFFF) - place->second.first_channel;
          if (channel >= place->second.channels) continue;
          unknown = unknown && word < 0x80000000;  // until a client sends one
          in_force[channel] = Double(raw.subspan(at + 5));
          in_force[m + channel] = raw[at + 4];
          sent = true;
        }
        if (!sent || unknown) return;
        values.insert(values.end(), {static_cast<double>(row.integer(0)), Seconds(row.integer(1))});
        values.insert(values.end(), in_force.begin(), in_force.end());
      });
  if (unknown)
    throw Error(5, "the commands of " + name + ", driven by controller " + controller +
                       ", were not recorded in " + file() + "; record with --record-what " +
                       impl_->info["what"] + ",controllers");
  const std::size_t width = 2 + in_force.size(), rows = values.size() / width;
  return {std::move(values), width, rows};
}

std::vector<Event> Run::events() const {
  std::vector<Event> events;
  impl_->CheckEvents();
  impl_->database.ForEach(
      "SELECT step, time_ns, level, text FROM event WHERE step <= " + std::to_string(impl_->last) +
          " ORDER BY id",
      [&](const RunRow& row) {
        events.push_back({row.integer(0), Seconds(row.integer(1)), row.text(2), row.text(3)});
      });
  return events;
}

RunRows Run::score(const std::string& name) const {
  const std::vector<std::string> known = ScoreNames(impl_->info);
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) {
    std::string text = file() + " has no score " + name, before = "; there are ";
    for (const std::string& one : known) text += std::exchange(before, ", ") + one;
    throw Error(10, text);
  }
  const std::size_t at = kScoreBytes * static_cast<std::size_t>(found - known.begin());
  std::vector<double> values;
  impl_->ForEachMoment("step, time_ns, scores", [&](const RunRow& row) {
    values.push_back(Seconds(row.integer(1)));
    values.push_back(Double(impl_->Part(row, 2, at, sizeof(double), "scores")));
  });
  const std::size_t rows = values.size() / 2;
  return {std::move(values), 2, rows};
}

std::map<std::string, double> Run::scores() const {
  std::map<std::string, double> last;
  for (const std::string& name : ScoreNames(impl_->info)) last[name] = score(name).values().back();
  return last;
}

RunRows Run::logged(const std::string& name) const {
  std::vector<double> values;
  std::set<std::string> known;
  for (const Event& event : events()) {
    if (event.level != "log") continue;
    const std::size_t blank = event.text.find(' ');
    const std::string one = event.text.substr(0, blank);
    known.insert(one);
    if (one != name || blank == std::string::npos) continue;
    double value = 0;
    const char* end = event.text.data() + event.text.size();
    if (std::from_chars(event.text.data() + blank + 1, end, value).ec != std::errc()) continue;
    values.insert(values.end(), {event.time, value});
  }
  if (values.empty()) {
    std::string text = file() + " has no numbers logged under " + name, before = "; there are ";
    for (const std::string& one : known) text += std::exchange(before, ", ") + one;
    throw Error(10, text);
  }
  const std::size_t rows = values.size() / 2;
  return {std::move(values), 2, rows};
}

}  // namespace coopdyn::client
