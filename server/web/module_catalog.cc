// SPDX-License-Identifier: MIT
#include "server/web/module_catalog.h"

#include <utility>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/web/access.h"

namespace coopdyn {
namespace {

ResolvedCall Answer(Message message, std::string note = {}) {
  return {.send = false, .message = std::move(message), .note = std::move(note), .changes = false};
}

ResolvedCall Refuse(Error error, std::string text) {
  return Answer(ErrorReply(command::kUnreadable, error, std::move(text)));
}

ResolvedCall Send(Message message, const CommandTable& table) {
  const CommandSpec* spec = table.Find(message.command);
  const bool changes = spec == nullptr || !IsReadingCommand(spec->name);
  return {.send = true, .message = std::move(message), .note = {}, .changes = changes};
}

ResolvedCall ReadLine(const std::string& line, const CommandTable& table) {
  Decoded decoded = DecodeText(line + "\n", table, false);
  switch (decoded.status) {
    case DecodeStatus::kMessage:
      return Send(std::move(decoded.message), table);
    case DecodeStatus::kBad:
    case DecodeStatus::kFatal:
      return Answer(std::move(decoded.message));
    case DecodeStatus::kHelp:
      return Answer({}, HelpText(table));
    case DecodeStatus::kVerbose: {
      ResolvedCall answer = Answer({}, "# from now on every reply is explained");
      answer.verbose = true;
      return answer;
    }
    case DecodeStatus::kLeave:
      return Answer({}, "# close this window to leave");
    case DecodeStatus::kNothing:
    case DecodeStatus::kNeedMore:
      break;
  }
  return Answer({}, "# type help to see the commands");
}

}  // namespace

const CommandTable* TableOfModule(std::string_view name) {
  return FindModuleTable(name.substr(name.rfind('/') + 1));
}

ResolvedCall ResolveCall(const PageCall& call) {
  const CommandTable* table = TableOfModule(call.module);
  if (table == nullptr) {
    if (call.line || !call.command_name.empty()) {
      return Refuse(Error::kUnknownCommand,
                    "the commands of " + call.module + " are not known by name here: give the number");
    }
    return {.send = true, .message = call.message, .note = {}};
  }
  if (call.line) return ReadLine(*call.line, *table);
  if (call.command_name.empty()) return Send(call.message, *table);
  const CommandSpec* spec = table->Find(call.command_name);
  if (spec == nullptr) {
    const std::string nearest = table->Nearest(call.command_name);
    return Refuse(Error::kUnknownCommand, "unknown command " + call.command_name + " of " + call.module +
                                              (nearest.empty() ? "" : ": did you mean " + nearest + "?"));
  }
  Message message = call.message;
  message.command = spec->id;
  return Send(std::move(message), *table);
}

}  // namespace coopdyn
