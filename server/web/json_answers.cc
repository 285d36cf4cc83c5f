// SPDX-License-Identifier: MIT
#include "server/web/json_answers.h"

#include "protocol/json_text.h"

namespace coopdyn {

HttpAnswer JsonAnswer(std::string body) {
  HttpAnswer answer;
  answer.body = std::move(body);
  answer.type = "application/json";
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

HttpAnswer AnswerScenarios(const WebContext& context) {
  std::string json = "[";
  if (context.options.scenarios) {
    for (const std::string& name : context.options.scenarios()) {
      if (json.size() > 1) json += ',';
      AppendJsonString(name, json);
    }
  }
  return JsonAnswer(json + "]\n");
}

HttpAnswer AnswerModules(const WebContext& context) {
  std::string json = R"({"name_port":)" + std::to_string(context.options.name_port) + R"(,"version":)" +
                     JsonString(context.options.version) + R"(,"modules":[)";
  bool first = true;
  for (const NameEntry& entry : context.names.List()) {
    if (!first) json += ',';
    first = false;
    json += R"({"name":)" + JsonString(entry.name) + R"(,"address":)";
    json += entry.ip.empty() ? "null" : JsonString(entry.ip);
    json += R"(,"port":)" + std::to_string(entry.port);
    json += entry.external ? R"(,"external":true})" : R"(,"external":false})";
  }
  return JsonAnswer(json + "]}\n");
}

}  // namespace coopdyn
