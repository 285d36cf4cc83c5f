// SPDX-License-Identifier: MIT
// What the page needs to know of the modules' commands: names to numbers, and what a typed line means.
// Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include "protocol/command_table.h"
#include "server/web/page_message.h"

namespace coopdyn {

/// What to do with a call.
struct ResolvedCall {
  bool send = false;  // `message` goes to the module; else it is the answer
  Message message;
  std::string note;      // with an answer: lines for the console, e.g. help
  bool changes = true;   // needs the right to change something
  bool verbose = false;  // the line was `verbose`
};

/// The commands of the module called `name` ("/robot1/motors"), by its last word; null if unknown.
const CommandTable* TableOfModule(std::string_view name);
/// Reads the line of `call`, or looks up its command's name.
ResolvedCall ResolveCall(const PageCall& call);

}  // namespace coopdyn
