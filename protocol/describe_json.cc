// SPDX-License-Identifier: MIT
#include "protocol/command_table.h"
#include "protocol/json_text.h"
#include "protocol/message.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

std::string_view TextUseName(TextUse use) {
  switch (use) {
    case TextUse::kNone:
      return "none";
    case TextUse::kRest:
      return "rest";
    case TextUse::kOrNumber:
      return "or_number";
    case TextUse::kFirst:
      return "first";
  }
  return "none";
}

void AppendKey(std::string_view key, std::string& out) {
  if (out.back() != '{') out += ',';
  AppendJsonString(key, out);
  out += ':';
}

void AppendText(std::string_view key, std::string_view text, std::string& out) {
  AppendKey(key, out);
  AppendJsonString(text, out);
}

void AppendBool(std::string_view key, bool value, std::string& out) {
  AppendKey(key, out);
  out += value ? "true" : "false";
}

void AppendValue(const ValueSpec& value, std::string& out) {
  out += '{';
  AppendText("name", value.name, out);
  AppendText("unit", value.unit, out);
  AppendBool("optional", value.optional, out);
  AppendBool("repeated", value.repeated, out);
  AppendKey("min", out);
  AppendJsonNumber(value.min, out);
  AppendKey("max", out);
  AppendJsonNumber(value.max, out);
  AppendKey("enums", out);
  out += '[';
  for (const auto& [word, number] : value.enums) {
    if (out.back() != '[') out += ',';
    out += '{';
    AppendText("word", word, out);
    AppendKey("value", out);
    out += std::to_string(number) + '}';
  }
  out += "]}";
}

void AppendValues(std::string_view key, std::span<const ValueSpec> values, std::string& out) {
  AppendKey(key, out);
  out += '[';
  for (const ValueSpec& value : values) {
    if (out.back() != '[') out += ',';
    AppendValue(value, out);
  }
  out += ']';
}

}  // namespace

void AppendCommandJson(const CommandSpec& spec, std::string& out) {
  out += '{';
  AppendKey("id", out);
  out += std::to_string(spec.id);
  AppendText("name", spec.name, out);
  AppendText("help", spec.help, out);
  AppendText("usage", Usage(spec), out);
  AppendText("example", ExampleLine(spec), out);
  AppendText("text", TextUseName(spec.text), out);
  AppendText("text_name", spec.text_name, out);
  AppendBool("text_optional", spec.text_optional, out);
  AppendValues("params", spec.params, out);
  AppendValues("data", spec.data, out);
  AppendValues("reply_params", spec.reply_params, out);
  AppendValues("reply_data", spec.reply_data, out);
  AppendText("reply_text", spec.reply_text, out);
  out += '}';
}

std::string CommandTable::DescribeJson(std::string_view version) const {
  std::string out = "{";
  AppendKey("protocol", out);
  out += std::to_string(kProtocolVersion);
  AppendText("version", version, out);
  AppendText("module", module_, out);
  const ValueSpec end[] = {{.name = "time_s", .unit = "s"}, {.name = "step", .unit = ""}};
  AppendValues("reply_data_end", end, out);
  AppendKey("commands", out);
  out += '[';
  for (const CommandSpec& spec : commands_) {
    if (out.back() != '[') out += ',';
    AppendCommandJson(spec, out);
  }
  out += "]}";
  return out;
}

}  // namespace coopdyn
