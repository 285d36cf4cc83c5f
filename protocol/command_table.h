// SPDX-License-Identifier: MIT
// What a module declares about its commands. The text codec reads named lines with it, `describe` prints it,
// and the documentation is compared with it. Constant after construction; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace coopdyn {

/// One declared value of a request or reply.
struct ValueSpec {
  std::string name;       // e.g. "linear"
  std::string unit;       // e.g. "m/s"; empty = none
  bool optional = false;  // may be left out (with all that follow it)
  bool repeated = false;  // the last ones, as a group (distance, bearing, distance, …): any number of times
  std::vector<std::pair<std::string, std::int32_t>> enums =
      {};                                                 // words that stand for the only numbers allowed
  double min = -std::numeric_limits<double>::infinity();  // the smallest number allowed
  bool any_number = false;                                // inf and nan are allowed in data
  double max = std::numeric_limits<double>::infinity();   // the largest number allowed
  std::string instead = {};  // said to who gives another word or number than those of `enums`
};

/// How a command uses the text field of a request.
enum class TextUse {
  kNone,      // must be empty
  kRest,      // a named line gives TEXT the rest of the line; params, all optional, stand before in brackets
  kOrNumber,  // TEXT or the params: a token that starts with a letter is TEXT (`get_target red`)
  kFirst,     // an optional TEXT token comes first
};

/// One command of a module.
struct CommandSpec {
  std::int32_t id = 0;
  std::string name;  // [a-z][a-z0-9_]*
  std::string help;  // one sentence
  TextUse text = TextUse::kNone;
  std::string text_name = {};          // what the text of a request is, e.g. "colour"
  std::vector<ValueSpec> params = {};  // of the request
  std::vector<ValueSpec> data = {};    // of the request
  std::vector<ValueSpec> reply_params = {};
  std::vector<ValueSpec> reply_data = {};  // without the final time_s, step
  std::string reply_text = {};             // what the text of the reply is; empty = nothing
  std::string example = {};                // a named line that works; empty = made from the names
  bool text_optional = false;              // kRest only: the text may be empty
  std::string no_push = {};  // why `subscribe` does not take this get-command, and what to do instead
  std::string alias = {};    // a second word for it in named lines; if a command that takes nothing has that
                             // name, then for lines that carry something
};

/// Edits (insert, remove, replace, swap of neighbours) between two words, letters of either case alike.
std::size_t EditDistance(std::string_view a, std::string_view b);

/// The commands of one module: those that every module has, then its own.
class CommandTable {
 public:
  /// @pre ids and names are unique; one with the id of a common command takes that command's place.
  CommandTable(std::string module, std::vector<CommandSpec> own);

  const std::string& module() const { return module_; }  // e.g. "motors"
  std::span<const CommandSpec> commands() const { return commands_; }
  const CommandSpec* Find(std::int32_t id) const;        // null: unknown
  const CommandSpec* Find(std::string_view name) const;  // null: unknown
  /// The first get-command of the module's own: what `subscribe` and `attach` take. @pre it has one
  std::int32_t first_reading() const;
  /// The name most like `name`, for "did you mean"; empty if none is near.
  std::string Nearest(std::string_view name) const;
  /// The text of the reply to `describe`: one JSON object.
  std::string DescribeJson(std::string_view version) const;

 private:
  std::string module_;
  std::vector<CommandSpec> commands_;
};

/// The number of the protocol, in `describe` and `get_status`.
inline constexpr std::int32_t kProtocolVersion = 1;
/// The most steps that one request may stand or wait for.
inline constexpr std::int32_t kMaxSteps = 10'000'000;

/// True if the command only reads, so that everybody may send it: get_…, describe, ping, (un)subscribe,
/// attach, list, pick and the like.
bool IsReadingCommand(std::string_view command_name);

/// Checks text, params and data of a request against its spec: Ok and empty, or the error and what to write
/// instead. Counts and text: errors 2 and 3; numbers below `min` or above `max`, not in `enums` or not
/// finite: error 4.
struct CheckResult {
  std::int32_t error = 0;
  std::string text;
};
CheckResult CheckRequest(const CommandSpec& spec, std::string_view text, std::span<const std::int32_t> params,
                         std::span<const double> data);

/// Edits (insert, remove, replace, swap of neighbours) between two words, letters of either case alike.
std::size_t EditDistance(std::string_view a, std::string_view b);

}  // namespace coopdyn
