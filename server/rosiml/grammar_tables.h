// SPDX-License-Identifier: MIT
// Both grammars as data: the attributes and children that each element may have. Pure; any thread.
//
// An attribute is NAME:TYPE. A child is NAME or NAME=KIND, where KIND names the row that describes it. NAME!
// is required, and NAME! and NAME? allow a child only once. -NAME is allowed but has no effect, ~NAME is not
// simulated yet. Types: s text, n number, + number above 0, 0 number at least 0, i integer, b true or false,
// c colour RRGGBB, r one number or a minimum and a maximum, or the allowed words a|b (_ is a space). A range
// may follow n, i and +, as in i1..1000. &ROW inserts the words of that row. Limits match those of models and
// scenarios (server/model).
#pragma once

#include <span>
#include <string_view>

#include "server/rosiml/grammar.h"

namespace coopdyn::rosiml {

struct Rule {
  std::string_view kind;  // the element's name, or the KIND that rows give it
  std::string_view attributes;
  std::string_view children;
};

/// The warning for a word marked ~: "WORD is not simulated yet: what".
struct NotYet {
  std::string_view word;
  std::string_view what;
  std::string_view is = "is not simulated yet";
};

std::span<const Rule> RulesOf(Dialect dialect);
std::span<const NotYet> NotSimulatedYet();

}  // namespace coopdyn::rosiml
