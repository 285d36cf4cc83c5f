// SPDX-License-Identifier: MIT
#include "server/host/class_room.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "server/base/printable.h"
#include "server/host/json_fields.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr std::chrono::milliseconds kTick{1000};
constexpr std::size_t kMaxError = 300;
constexpr int kPortsOfSeat = 100;
constexpr std::uint64_t kTidyEvery = 30;  // ticks

std::string ClockTime(const char* format) {
  return fmt::format(fmt::runtime(format), fmt::localtime(std::time(nullptr)));
}

/// What a student's scenario says may be long: the wall shows the beginning.
json::value Short(const json::value& value) {
  constexpr std::size_t kMaxText = 200, kMaxScores = 16;
  if (value.is_string()) return json::value(Printable(value.as_string(), kMaxText));
  if (!value.is_array()) return value;
  const json::array& all = value.as_array();
  return json::array(all.begin(),
                     all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), kMaxScores)));
}

/// The clients that a status names, without those of the page's and the host's own.
std::size_t ClientsIn(const json::object& status) {
  const json::value* const clients = status.if_contains("clients");
  if (clients == nullptr || !clients->is_array()) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(clients->as_array(), [](const json::value& client) {
    const std::string peer = client.is_object() ? TextIn(client.as_object(), "peer") : "";
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

/// Why a module did not do what it was told; empty: it did.
std::string ErrorIn(const SeatAnswer& answer) {
  if (answer.status != 200) return answer.body.empty() ? "no answer" : Printable(answer.body, kMaxError);
  boost::system::error_code failed;
  const json::value reply = json::parse(answer.body, failed);
  if (failed || !reply.is_object()) return "no answer";
  const json::value* const error = reply.as_object().if_contains("error");
  const bool done = error != nullptr && error->is_int64() && error->as_int64() == 0;
  return done ? "" : Printable(TextIn(reply.as_object(), "text"), kMaxError);
}

bool HasEnded(const Seat& seat) {
  return seat.state() == SeatState::kAsleep || seat.state() == SeatState::kFailed;
}

/// Whether an event of the daemon is of the student's making. A slow machine is not.
bool IsRelevant(const json::object& event) {
  const std::string level = TextIn(event, "level");
  return (level == "error" || level == "warning") && !TextIn(event, "text").starts_with("real time is lost");
}

}  // namespace

ClassRoom::ClassRoom(boost::asio::io_context& context, ClassOptions options, Roll roll, const Clock& clock,
                     Logger logger)
    : context_(context),
      options_(std::move(options)),
      roll_(std::move(roll)),
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
  const auto is_taken = [this](int port) {
    return std::ranges::any_of(places_,
                               [port](const auto& place) { return place.second.seat->port() == port; }) ||
           std::ranges::any_of(leaving_, [port](const auto& seat) { return seat.second->port() == port; });
  };
  while (plan.port != 0 && is_taken(plan.port)) plan.port += kPortsOfSeat;
  Place place;
  place.seat = std::make_unique<Seat>(context_, entry.seat, folder_of(entry.seat),
                                      url_ + "s/" + entry.seat + "/", std::move(plan), clock_, logger_);
  place.seat->set_on_change([this] { Changed(); });
  place.program = std::make_unique<Program>(
      context_, entry.seat, folder_of(entry.seat), options_.programs, clock_,
      [this, seat = entry.seat](UniqueFd fd) { ConnectProgram(seat, std::move(fd)); }, [this] { Changed(); });
  LoadDesk(entry.seat, place.desk);
  places_.insert_or_assign(entry.seat, std::move(place));
}

void ClassRoom::ConnectProgram(const std::string& seat, UniqueFd connection) {
  const auto found = places_.find(seat);
  if (found == places_.end()) return;
  found->second.desk.language = "python";
  PassedSocket passed{.kind = PassedKind::kNames};
  passed.peer = {.text = "the program of the seat", .trusted = true, .yields = true};
  passed.fd = std::move(connection);
  found->second.seat->Pass(std::move(passed));
}

void ClassRoom::Open(const std::string& url) {
  url_ = url;
  for (const RollEntry& entry : roll_.entries()) AddSeat(entry);
  EndStrays();
  for (auto& [name, place] : places_) {
    place.seat->Find();
    place.seat->SetTaken(place.desk.frozen);
    place.desk.active = place.desk.answered = clock_.Now();
  }
  Tick();
}

void ClassRoom::EndStrays() {
  std::error_code code;
  for (fs::directory_iterator it(options_.folder / "seats", code), end; !code && it != end;
       it.increment(code)) {
    const std::string name = it->path().filename().string();
    if (places_.contains(name) || !ConnectToDoor((it->path() / "door").string())) continue;
    auto seat = std::make_unique<Seat>(context_, name, it->path(), url_, options_.plan, clock_, logger_);
    seat->Find();
    seat->PutAside();
    leaving_[name] = std::move(seat);
  }
}

Seat* ClassRoom::FindSeat(std::string_view name) {
  const auto found = places_.find(name);
  return found == places_.end() ? nullptr : found->second.seat.get();
}

Program* ClassRoom::FindProgram(std::string_view seat) {
  const auto found = places_.find(seat);
  return found == places_.end() ? nullptr : found->second.program.get();
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
  AddMissing();
}

void ClassRoom::AddMissing() {
  std::erase_if(leaving_, [](const auto& leaving) { return HasEnded(*leaving.second); });
  for (const RollEntry& entry : roll_.entries()) {
    // A student who comes back waits for the daemon that ends.
    if (places_.contains(entry.seat) || leaving_.contains(entry.seat)) continue;
    AddSeat(entry);
    places_.find(entry.seat)->second.seat->Find();
  }
  Changed();
}

void ClassRoom::PutAllAside(std::function<void()> done) {
  bool waits = false;
  for (auto& [name, place] : places_) {
    place.seat->Close();
    place.program->Stop("The class has ended.");
    waits = waits || place.program->runs() || place.seat->state() == SeatState::kRunning ||
            place.seat->state() == SeatState::kStarting;
  }
  waits = waits || std::ranges::any_of(leaving_, [](const auto& seat) { return !HasEnded(*seat.second); });
  if (!waits) return done();
  timer_.expires_after(std::chrono::milliseconds(20));
  timer_.async_wait([this, alive = alive_, done = std::move(done)](const auto& error) mutable {
    if (!error && *alive) PutAllAside(std::move(done));
  });
}

void ClassRoom::Tick() {
  for (auto& [name, place] : places_) {
    if (place.program->runs()) place.desk.active = clock_.Now();
    place.program->SaveOutput();
    if (place.seat->state() == SeatState::kRunning) {
      AskStatus(name, place);
      PutIdleAside(place);
      if (ticks_ % kTidyEvery == 0) place.seat->TidyRuns();
    } else {
      place.desk.answered = clock_.Now();
    }
  }
  ++ticks_;
  if (!leaving_.empty()) AddMissing();
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
    if (answer.status != 200) return;
    found->second.desk.answered = clock_.Now();
    TakeStatus(found->second, answer.body);
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
    if (const json::value* const value = status.if_contains(key)) brief[key] = Short(*value);
  }
  const std::size_t clients = ClientsIn(status);
  brief["clients"] = clients;
  std::string owner;
  if (const json::value* const robots = status.if_contains("robots");
      robots != nullptr && robots->is_array()) {
    for (const json::value& robot : robots->as_array()) {
      if (robot.is_object() && owner.empty()) owner = TextIn(robot.as_object(), "owner");
    }
  }
  brief["driven_by"] = owner;
  const json::value* const step = status.if_contains("step");
  const std::int64_t at = step != nullptr && step->is_int64() ? step->as_int64() : 0;
  if (at < desk.last_step) desk.resets.push_back(now);
  std::erase_if(desk.resets, [now](Nanoseconds when) { return now - when > kResetWindow; });
  // A step in lockstep is something that a program has done; in real time steps come by themselves.
  const bool stepped = at != desk.last_step && TextIn(status, "mode") == "lockstep";
  if (stepped || at < desk.last_step) desk.active = now;
  desk.last_step = at;
  if (const json::value* const events = status.if_contains("events");
      events != nullptr && events->is_array()) {
    std::string newest;
    for (const json::value& event : events->as_array()) {
      if (event.is_object() && IsRelevant(event.as_object()))
        newest = Printable(TextIn(event.as_object(), "text"), kMaxError);
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
  if (found->second.hands_in) return done("what you handed in before is still being kept: wait a moment");
  const fs::path folder = folder_of(seat);
  const fs::path into = folder / "handed-in" / ClockTime("{:%Y%m%d-%H%M%S}");
  std::error_code code;
  if (fs::exists(into, code)) return done("you have just handed in: wait a moment");
  if (CountIn(folder / "handed-in") >= kMaxHandIns)
    return done("you have handed in " + std::to_string(kMaxHandIns) +
                " times: ask your teacher to remove some of these");
  if (SizeOf(folder / "handed-in") + SizeOf(folder / "runs" / RunFileName(NewestRun(folder / "runs"))) >
      options_.plan.limits.disk_bytes)
    return done("your share of the disk is full: ask your teacher to remove what you handed in before");
  // The status must not begin a recording between the two of the hand-in.
  found->second.desk.recording_tried = clock_.Now();
  fs::create_directories(into, code);
  if (code) return done("it cannot be kept: " + code.message());
  found->second.program->SaveOutput();
  for (const char* name : {"program.py", "output.txt"}) {
    std::error_code missing;
    fs::copy_file(folder / name, into / name, fs::copy_options::overwrite_existing, missing);
  }
  // A recording can be copied when it has ended, and a young one has a file only then; the run goes on in the
  // next.
  found->second.hands_in = true;
  const auto keep = [this, alive = alive_, seat, runs = folder / "runs", into,
                     done = std::move(done)](const SeatAnswer&) {
    if (!*alive) return;
    const auto place = places_.find(seat);
    if (place != places_.end()) place->second.hands_in = false;
    const int run = NewestRun(runs);
    if (run == 0) return done("");
    const fs::path file = runs / RunFileName(run), kept = into / "recording.run";
    std::error_code failed;
    fs::create_hard_link(file, kept, failed);  // at once, as nobody changes a recording that has ended
    if (failed) fs::copy_file(file, kept, failed);
    if (place != places_.end()) Command(place->second, "/recorder", "start", RunFileName(run + 1));
    std::error_code gone;
    if (failed) fs::remove_all(into, gone);
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
             Desk& desk = found->second.desk;
             if (error.empty() && !desk.refused.starts_with(command + ": ")) return;
             desk.refused = error.empty() ? "" : command + ": " + error;
             desk.refused_at = clock_.Now();
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
  const std::string what = TextIn(order, "do");
  const std::vector<std::string> known = {"freeze", "thaw",    "take", "give",       "reset", "restart",
                                          "push",   "message", "next", "lower_hand", "aside"};
  if (std::ranges::find(known, what) == known.end())
    return "the order is none of " + fmt::format("{}", fmt::join(known, ", "));
  if ((what == "message" || what == "push") && TextIn(order, "text").empty()) return what + " needs a text";
  std::set<std::string> names;  // a seat that is named twice gets the order once
  const json::value* const seats = order.if_contains("seats");
  if (seats != nullptr && !seats->is_array()) return R"(seats is a list, e.g. ["ana"]; without it, all)";
  if (seats != nullptr) {
    for (const json::value& seat : seats->as_array()) {
      const std::string name = seat.is_string() ? std::string(seat.as_string()) : "";
      if (!places_.contains(name)) return "there is no seat '" + Printable(name, 60) + "'";
      names.insert(name);
    }
  } else {
    for (const auto& [name, place] : places_) names.insert(name);
  }
  json::object given = order;
  if (what == "push") {
    const std::string lesson = KeepLesson(TextIn(order, "text"));
    if (lesson.empty()) return "the scenario cannot be written into " + options_.folder.string();
    given["lesson"] = lesson;
  }
  if (what == "next") {
    if (lesson_ + 1 >= options_.lessons.size()) return "this was the last scenario of the lesson";
    ++lesson_;
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
  const std::string what = TextIn(order, "do"), text = TextIn(order, "text");
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
    place.program->Stop("The teacher began the lesson anew, so the program was stopped.");
    place.seat->BeginAnew(options_.lessons[lesson_]);
  } else if (what == "aside") {
    place.program->Stop("Your simulation was put aside, so the program was stopped.");
    place.seat->PutAside();
  } else if (what == "push" || what == "next") {
    Push(place, what == "next" ? options_.lessons[lesson_] : TextIn(order, "lesson"), text);
  } else if (what == "message") {
    desk.notes.push_back({ClockTime("{:%H:%M}"), PrintableLines(text, kMaxNoteBytes)});
    if (desk.notes.size() > kMaxNotes) desk.notes.erase(desk.notes.begin());
  } else if (what == "lower_hand") {
    RaiseHand(name, false);
  }
}

}  // namespace coopdyn
