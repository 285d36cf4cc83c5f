// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

/// Appends `name value unit`, with the word for a number that has one.
void AppendNamed(const ValueSpec* spec, std::size_t index, std::size_t group, const std::string& number,
                 std::int64_t whole, std::string& out) {
  out += out.ends_with(':') ? " " : ", ";
  if (spec == nullptr) {
    out += "value " + number;
    return;
  }
  out += spec->name;
  if (spec->repeated) out += "[" + std::to_string(index / group + 1) + "]";
  out += " " + number;
  if (!spec->unit.empty()) out += " " + spec->unit;
  for (const auto& [word, value] : spec->enums) {
    if (value == whole) out += " (" + word + ")";
  }
}

template <typename Number, typename Print>
void AppendList(std::span<const ValueSpec> specs, std::span<const Number> values, Print print,
                std::string& out) {
  const std::size_t fixed = FixedCount(specs);
  const std::size_t group = std::max<std::size_t>(1, specs.size() - fixed);
  for (std::size_t i = 0; i < values.size(); ++i) {
    AppendNamed(ValueAt(specs, i), i < fixed ? 0 : i - fixed, group, print(values[i]),
                static_cast<std::int64_t>(std::is_integral_v<Number> ? values[i] : -1), out);
  }
}

/// The line of `help` about one command.
std::string HelpLine(const CommandSpec& spec) {
  constexpr std::size_t kColumn = 44;
  std::string line = "#   " + Usage(spec) + "  ";
  line.append(kColumn - std::min(kColumn, CharacterCount(line)), ' ');
  line += spec.help;
  std::string notes;
  for (const ValueSpec& value : spec.data) {
    if (!value.unit.empty()) notes += (notes.empty() ? "" : ", ") + value.name + " " + value.unit;
  }
  for (const ValueSpec& value : spec.params) {
    if (!value.enums.empty()) notes += (notes.empty() ? "" : ", ") + value.name + ": " + ListOfEnums(value);
  }
  if (!notes.empty()) line += " (" + notes + ")";
  const bool is_reading = spec.name.starts_with("get_") && spec.id != command::kGetTime;
  if (is_reading && !spec.reply_data.empty()) line += " → " + ValuesCell(spec.reply_data);
  return line;
}

std::string PrintDouble(double value) {
  std::string text;
  AppendDouble(value, text);
  return text;
}

}  // namespace

void EncodeVerbose(const Message& reply, const CommandTable& table, std::string& out) {
  if (reply.command == command::kClosing) return;  // has no values to name
  const std::int64_t id = reply.command;
  const bool known = id > INT32_MIN;
  const CommandSpec* spec = known ? table.Find(static_cast<std::int32_t>(id < 0 ? -id : id)) : nullptr;
  if (id == command::kUnreadable) spec = nullptr;
  std::string line = "# " + (spec == nullptr ? "command " + std::to_string(id) : spec->name) + ":";
  if (reply.error != 0) {
    line += " error " + std::to_string(reply.error) + ", " + std::string(ErrorMeaning(reply.error));
    out += line + '\n';
    return;
  }
  const std::span<const ValueSpec> params =
      spec == nullptr ? std::span<const ValueSpec>() : spec->reply_params;
  const std::span<const ValueSpec> data = spec == nullptr ? std::span<const ValueSpec>() : spec->reply_data;
  AppendList(
      params, std::span<const std::int32_t>(reply.params), [](std::int32_t v) { return std::to_string(v); },
      line);
  const std::span<const double> values(reply.data);
  if (values.size() < 2) {
    AppendList(data, values, PrintDouble, line);
  } else {
    AppendList(data, values.first(values.size() - 2), PrintDouble, line);
    std::string step = PrintDouble(values.back());
    if (step.ends_with(".0")) step.resize(step.size() - 2);
    line += std::string(line.ends_with(':') ? " " : ", ") + "time_s " +
            PrintDouble(values[values.size() - 2]) + " s, step " + step;
  }
  out += line + '\n';
}

std::string HelpText(const CommandTable& table) {
  std::string help =
      "# This is a " + table.module() +
      " module of coopdyn. One command a line, values separated by spaces, e.g. " +
      ExampleLine(table.commands()[std::min(kCommonCommandCount, table.commands().size() - 1)]) +
      "\n# In [ ] = may be left out; … = any number of them; a text with odd characters: \"text\".\n";
  for (const CommandSpec& spec : table.commands()) help += HelpLine(spec) + '\n';
  help +=
      "#   help                                    Prints this.\n"
      "#   verbose                                 After each reply, prints a # line naming its values and "
      "units.\n"
      "#   exit                                    Closes this connection.\n"
      "# Replies: error \"text\" command M params N data; the last two data are time_s and step. Error 0 is "
      "ok.\n";
  return help;
}

}  // namespace coopdyn
