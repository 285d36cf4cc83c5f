// SPDX-License-Identifier: MIT
#include "server/host/class_room.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iterator>
#include <utility>

#include "protocol/json_text.h"
#include "server/base/printable.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr std::chrono::milliseconds kTick{1000};
constexpr std::size_t kMaxError = 300;
constexpr int kPortsOfSeat = 100;

std::string ClockTime(const char* format) {
  return fmt::format(fmt::runtime(format), fmt::localtime(std::time(nullptr)));
}

std::string TextOf(const json::object& object, std::string_view key) {
  const json::value* const value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->as_string()) : std::string();
}

/// The clients that a status names, without those of the page's and the host's own.
std::size_t ClientsIn(const json::object& status) {
  const json::value* const clients = status.if_contains("clients");
  if (clients == nullptr || !clients->is_array()) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(clients->as_array(), [](const json::value& client) {
    const std::string peer = client.is_object() ? TextOf(client.as_object(), "peer") : "";
    return peer != "page status" && !peer.ends_with("the class's host");
  }));
}

/// What `load_scenario` takes for a scenario of the command line: a bare name, or the text of a file.
std::string TextToLoad(const std::string& lesson) {
  if (lesson.find('/') == std::string::npos) return lesson;
  std::ifstream file(lesson);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text + "\n# file: " + fs::path(lesson).filename().string() + "\n";
}

/// A page that finds its seat put aside leaves it so.
const char* StateWord(const Seat& seat) {
  return seat.put_aside() ? ToString(SeatState::kAsleep) : ToString(seat.state());
}

/// Why a module did not do what it was told; empty: it did.
std::string ErrorIn(const SeatAnswer& answer) {
  if (answer.status != 200) return answer.body.empty() ? "no answer" : Printable(answer.body, kMaxError);
  boost::system::error_code failed;
  const json::value reply = json::parse(answer.body, failed);
  if (failed || !reply.is_object()) return "no answer";
  const json::value* const error = reply.as_object().if_contains("error");
  const bool done = error != nullptr && error->is_int64() && error->as_int64() == 0;
  return done ? "" : Printable(TextOf(reply.as_object(), "text"), kMaxError);
}

/// Whether an event of the daemon is of the student's making. A slow machine is not.
bool IsRelevant(const json::object& event) {
  const std::string level = TextOf(event, "level");
  return (level == "error" || level == "warning") && !TextOf(event, "text").starts_with("real time is lost");
}

}  // namespace

ClassRoom::ClassRoom(boost::asio::io_context& context, ClassOptions options, Roll roll, RandomDigits random,
                     const Clock& clock, Logger logger)
    : context_(context),
      options_(std::move(options)),
      roll_(std::move(roll)),
      random_(std::move(random)),
      clock_(clock),
      logger_(std::move(logger)),
      timer_(context) {}

ClassRoom::~ClassRoom() {
  *alive_ = false;
}

fs::path ClassRoom::folder_of(const std::string& seat) const {
  return options_.folder / "seats" / seat;
}

void ClassRoom::AddSeat(const RollEntry& entry) {
  SeatPlan plan = options_.plan;
  plan.lesson = options_.lessons[lesson_];
  const auto place_in_list =
      std::ranges::find(roll_.entries(), entry.seat, &RollEntry::seat) - roll_.entries().begin();
  if (plan.port != 0) plan.port += static_cast<int>(place_in_list) * kPortsOfSeat;
  Place place;
  place.seat = std::make_unique<Seat>(context_, entry.seat, folder_of(entry.seat),
                                      url_ + "s/" + entry.seat + "/", std::move(plan), clock_, logger_);
  place.seat->set_on_change([this] { Changed(); });
  LoadDesk(entry.seat, place.desk);
  places_.insert_or_assign(entry.seat, std::move(place));
}

void ClassRoom::Open(const std::string& url) {
  url_ = url;
  for (const RollEntry& entry : roll_.entries()) AddSeat(entry);
  for (auto& [name, place] : places_) {
    place.seat->Find();
    place.seat->SetTaken(place.desk.frozen);
    place.desk.active = clock_.Now();
  }
  Tick();
}

Seat* ClassRoom::FindSeat(std::string_view name) {
  const auto found = places_.find(name);
  return found == places_.end() ? nullptr : found->second.seat.get();
}

const RollEntry* ClassRoom::FindLink(std::string_view link) const {
  const auto found = std::ranges::find(roll_.entries(), link, &RollEntry::link);
  return link.empty() || found == roll_.entries().end() ? nullptr : &*found;
}

