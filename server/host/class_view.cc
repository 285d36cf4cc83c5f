// SPDX-License-Identifier: MIT
// What a class shows of itself and keeps on the disk.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "server/base/printable.h"
#include "server/host/class_room.h"
#include "server/host/json_fields.h"

namespace coopdyn {

namespace fs = std::filesystem;
namespace json = boost::json;

namespace {

/// A page that finds its seat put aside leaves it so.
const char* StateWord(const Seat& seat) {
  return seat.put_aside() ? ToString(SeatState::kAsleep) : ToString(seat.state());
}

}  // namespace

ClassRoom::Need ClassRoom::NeedOf(const Place& place) const {
  const Desk& desk = place.desk;
  const Nanoseconds now = clock_.Now();
  const auto minutes = [now](Nanoseconds since) { return (now - since) / (60 * kNanosecondsPerSecond); };
  if (desk.hand_since != 0) return {5, fmt::format("hand up for {} min", minutes(desk.hand_since))};
  if (place.seat->state() == SeatState::kFailed) return {4, place.seat->trouble()};
  if (place.seat->state() == SeatState::kRunning && now - desk.answered > kSilent)
    return {4, fmt::format("its simulation has not answered for {} s: Restart lesson ends it",
                           (now - desk.answered) / kNanosecondsPerSecond)};
  if (desk.resets.size() >= kResets) return {3, fmt::format("{} resets within a minute", desk.resets.size())};
  constexpr Nanoseconds kNew = 2 * 60 * kNanosecondsPerSecond;
  if (!desk.refused.empty() && now - desk.refused_at < kNew) return {2, desk.refused};
  if (!desk.last_error.empty() && now - desk.error_at < kNew) return {2, desk.last_error};
  if (!place.program->error().empty() && now - place.program->ended_at() < kNew)
    return {2, place.program->error()};
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
          {"program", found->second.program->StateJson()},
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
    tile["error"] = place.desk.refused.empty() ? place.desk.last_error : place.desk.refused;
    tile["program"] = place.program->StateJson();
    tile["handed_in"] = CountIn(folder_of(name) / "handed-in");
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
  std::ofstream out(fresh);
  out << json::serialize(kept) << '\n';
  out.close();
  std::error_code code;
  if (out.good()) fs::rename(fresh, file, code);
  if (!out.good() || code)
    logger_->warn("seat {}: {} cannot be written: the raised hand and messages would be lost in a restart",
                  name, file.string());
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
      desk.notes.push_back({TextIn(note.as_object(), "time"), TextIn(note.as_object(), "text")});
  }
}

}  // namespace coopdyn
