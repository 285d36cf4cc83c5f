// SPDX-License-Identifier: MIT
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "protocol/command_table.h"
#include "protocol/json_text.h"
#include "protocol/message.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

namespace json = boost::json;

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

json::array Values(std::span<const ValueSpec> values) {
  json::array list;
  for (const ValueSpec& value : values) {
    json::array enums;
    for (const auto& [word, number] : value.enums) enums.push_back({{"word", word}, {"value", number}});
    list.push_back({{"name", value.name},
                    {"unit", value.unit},
                    {"optional", value.optional},
                    {"repeated", value.repeated},
                    {"min", value.min},
                    {"max", value.max},
                    {"enums", std::move(enums)}});
  }
  return list;
}

json::object CommandOf(const CommandSpec& spec) {
  return {{"id", spec.id},
          {"name", spec.name},
          {"help", spec.help},
          {"usage", Usage(spec)},
          {"example", ExampleLine(spec)},
          {"text", TextUseName(spec.text)},
          {"text_name", spec.text_name},
          {"text_optional", spec.text_optional},
          {"params", Values(spec.params)},
          {"data", Values(spec.data)},
          {"reply_params", Values(spec.reply_params)},
          {"reply_data", Values(spec.reply_data)},
          {"reply_text", spec.reply_text}};
}

}  // namespace

std::string CommandTable::DescribeJson(std::string_view version) const {
  json::array commands;
  for (const CommandSpec& spec : commands_) commands.push_back(CommandOf(spec));
  const ValueSpec end[] = {{.name = "time_s", .unit = "s"}, {.name = "step", .unit = ""}};
  return JsonText(json::object{{"protocol", kProtocolVersion},
                               {"version", version},
                               {"module", module_},
                               {"reply_data_end", Values(end)},
                               {"commands", std::move(commands)}});
}

}  // namespace coopdyn