void ClassRoom::SetRoll(Roll roll) {
  roll_ = std::move(roll);
  for (auto it = places_.begin(); it != places_.end();) {
    if (roll_.Find(it->first) != nullptr) {
      ++it;
      continue;
    }
    it->second.seat->PutAside();
    leaving_[it->first] = std::move(it->second.seat);
    it = places_.erase(it);
  }
  for (const RollEntry& entry : roll_.entries()) {
    if (places_.contains(entry.seat)) continue;
    leaving_.erase(entry.seat);
    AddSeat(entry);
    places_.find(entry.seat)->second.seat->Find();
  }
  Changed();
}

void ClassRoom::PutAllAside(std::function<void()> done) {
  bool waits = false;
  for (auto& [name, place] : places_) {
    place.seat->Close();
    waits =
        waits || place.seat->state() == SeatState::kRunning || place.seat->state() == SeatState::kStarting;
  }
  if (!waits) return done();
  timer_.expires_after(std::chrono::milliseconds(20));
  timer_.async_wait([this, alive = alive_, done = std::move(done)](const auto& error) mutable {
    if (!error && *alive) PutAllAside(std::move(done));
  });
}

void ClassRoom::Tick() {
  for (auto& [name, place] : places_) {
    if (place.seat->state() == SeatState::kRunning) {
      AskStatus(name, place);
      PutIdleAside(place);
    }
  }
  std::erase_if(leaving_, [](const auto& leaving) { return leaving.second->state() == SeatState::kAsleep; });
  timer_.expires_after(kTick);
  timer_.async_wait([this, alive = alive_](const auto& error) {
    if (!error && *alive) Tick();
  });
}

void ClassRoom::AskStatus(const std::string& name, Place& place) {
  if (std::exchange(place.asking, true)) return;
  CallSeat(context_, *place.seat, "/api/status", {}, [this, alive = alive_, name](const SeatAnswer& answer) {
    if (!*alive) return;
    const auto found = places_.find(name);
    if (found == places_.end()) return;
    found->second.asking = false;
    if (answer.status == 200) TakeStatus(found->second, answer.body);
  });
}

void ClassRoom::TakeStatus(Place& place, const std::string& body) {
  boost::system::error_code failed;
  const json::value read = json::parse(body, failed);
  if (failed || !read.is_object()) return;
  const json::object& status = read.as_object();
  Desk& desk = place.desk;
  const Nanoseconds now = clock_.Now();
  json::object brief;
  for (const char* key : {"scenario", "mode", "state", "ended", "time_s", "rtf", "scores", "robot_count"}) {
    if (const json::value* const value = status.if_contains(key)) brief[key] = *value;
  }
  const std::size_t clients = ClientsIn(status);
  brief["clients"] = clients;
  std::string owner;
  if (const json::value* const robots = status.if_contains("robots");
      robots != nullptr && robots->is_array()) {
    for (const json::value& robot : robots->as_array()) {
      if (robot.is_object() && owner.empty()) owner = TextOf(robot.as_object(), "owner");
    }
  }
  brief["driven_by"] = owner;
  const json::value* const step = status.if_contains("step");
  const std::int64_t at = step != nullptr && step->is_int64() ? step->as_int64() : 0;
  if (at < desk.last_step) desk.resets.push_back(now);
  std::erase_if(desk.resets, [now](Nanoseconds when) { return now - when > kResetWindow; });
  // A step in lockstep is something that a program has done; in real time steps come by themselves.
  const bool stepped = at != desk.last_step && TextOf(status, "mode") == "lockstep";
  if (stepped || at < desk.last_step) desk.active = now;
  desk.last_step = at;
  if (const json::value* const events = status.if_contains("events");
      events != nullptr && events->is_array()) {
    std::string newest;
    for (const json::value& event : events->as_array()) {
      if (event.is_object() && IsRelevant(event.as_object()))
        newest = Printable(TextOf(event.as_object(), "text"), kMaxError);
    }
    if (newest != desk.last_error) {
      desk.last_error = newest;
      desk.error_at = now;
    }
  }
  const auto is_null = [&status](const char* key) {
    const json::value* const value = status.if_contains(key);
    return value == nullptr || value->is_null();
  };
  // A student has ended the recording from which the seat would continue: another one begins.
  constexpr Nanoseconds kBetweenTries = 10 * kNanosecondsPerSecond;
  if (is_null("recording") && is_null("playback") && now - desk.recording_tried > kBetweenTries) {
    desk.recording_tried = now;
    Command(place, "/recorder", "start", RunFileName(NewestRun(place.seat->folder() / "runs") + 1));
  }
  if (brief != desk.status) Changed();
  desk.status = std::move(brief);
}

