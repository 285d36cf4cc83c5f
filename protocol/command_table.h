// SPDX-License-Identifier: MIT
// A module's command declarations. The text codec reads named lines with them, `describe` prints them, and
// tests compare the documentation with them. Immutable; thread-safe.
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
  bool optional = false;  // may be omitted, with all values after it
  bool repeated = false;  // in the trailing group that repeats any number of times (distance, bearing, …)
  std::vector<std::pair<std::string, std::int32_t>> enums =
      {};  // words for the only numbers allowed; empty: no enum
  double min = -std::numeric_limits<double>::infinity();  // the smallest number allowed
  bool any_number = false;                                // inf and nan are allowed in data
  double max = std::numeric_limits<double>::infinity();   // the largest number allowed
  std::string instead = {};  // advice in the error when a value is not one of `enums`
};

/// How a command uses the text field of a request.
enum class TextUse {
  kNone,  // must be empty
  kRest,  // in a named line TEXT is the rest of the line; the params, all optional, precede it in brackets
  kOrNumber,  // TEXT or the params: a token that starts with a letter is TEXT (`get_target red`)
  kFirst,     // an optional TEXT token comes first
};

/// One command of a module.
struct CommandSpec {
  std::int32_t id = 0;
  std::string name;  // [a-z][a-z0-9_]*
  std::string help;  // one sentence
  TextUse text = TextUse::kNone;
  std::string text_name = {};          // the name of the request's text, e.g. "colour"
  std::vector<ValueSpec> params = {};  // of the request
  std::vector<ValueSpec> data = {};    // of the request
  std::vector<ValueSpec> reply_params = {};
  std::vector<ValueSpec> reply_data = {};  // without the final time_s, step
  std::string reply_text = {};             // the meaning of the reply's text; empty = no text
  std::string example = {};                // a valid named line; empty = generated from the specs
  bool text_optional = false;              // kRest only: the text may be empty
  std::string no_push = {};                // why `subscribe` rejects this get-command, and what to do instead
  std::string alias = {};  // second name in named lines; if a command without values has that name, it
                           // applies only to lines with values
};

/// Edits (insert, remove, replace, swap of neighbours) between two words, letters of either case alike.
std::size_t EditDistance(std::string_view a, std::string_view b);

/// The commands of one module: the common ones, then its own.
class CommandTable {
 public:
  /// @pre ids and names are unique. A command with a common command's id replaces it.
  CommandTable(std::string module, std::vector<CommandSpec> own);

  const std::string& module() const { return module_; }  // e.g. "motors"
  std::span<const CommandSpec> commands() const { return commands_; }
  const CommandSpec* Find(std::int32_t id) const;        // null: unknown
  const CommandSpec* Find(std::string_view name) const;  // null: unknown
  /// The module's first own get-command, the default of `subscribe` and `attach`. @pre the module has one
  std::int32_t first_reading() const;
  /// The command name most similar to `name`, for "did you mean"; empty if none is similar.
  std::string Nearest(std::string_view name) const;
  /// The text of the `describe` reply: one JSON object.
  std::string DescribeJson(std::string_view version) const;

 private:
  std::string module_;
  std::vector<CommandSpec> commands_;
};

/// The protocol version in `describe` and `get_status`.
inline constexpr std::int32_t kProtocolVersion = 1;
/// The maximum number of steps in one request, for commands that hold or wait.
inline constexpr std::int32_t kMaxSteps = 10'000'000;

/// True if the command changes nothing, so any client may send it: get_…, describe, ping, (un)subscribe,
/// attach, list, pick and the like.
bool IsReadingCommand(std::string_view command_name);

/// Checks the text, params and data of a request against its spec. Returns kOk and no text, or an error and
/// what to write instead: 2 or 3 for text and counts; 4 for numbers that are below `min`, above `max`, not in
/// `enums` or not finite.
struct CheckResult {
  std::int32_t error = 0;
  std::string text;
};
CheckResult CheckRequest(const CommandSpec& spec, std::string_view text, std::span<const std::int32_t> params,
                         std::span<const double> data);

/// Edits (insert, remove, replace, swap of neighbours) between two words, letters of either case alike.
std::size_t EditDistance(std::string_view a, std::string_view b);

}  // namespace coopdyn
