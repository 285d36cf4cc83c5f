// SPDX-License-Identifier: MIT

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/ascii.h"
#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "protocol/text_scan.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

/// The module that has the command `word`, e.g. pose for get_pose; empty if none.
std::string ModuleOf(std::string_view word) {
  for (const CommandTable& table : AllModuleTables()) {
    if (table.Find(word) != nullptr) return table.module();
  }
  return "";
}

Message UnknownWord(std::string_view word, const CommandTable& table) {
  std::string text = "unknown command " + Quoted(word);
  if (const std::string module = ModuleOf(word); !module.empty()) {
    text += ": it is a command of " + module + ", not of " + table.module() + " (help lists all of " +
            table.module() + ")";
    return ErrorReply(command::kUnreadable, Error::kUnknownCommand, std::move(text));
  }
  const std::string nearest = table.Nearest(word);
  if (!nearest.empty()) text += ": did you mean " + nearest + "?";
  text += nearest.empty() ? ": help lists all" : " (help lists all)";
  return ErrorReply(command::kUnreadable, Error::kUnknownCommand, std::move(text));
}

/// The number of the enum word `token` of `value`; nullopt if it is not one.
std::optional<std::int32_t> EnumNumber(const ValueSpec* value, std::string_view token) {
  if (value == nullptr) return {};
  const auto found = std::find_if(value->enums.begin(), value->enums.end(),
                                  [token](const auto& word) { return word.first == token; });
  if (found == value->enums.end()) return {};
  return found->second;
}

bool LooksLikeWord(std::string_view token) {
  double value = 0;
  return !token.empty() && IsLetter(token.front()) && ReadDouble(token, value) == NumberRead::kNotNumber;
}

/// Reads a named line of one command.
class NamedReader {
 public:
  NamedReader(const CommandSpec& spec, LineScanner& line) : spec_(spec), line_(line) {
    request_.command = spec.id;
  }

  Message Read() {
    if (spec_.text == TextUse::kRest) {
      if (!spec_.params.empty()) ReadBrackets();
      ReadRest();
    } else if (TakesNothing(spec_) && !line_.AtEnd()) {
      Refuse(Error::kWrongParams, spec_.name + " takes no values: " + ExampleLine(spec_));
    } else {
      ReadBrackets();
      ReadTextToken();
      ReadValues();
    }
    if (problem_) return *std::move(problem_);
    CheckResult check = CheckRequest(spec_, request_.text, request_.params, request_.data);
    if (check.error == 0) return std::move(request_);
    return ErrorReply(spec_.id, static_cast<Error>(check.error), std::move(check.text));
  }

 private:
  void Refuse(Error error, std::string text) {
    if (!problem_) problem_ = ErrorReply(spec_.id, error, std::move(text));
  }
  void Fail(std::string text) {
    if (!problem_) problem_ = Unreadable(std::move(text));
  }

  void ReadRest() {
    if (problem_ || line_.AtEnd()) return;
    if (line_.Peek() != '"') {
      std::string_view rest = line_.rest();
      while (IsBlank(rest.back())) rest.remove_suffix(1);
      request_.text = rest;
      return;
    }
    std::string why = line_.QuotedText(request_.text);
    if (!why.empty()) return Fail(std::move(why));
    if (!line_.AtEnd()) Fail("nothing may follow the closing quote: " + ExampleLine(spec_));
  }

  /// Reads params in brackets, e.g. `(1 2)`, if any.
  void ReadBrackets() {
    if (line_.AtEnd() || line_.Peek() != '(') return;
    line_.Take(1);
    const std::size_t end = line_.rest().find(')');
    if (end == std::string_view::npos) return Fail("the closing bracket is missing: " + ExampleLine(spec_));
    LineScanner inside(line_.Take(end));
    line_.Take(1);
    if (!line_.rest().empty() && !IsBlank(line_.Peek())) {
      return Fail("put a space after the closing bracket: " + ExampleLine(spec_));
    }
    bracketed_ = true;
    while (!problem_ && !inside.AtEnd()) AddParam(spec_.params, request_.params.size(), inside.Token());
  }

  void ReadTextToken() {
    if (problem_ || line_.AtEnd()) return;
    if (line_.Peek() == '"') {
      if (spec_.text == TextUse::kNone) {
        return Refuse(Error::kWrongParams, spec_.name + " takes no text: " + ExampleLine(spec_));
      }
    } else if (spec_.text == TextUse::kNone || !BareTextAhead()) {
      return;
    }
    std::string why = ReadText(line_, request_.text);
    if (!why.empty()) Fail(std::move(why));
  }

  bool BareTextAhead() const {
    LineScanner ahead = line_;
    const std::string_view token = ahead.Token();
    if (spec_.text == TextUse::kOrNumber) return IsLetter(token.front());
    const std::span<const ValueSpec> bare = Bare();
    const ValueSpec* first = bare.empty() ? ValueAt(spec_.data, 0) : ValueAt(bare, 0);
    return LooksLikeWord(token) && !EnumNumber(first, token);
  }

  /// The params without brackets in this line.
  std::span<const ValueSpec> Bare() const {
    return bracketed_ ? std::span<const ValueSpec>() : BareParams(spec_);
  }

  void ReadValues() {
    if (line_.AtEnd() || line_.Peek() != '[') return AddValues(line_);
    // A row as in MATLAB or Python: `[0.2 0.5]` or `[0.2, 0.5]`.
    line_.Take(1);
    const std::size_t end = line_.rest().find(']');
    if (end == std::string_view::npos) return Fail("the closing bracket ] is missing: " + ExampleLine(spec_));
    std::string row(line_.Take(end));
    line_.Take(1);
    if (!line_.AtEnd()) return Fail("nothing may follow the closing bracket ]: " + ExampleLine(spec_));
    std::replace(row.begin(), row.end(), ',', ' ');
    LineScanner inside(row);
    AddValues(inside);
  }