void ClassRoom::PutIdleAside(Place& place) {
  const Desk& desk = place.desk;
  const json::value* const clients = desk.status.if_contains("clients");
  if (options_.idle <= 0 || clients == nullptr || clients->to_number<std::size_t>() > 0) return;
  if (clock_.Now() - desk.active < options_.idle) return;
  logger_->info("seat {}: put aside, as nothing has happened for a while", place.seat->name());
  place.seat->PutAside();
  Changed();
}

void ClassRoom::NoteActive(const std::string& seat, const std::string& peer, const std::string& language) {
  const auto found = places_.find(seat);
  if (found == places_.end()) return;
  found->second.seat->Admit(peer);
  found->second.desk.active = clock_.Now();
  if (!language.empty()) found->second.desk.language = Printable(language, 20);
}

void ClassRoom::RaiseHand(const std::string& seat, bool up) {
  const auto found = places_.find(seat);
  if (found == places_.end()) return;
  Desk& desk = found->second.desk;
  if (up == (desk.hand_since != 0)) return;
  desk.hand_since = up ? std::max<Nanoseconds>(clock_.Now(), 1) : 0;
  SaveDesk(seat, desk);
  Changed();
}

void ClassRoom::HandIn(const std::string& seat, std::function<void(std::string)> done) {
  const auto found = places_.find(seat);
  if (found == places_.end()) return done("there is no such seat");
  const fs::path folder = folder_of(seat);
  const fs::path into = folder / "handed-in" / ClockTime("{:%Y%m%d-%H%M%S}");
  std::error_code code;
  fs::create_directories(into, code);
  if (code) return done("it cannot be kept: " + code.message());
  for (const char* name : {"program.py", "output.txt"}) {
    std::error_code missing;
    fs::copy_file(folder / name, into / name, fs::copy_options::overwrite_existing, missing);
  }
  // A recording can be copied when it has ended, and a young one has a file only then; the run goes on in the
  // next.
  const auto keep = [this, alive = alive_, seat, runs = folder / "runs", into,
                     done = std::move(done)](const SeatAnswer&) {
    if (!*alive) return;
    const int run = NewestRun(runs);
    if (run == 0) return done("");
    std::error_code failed;
    fs::copy_file(runs / RunFileName(run), into / "recording.run", failed);
    const auto place = places_.find(seat);
    if (place != places_.end()) Command(place->second, "/recorder", "start", RunFileName(run + 1));
    done(failed ? "the recording cannot be kept: " + failed.message() : "");
  };
  if (found->second.seat->state() != SeatState::kRunning) return keep({});
  CallSeat(context_, *found->second.seat, "/api/call",
           json::serialize(json::object{{"module", "/recorder"}, {"command", "stop"}}), keep,
           std::chrono::seconds(60));
}

void ClassRoom::Command(Place& place, const std::string& module, const std::string& command,
                        const std::string& text) {
  const json::object call{{"module", module}, {"command", command}, {"text", text}};
  CallSeat(context_, *place.seat, "/api/call", json::serialize(call),
           [this, alive = alive_, seat = place.seat->name(), command](const SeatAnswer& answer) {
             if (!*alive) return;
             const std::string error = ErrorIn(answer);
             if (!error.empty()) logger_->warn("seat {}: {}: {}", seat, command, error);
             const auto found = places_.find(seat);
             if (found == places_.end()) return;
             found->second.desk.refused = error.empty() ? "" : command + ": " + error;
             found->second.desk.refused_at = clock_.Now();
             Changed();
           });
}

std::string ClassRoom::KeepLesson(const std::string& text) const {
  if (text.find('\n') == std::string::npos) return text;
  const fs::path folder = options_.folder / "lessons";
  std::error_code code;
  fs::create_directories(folder, code);
  const fs::path file = folder / (ClockTime("{:%Y%m%d-%H%M%S}") + ".scenario");
  std::ofstream out(file);
  out << text << (text.ends_with('\n') ? "" : "\n");
  out.close();
  return out.good() ? file.string() : "";
}

void ClassRoom::Push(Place& place, const std::string& lesson, const std::string& text) {
  if (place.seat->state() == SeatState::kRunning)
    return Command(place, "/simulation", "load_scenario", text.empty() ? TextToLoad(lesson) : text);
  place.seat->BeginAnew(lesson);
}

