// SPDX-License-Identifier: MIT
#include "server/host/roll.h"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/ascii.h"
#include "server/base/printable.h"
#include "server/base/words.h"

namespace coopdyn {
namespace {

constexpr std::size_t kMaxSeatName = 32, kMaxPersonName = 80, kPinDigits = 4, kLinkDigits = 24,
                      kShortestLink = 16, kLongestLink = 64;
constexpr std::size_t kMaxColumns = 1000;
constexpr std::array<std::string_view, 5> kColumns = {"seat", "name", "pin", "group", "link"};

std::string* FieldOf(RollEntry& entry, std::string_view column) {
  if (column == "seat") return &entry.seat;
  if (column == "name") return &entry.name;
  if (column == "pin") return &entry.pin;
  if (column == "group") return &entry.group;
  if (column == "link") return &entry.link;
  return nullptr;
}

/// The fields of one record (RFC 4180), which is taken off `text`. False: a quote is not closed.
bool TakeRecord(std::string_view& text, char separator, std::vector<std::string>& fields, int& lines) {
  fields.assign(1, {});
  bool quoted = false;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    if (c == '\n') ++lines;
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (text.starts_with('"')) {
        fields.back() += '"';
        text.remove_prefix(1);
      } else {
        quoted = false;
      }
    } else if (c == '"' && fields.back().empty()) {
      quoted = true;
    } else if (c == separator) {
      fields.emplace_back();
    } else if (c == '\n') {
      return true;
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return !quoted;
}

std::string Quoted(const std::string& field) {
  if (field.find_first_of(",\"\n\r;\t") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

/// The letters that Latin-1 adds to ASCII, without their accents.
std::string_view WithoutAccent(std::string_view character) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kPlain = {{{"àáâãäåÀÁÂÃÄÅ", "a"},
                                                                                     {"çÇčćČĆ", "c"},
                                                                                     {"èéêëÈÉÊËęĘ", "e"},
                                                                                     {"ìíîïÌÍÎÏıİ", "i"},
                                                                                     {"ñÑńŃ", "n"},
                                                                                     {"òóôõöøÒÓÔÕÖØ", "o"},
                                                                                     {"ùúûüÙÚÛÜ", "u"},
                                                                                     {"ýÿÝ", "y"},
                                                                                     {"ß", "ss"},
                                                                                     {"æÆ", "ae"},
                                                                                     {"œŒ", "oe"},
                                                                                     {"šŠśŚşŞ", "s"},
                                                                                     {"žŽżŻźŹ", "z"},
                                                                                     {"łŁ", "l"},
                                                                                     {"ðÐđĐ", "d"},
                                                                                     {"ğĞ", "g"}}};
  for (const auto& [accented, plain] : kPlain) {
    if (accented.find(character) != std::string_view::npos) return plain;
  }
  return "-";
}

}  // namespace

std::string SeatNameFor(std::string_view name) {
  std::string seat;
  while (!name.empty()) {
    const std::size_t length = std::max<std::size_t>(Utf8CharacterLength(name), 1);
    const std::string_view character = name.substr(0, length);
    name.remove_prefix(length);
    const char c = ToLower(character.front());
    const std::string_view plain = length > 1                 ? WithoutAccent(character)
                                   : IsLower(c) || IsDigit(c) ? std::string_view(&c, 1)
                                                              : std::string_view("-");
    if (plain != "-" || (!seat.empty() && seat.back() != '-')) seat += plain;
  }
  seat.resize(std::min(seat.size(), kMaxSeatName - 4));  // room for a number
  while (seat.ends_with('-')) seat.pop_back();
  return seat.empty() ? "student" : seat;
}

std::string SeatNameError(std::string_view seat) {
  const bool good = !seat.empty() && seat.size() <= kMaxSeatName && (IsLower(seat[0]) || IsDigit(seat[0])) &&
                    std::all_of(seat.begin(), seat.end(),
                                [](char c) { return IsLower(c) || IsDigit(c) || c == '-' || c == '_'; });
  if (good) return {};
  return "a seat's name has 1 to " + std::to_string(kMaxSeatName) +
         " of a-z, 0-9, - and _, and begins with a letter or digit, e.g. " + SeatNameFor(seat) + ", not '" +
         Printable(seat, 60) + "'";
}

std::string PinError(std::string_view pin) {
  const bool good = pin.size() >= 4 && pin.size() <= 16 && std::all_of(pin.begin(), pin.end(), [](char c) {
                      return IsDigit(c) || IsLower(c) || IsUpper(c);
                    });
  return good ? "" : "a PIN has 4 to 16 letters or digits, e.g. 7305, not '" + Printable(pin, 40) + "'";
}

std::string LinkError(std::string_view link) {
  const bool good =
      link.size() >= kShortestLink && link.size() <= kLongestLink &&
      std::all_of(link.begin(), link.end(), [](char c) { return IsDigit(c) || IsLower(c) || IsUpper(c); });
  return good ? "" : "a link has 16 to 64 letters and digits: leave it empty, and one is made";
}

const RollEntry* Roll::Find(std::string_view seat) const {
  const auto found = std::ranges::find(entries_, seat, &RollEntry::seat);
  return found == entries_.end() ? nullptr : &*found;
}

const RollEntry* Roll::FindNamed(std::string_view name, std::string_view pin) const {
  const std::string plain = SeatNameFor(name);
  // What has none of our letters is compared as it is, or everybody would be called so.
  const bool has_letters = plain != SeatNameFor({});
  const RollEntry* found = nullptr;
  for (const RollEntry& entry : entries_) {
    const bool same =
        entry.seat == name || entry.name == name || (has_letters && SeatNameFor(entry.name) == plain);
    if (same && (found == nullptr || entry.pin == pin)) found = &entry;
  }
  return found;
}

std::string Roll::FreeSeat(std::string_view name) const {
  const std::string plain = SeatNameFor(name);
  std::string seat = plain;
  for (int n = 2; Find(seat) != nullptr; ++n) seat = plain + std::to_string(n);
  return seat;
}

std::string Roll::Nearest(std::string_view seat) const {
  std::vector<std::string> names;
  for (const RollEntry& entry : entries_) names.push_back(entry.seat);
  return coopdyn::Nearest(seat, names);
}

std::string Roll::Add(RollEntry entry, const RandomDigits& random) {
  if (entries_.size() >= kMaxSeats) return "a class has at most " + std::to_string(kMaxSeats) + " seats";
  if (entry.name.empty()) entry.name = entry.seat;
  if (entry.name.empty()) return "a student needs a name";
  entry.name = Printable(entry.name, kMaxPersonName);
  entry.group = Printable(entry.group, kMaxPersonName);
  if (entry.seat.empty()) entry.seat = FreeSeat(entry.name);
  if (std::string error = SeatNameError(entry.seat); !error.empty()) return error;
  if (Find(entry.seat) != nullptr) return "the seat " + entry.seat + " is there already";
  if (entry.pin.empty()) entry.pin = random.decimal(kPinDigits);
  if (std::string error = PinError(entry.pin); !error.empty()) return error;
  if (entry.link.empty()) {
    entry.link = random.hex(kLinkDigits);
  } else if (std::string error = LinkError(entry.link); !error.empty()) {
    return error;
  } else if (const auto same = std::ranges::find(entries_, entry.link, &RollEntry::link);
             same != entries_.end()) {
    return "this is the link of " + same->seat + ": leave it empty, and one is made";
  }
  entries_.push_back(std::move(entry));
  return {};
}

bool Roll::Remove(std::string_view seat) {
  return std::erase_if(entries_, [seat](const RollEntry& entry) { return entry.seat == seat; }) > 0;
}

std::string Roll::SetPin(std::string_view seat, std::string pin, const RandomDigits& random) {
  const auto found = std::ranges::find(entries_, seat, &RollEntry::seat);
  if (found == entries_.end()) {
    const std::string nearest = Nearest(seat);
    return "there is no seat '" + Printable(seat, 60) + "'" +
           (nearest.empty() ? "" : "; did you mean " + nearest + "?");
  }
  if (pin.empty()) pin = random.decimal(kPinDigits);
  if (std::string error = PinError(pin); !error.empty()) return error;
  found->pin = std::move(pin);
  found->link = random.hex(kLinkDigits);
  return {};
}

std::string Roll::ToCsv(bool with_secrets) const {
  std::string text = with_secrets ? "seat,name,pin,group,link\n" : "seat,name,group\n";
  for (const RollEntry& entry : entries_) {
    text += Quoted(entry.seat) + ',' + Quoted(entry.name);
    if (with_secrets) text += ',' + Quoted(entry.pin);
    text += ',' + Quoted(entry.group);
    text += with_secrets ? ',' + Quoted(entry.link) + '\n' : "\n";
  }
  return text;
}

Roll ReadRoll(std::string_view text, const std::string& file, const RandomDigits& random,
              Diagnostics& diagnostics, const Roll& known) {
  Roll roll;
  int line = 1, next = 1;
  const std::string_view first = text.substr(0, text.find('\n'));
  const char separator = first.find(';') != first.npos ? ';' : first.find('\t') != first.npos ? '\t' : ',';
  std::vector<std::string> columns, fields;
  if (!TakeRecord(text, separator, columns, next)) {
    diagnostics.Error({file, 1}, "a quote is not closed");
    return roll;
  }
  if (columns.size() > kMaxColumns) {
    diagnostics.Error({file, 1},
                      "there are " + std::to_string(columns.size()) + " columns: write e.g. name,pin,group");
    return roll;
  }
  for (std::string& column : columns) {
    column = ToLower(Trim(column));
    RollEntry any;
    if (!column.empty() && FieldOf(any, column) == nullptr) {
      const std::vector<std::string> known(kColumns.begin(), kColumns.end());
      diagnostics.Warning(
          {file, 1}, "the column '" + Printable(column, 40) + "' is not used" + DidYouMean(column, known));
    }
  }
  if (std::ranges::find(columns, "name") == columns.end() &&
      std::ranges::find(columns, "seat") == columns.end()) {
    diagnostics.Error({file, 1}, "the first line names the columns: write e.g. name,pin,group");
    return roll;
  }
  while (!text.empty() && !diagnostics.StopAt({file, next})) {
    line = next;
    if (!TakeRecord(text, separator, fields, next)) {
      diagnostics.Error({file, line}, "a quote is not closed");
      return roll;
    }
    if (fields.size() == 1 && Trim(fields[0]).empty()) continue;
    if (fields.size() > columns.size()) {
      diagnostics.Error({file, line}, "this line has " + std::to_string(fields.size()) +
                                          " fields, the first line names " + std::to_string(columns.size()));
      continue;
    }
    RollEntry entry;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (std::string* const field = FieldOf(entry, columns[i])) *field = Trim(fields[i]);
    }
    if (entry.seat.empty() && !entry.name.empty()) entry.seat = roll.FreeSeat(entry.name);
    if (const RollEntry* const before = known.Find(entry.seat)) {
      const bool same_pin = entry.pin.empty() || entry.pin == before->pin;
      if (entry.pin.empty()) entry.pin = before->pin;
      if (entry.link.empty() && same_pin) entry.link = before->link;
    }
    if (std::string error = roll.Add(std::move(entry), random); !error.empty())
      diagnostics.Error({file, line}, std::move(error));
  }
  if (roll.entries().empty() && !diagnostics.has_errors())
    diagnostics.Error({file, line}, "there are no students: write one on each line below the first");
  return roll;
}

Roll NumberedRoll(int students, const RandomDigits& random) {
  Roll roll;
  for (int n = 1; n <= students; ++n)
    roll.Add({.seat = "student" + std::to_string(n), .name = "Student " + std::to_string(n)}, random);
  return roll;
}

}  // namespace coopdyn