  void AddValues(LineScanner& line) {
    const std::span<const ValueSpec> bare = Bare();
    std::size_t params = 0;
    while (!problem_ && !line.AtEnd()) {
      const std::string_view token = line.Token();
      // Surplus values of a command without data count as params, so that the error names the count.
      if (ValueAt(bare, params) != nullptr || (spec_.data.empty() && !bracketed_)) {
        AddParam(bare, params++, token);
      } else {
        AddData(token);
      }
    }
  }

  void AddParam(std::span<const ValueSpec> values, std::size_t index, std::string_view token) {
    const ValueSpec* value = ValueAt(values, index);
    std::int32_t number = 0;
    if (const auto word = EnumNumber(value, token)) {
      number = *word;
    } else if (value != nullptr && !value->enums.empty() && LooksLikeWord(token)) {
      return RefuseWord(*value, token, Error::kWrongParams);
    } else if (const ValueSpec* next = ValueAt(values, index + 1);
               next != nullptr && !next->enums.empty() && LooksLikeWord(token)) {
      // `subscribe get_limits`
      if (!EnumNumber(next, token)) return RefuseWord(*next, token, Error::kWrongParams);
      return Refuse(Error::kWrongParams, spec_.name + " takes " + value->name + " before " + Quoted(token) +
                                             ": " + spec_.name + " 1 " + std::string(token));
    } else if (std::string why = ReadParam(token, number); !why.empty()) {
      const std::string example = ExampleLine(spec_);
      const bool helps = example.find(bracketed_ ? '(' : ' ') != std::string::npos;
      return Fail(why + (helps ? ", as in " + example : ""));
    }
    request_.params.push_back(number);
  }

  void AddData(std::string_view token) {
    const ValueSpec* value = ValueAt(spec_.data, request_.data.size());
    double number = 0;
    if (const auto word = EnumNumber(value, token)) {
      number = *word;
    } else if (value != nullptr && !value->enums.empty() && LooksLikeWord(token)) {
      return RefuseWord(*value, token, Error::kWrongData);
    } else if (ReadDouble(token, number) == NumberRead::kOutOfRange) {
      return Refuse(Error::kOutOfRange, spec_.name + " takes numbers that a double can hold, " +
                                            Quoted(token) + " is too large: " + ExampleLine(spec_));
    } else if (std::string why = ReadData(token, number); !why.empty()) {
      return Fail(why + ", as in " + ExampleLine(spec_));
    }
    request_.data.push_back(number);
  }

  void RefuseWord(const ValueSpec& value, std::string_view token, Error error) {
    Refuse(error, spec_.name + " needs a " + value.name + ": " + ListOfEnums(value) + ", not " +
                      Quoted(token) + Instead(value) + ": " + ExampleLine(spec_));
  }

  const CommandSpec& spec_;
  LineScanner& line_;
  bool bracketed_ = false;
  Message request_;
  std::optional<Message> problem_;
};

/// The command that `word` names, by name or alias; `has_values`: the line has values.
const CommandSpec* FindCommand(std::string_view word, bool has_values, const CommandTable& table) {
  const CommandSpec* spec = table.Find(word);
  if (spec != nullptr && !(TakesNothing(*spec) && has_values)) return spec;
  for (const CommandSpec& other : table.commands()) {
    if (!other.alias.empty() && other.alias == word) return &other;
  }
  return spec;
}

}  // namespace

Message Unreadable(std::string text) {
  return ErrorReply(command::kUnreadable, Error::kMalformed, std::move(text));
}

std::string ReadText(LineScanner& line, std::string& text) {
  if (line.AtEnd()) return "the text is missing";
  if (line.Peek() == '"') return line.QuotedText(text);
  text = line.Token();
  return "";
}

std::string ReadParam(std::string_view token, std::int32_t& value) {
  switch (ReadInt32(token, value)) {
    case NumberRead::kOk:
      return "";
    case NumberRead::kOutOfRange:
      return Quoted(token) + " is too large for a param: write -2147483648 to 2147483647";
    case NumberRead::kHasPoint: {
      std::string text = Quoted(token) + " must be a whole number";
      const std::string_view whole = token.substr(0, token.find('.'));
      std::int32_t number = 0;
      if (whole.size() < token.size() && ReadInt32(whole, number) == NumberRead::kOk &&
          token.find_first_not_of('0', whole.size() + 1) == std::string_view::npos) {
        text += ": write " + std::string(whole);
      }
      return text;
    }
    case NumberRead::kNotNumber:
      return NotANumber(token);
  }
  return "";
}

std::string ReadData(std::string_view token, double& value) {
  switch (ReadDouble(token, value)) {
    case NumberRead::kOk:
      return "";
    case NumberRead::kOutOfRange:
      return Quoted(token) + " is too large for a double, which ends at 1.8e308";
    case NumberRead::kHasPoint:
    case NumberRead::kNotNumber:
      return NotANumber(token);
  }
  return "";
}

Message ReadNamed(std::string_view word, LineScanner& line, const CommandTable& table) {
  if (const std::size_t bracket = word.find('('); bracket != std::string_view::npos) {
    const CommandSpec* meant = table.Find(word.substr(0, bracket));
    if (meant == nullptr) return UnknownWord(word.substr(0, bracket), table);
    return Unreadable("write a space after " + meant->name +
                      ", and spaces between values: " + ExampleLine(*meant));
  }
  LineScanner ahead = line;
  const CommandSpec* spec = FindCommand(word, !ahead.AtEnd(), table);
  if (spec == nullptr) return UnknownWord(word, table);
  return NamedReader(*spec, line).Read();
}

}  // namespace coopdyn