std::string ClassRoom::Do(const json::object& order) {
  const std::string what = TextOf(order, "do");
  const std::vector<std::string> known = {"freeze", "thaw",    "take", "give",       "reset", "restart",
                                          "push",   "message", "next", "lower_hand", "aside"};
  if (std::ranges::find(known, what) == known.end())
    return "the order is none of " + fmt::format("{}", fmt::join(known, ", "));
  if ((what == "message" || what == "push") && TextOf(order, "text").empty()) return what + " needs a text";
  json::object given = order;
  if (what == "push") {
    const std::string lesson = KeepLesson(TextOf(order, "text"));
    if (lesson.empty()) return "the scenario cannot be written into " + options_.folder.string();
    given["lesson"] = lesson;
  }
  if (what == "next") {
    if (lesson_ + 1 >= options_.lessons.size()) return "this was the last scenario of the lesson";
    ++lesson_;
  }
  std::vector<std::string> names;
  const json::value* const seats = order.if_contains("seats");
  if (seats != nullptr && seats->is_array()) {
    for (const json::value& seat : seats->as_array()) {
      const std::string name = seat.is_string() ? std::string(seat.as_string()) : "";
      if (!places_.contains(name)) return "there is no seat '" + Printable(name, 60) + "'";
      names.push_back(name);
    }
  } else {
    for (const auto& [name, place] : places_) names.push_back(name);
  }
  for (const std::string& name : names) {
    Place& place = places_.find(name)->second;
    Order(name, place, given);
    SaveDesk(name, place.desk);
  }
  Changed();
  return {};
}

void ClassRoom::Order(const std::string& name, Place& place, const json::object& order) {
  const std::string what = TextOf(order, "do"), text = TextOf(order, "text");
  Desk& desk = place.desk;
  const bool runs = place.seat->state() == SeatState::kRunning;
  if (what == "freeze" || what == "thaw") {
    desk.frozen = what == "freeze";
    place.seat->SetTaken(desk.frozen);
    if (runs) Command(place, "/simulation", desk.frozen ? "pause" : "run");
  } else if (what == "take" || what == "give") {
    place.seat->SetTaken(what == "take");
    if (what == "take") place.seat->Wake();
  } else if (what == "reset") {
    if (runs) Command(place, "/simulation", "reset");
  } else if (what == "restart") {
    place.seat->BeginAnew(options_.lessons[lesson_]);
  } else if (what == "aside") {
    place.seat->PutAside();
  } else if (what == "push" || what == "next") {
    Push(place, what == "next" ? options_.lessons[lesson_] : TextOf(order, "lesson"), text);
  } else if (what == "message") {
    desk.notes.push_back({ClockTime("{:%H:%M}"), PrintableLines(text, kMaxNoteBytes)});
    if (desk.notes.size() > kMaxNotes) desk.notes.erase(desk.notes.begin());
  } else if (what == "lower_hand") {
    RaiseHand(name, false);
  }
}

ClassRoom::Need ClassRoom::NeedOf(const Place& place) const {
  const Desk& desk = place.desk;
  const Nanoseconds now = clock_.Now();
  const auto minutes = [now](Nanoseconds since) { return (now - since) / (60 * kNanosecondsPerSecond); };
  if (desk.hand_since != 0) return {5, fmt::format("hand up for {} min", minutes(desk.hand_since))};
  if (place.seat->state() == SeatState::kFailed) return {4, place.seat->trouble()};
  if (desk.resets.size() >= kResets) return {3, fmt::format("{} resets within a minute", desk.resets.size())};
  constexpr Nanoseconds kNew = 2 * 60 * kNanosecondsPerSecond;
  if (!desk.refused.empty() && now - desk.refused_at < kNew) return {2, desk.refused};
  if (!desk.last_error.empty() && now - desk.error_at < kNew) return {2, desk.last_error};
  const json::value* const clients = desk.status.if_contains("clients");
  const bool here = clients != nullptr && clients->to_number<std::size_t>() > 0;
  if (here && place.seat->state() == SeatState::kRunning && now - desk.active > kStuck)
    return {1, fmt::format("nothing done for {} min", minutes(desk.active))};
  return {};
}

