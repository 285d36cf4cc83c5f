// SPDX-License-Identifier: MIT
// What may stand where, as data. Pure; any thread.
//
// An attribute is NAME:TYPE, a child NAME or NAME=KIND, the row that says more of it. Behind the name: ! it
// is needed, and of children ! and ? that it stands there once. In front of it: - it changes nothing here, ~
// it is not simulated yet. Types: s text, n a number, + above 0, 0 at least 0, i a whole number, b true or
// false, c a colour RRGGBB, r one number or the least and the most, or the words themselves a|b (_ is a
// space). Behind n, i and + may stand what else the number must lie between, as in i1..1000. &ROW stands for
// all that this row has. Limits are those of models and scenarios (server/model).
#pragma once

#include <span>
#include <string_view>

#include "server/rosiml/grammar.h"

namespace coopdyn::rosiml {

struct Rule {
  std::string_view kind;  // the element's name, or what a row calls it
  std::string_view attributes;
  std::string_view children;
};

/// What is to be said of a word with ~ in front.
struct NotYet {
  std::string_view word;
  std::string_view what;
  std::string_view is = "is not simulated yet";
};

std::span<const Rule> RulesOf(Dialect dialect);
std::span<const NotYet> NotSimulatedYet();

}  // namespace coopdyn::rosiml
