// SPDX-License-Identifier: MIT
// The class list: who has which seat, and by which PIN. A text of comma-separated values, which teachers edit
// in a spreadsheet. Pure; any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/diagnostics.h"

namespace coopdyn {

/// A student, or a pair that shares a seat.
struct RollEntry {
  std::string seat = {};   // in addresses and folders: a-z, 0-9, '-' and '_', e.g. "ana"
  std::string name = {};   // as the wall shows it, e.g. "Ana Müller"
  std::string pin = {};    // 4 to 16 letters or digits
  std::string group = {};  // empty: none
  std::string link = {};   // the secret part of the personal link
};

/// Random bytes of this length, in hexadecimal digits or in decimal ones.
struct RandomDigits {
  std::function<std::string(std::size_t)> hex;
  std::function<std::string(std::size_t)> decimal;
};

class Roll {
 public:
  static constexpr std::size_t kMaxSeats = 500;

  /// A free seat's name for a student of this name.
  std::string FreeSeat(std::string_view name) const;
  const std::vector<RollEntry>& entries() const { return entries_; }
  const RollEntry* Find(std::string_view seat) const;  // null: no such seat
  /// Whom people mean who write a name as the list has it, with other accents or cases, or that of the seat:
  /// of several, the one with this PIN. Null: nobody.
  const RollEntry* FindNamed(std::string_view name, std::string_view pin) const;
  /// The seat nearest to `seat`, for "did you mean"; empty if none is near.
  std::string Nearest(std::string_view seat) const;
  /// Adds a student; makes a seat's name out of `entry.name`, a PIN and a link where they are empty. Returns
  /// an error text.
  std::string Add(RollEntry entry, const RandomDigits& random);
  /// False: no such seat.
  bool Remove(std::string_view seat);
  /// Gives a seat another PIN and another link; an empty `pin` makes one. Returns an error text.
  std::string SetPin(std::string_view seat, std::string pin, const RandomDigits& random);
  /// The text of the file.
  std::string ToCsv(bool with_secrets = true) const;

 private:
  std::vector<RollEntry> entries_;
};

/// Reads a class list. Its first line names the columns: `name`, and any of `seat`, `pin`, `group`, `link`.
/// Columns are separated by commas, semicolons or tabs. A seat that `known` has keeps PIN and link where the
/// text gives none. Mistakes go to `diagnostics`.
Roll ReadRoll(std::string_view text, const std::string& file, const RandomDigits& random,
              Diagnostics& diagnostics, const Roll& known = {});
/// student1 to studentN.
Roll NumberedRoll(int students, const RandomDigits& random);

/// "ana-muller" for "Ana Müller"; "student" if nothing is left.
std::string SeatNameFor(std::string_view name);
/// What is wrong with a seat's name, a PIN or a link, and what to write instead; empty: nothing.
std::string SeatNameError(std::string_view seat);
std::string PinError(std::string_view pin);
std::string LinkError(std::string_view link);

}  // namespace coopdyn