json::object ClassRoom::StudentJson(const std::string& seat) const {
  const auto found = places_.find(seat);
  const RollEntry* const entry = roll_.Find(seat);
  if (found == places_.end() || entry == nullptr) return {};
  const Desk& desk = found->second.desk;
  json::array notes;
  for (const Desk::Note& note : desk.notes) notes.push_back({{"time", note.time}, {"text", note.text}});
  json::array handed_in;
  std::vector<std::string> folders;
  std::error_code code;
  for (fs::directory_iterator it(folder_of(seat) / "handed-in", code), end; !code && it != end;
       it.increment(code))
    folders.push_back(it->path().filename().string());
  std::sort(folders.begin(), folders.end());
  for (const std::string& folder : folders) {
    json::object one{{"when", folder}};
    std::ifstream result(folder_of(seat) / "handed-in" / folder / "result.txt");
    const std::string text{std::istreambuf_iterator<char>(result), {}};
    if (!text.empty()) one["result"] = PrintableLines(text, kMaxNoteBytes);
    json::array files;
    for (const char* file : {"program.py", "output.txt", "recording.run"}) {
      if (fs::exists(folder_of(seat) / "handed-in" / folder / file, code)) files.emplace_back(file);
    }
    one["files"] = std::move(files);
    handed_in.push_back(std::move(one));
  }
  return {{"seat", seat},
          {"name", entry->name},
          {"group", entry->group},
          {"names", names_port_},
          {"daemon", StateWord(*found->second.seat)},
          {"hand", desk.hand_since != 0},
          {"own_port", found->second.seat->port()},
          {"taken", found->second.seat->taken()},
          {"frozen", desk.frozen},
          {"trouble", found->second.seat->trouble()},
          {"notes", std::move(notes)},
          {"handed_in", std::move(handed_in)}};
}

json::object ClassRoom::WallJson() const {
  struct Row {
    Need need;
    Nanoseconds since;
    json::object tile;
  };
  std::vector<Row> rows;
  const Nanoseconds now = clock_.Now();
  for (const RollEntry& entry : roll_.entries()) {
    const auto found = places_.find(entry.seat);
    if (found == places_.end()) continue;
    const auto& [name, place] = *found;
    Need need = NeedOf(place);
    json::object tile = place.desk.status;
    tile["seat"] = name;
    tile["name"] = entry.name;
    tile["group"] = entry.group;
    tile["daemon"] = StateWord(*place.seat);
    tile["trouble"] = place.seat->trouble();
    tile["hand"] = place.desk.hand_since != 0;
    tile["taken"] = place.seat->taken();
    tile["frozen"] = place.desk.frozen;
    tile["language"] = place.desk.language;
    tile["idle_s"] = (now - place.desk.active) / kNanosecondsPerSecond;
    tile["error"] = place.desk.last_error;
    tile["need"] = need.rank;
    tile["why"] = need.why;
    rows.push_back({std::move(need), place.desk.hand_since, std::move(tile)});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.need.rank != b.need.rank ? a.need.rank > b.need.rank : a.since < b.since;
  });
  json::array tiles;
  for (Row& row : rows) tiles.push_back(std::move(row.tile));
  json::array lessons;
  for (const std::string& lesson : options_.lessons) lessons.push_back(json::string(lesson));
  return {{"seats", std::move(tiles)},
          {"lessons", std::move(lessons)},
          {"lesson", lesson_},
          {"names", names_port_}};
}

void ClassRoom::SaveDesk(const std::string& name, const Desk& desk) const {
  json::array notes;
  for (const Desk::Note& note : desk.notes) notes.push_back({{"time", note.time}, {"text", note.text}});
  const json::object kept{
      {"hand", desk.hand_since != 0}, {"frozen", desk.frozen}, {"notes", std::move(notes)}};
  const fs::path file = folder_of(name) / "desk.json";
  const fs::path fresh = file.string() + ".new";
  std::ofstream(fresh) << json::serialize(kept) << '\n';
  std::error_code code;
  fs::rename(fresh, file, code);
}

void ClassRoom::LoadDesk(const std::string& name, Desk& desk) const {
  std::ifstream file(folder_of(name) / "desk.json");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  boost::system::error_code failed;
  const json::value read = json::parse(text, failed);
  if (failed || !read.is_object()) return;
  const json::object& kept = read.as_object();
  const auto flag = [&kept](const char* key) {
    const json::value* const value = kept.if_contains(key);
    return value != nullptr && value->is_bool() && value->as_bool();
  };
  desk.hand_since = flag("hand") ? std::max<Nanoseconds>(clock_.Now(), 1) : 0;
  desk.frozen = flag("frozen");
  const json::value* const notes = kept.if_contains("notes");
  if (notes == nullptr || !notes->is_array()) return;
  for (const json::value& note : notes->as_array()) {
    if (note.is_object())
      desk.notes.push_back({TextOf(note.as_object(), "time"), TextOf(note.as_object(), "text")});
  }
}

}  // namespace coopdyn
