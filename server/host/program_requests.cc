// SPDX-License-Identifier: MIT
#include "server/host/program_requests.h"

#include <charconv>
#include <optional>

#include "server/host/json_fields.h"

namespace coopdyn {
namespace {

namespace json = boost::json;

/// FROM of "output/FROM".
std::optional<std::uint64_t> OutputFrom(std::string_view what) {
  constexpr std::string_view kOutput = "output/";
  if (!what.starts_with(kOutput)) return std::nullopt;
  std::uint64_t from = 0;
  const char* const end = what.data() + what.size();
  const auto [rest, error] = std::from_chars(what.data() + kOutput.size(), end, from);
  return rest == end && error == std::errc() ? std::optional(from) : std::nullopt;
}

}  // namespace

HttpAnswer AnswerProgram(Program& program, bool post, std::string_view what, const std::string& body,
                         bool teaches) {
  if (!post) {
    if (what.empty()) return JsonAnswer(json::serialize(program.TextJson()));
    if (const auto from = OutputFrom(what)) return JsonAnswer(json::serialize(program.OutputJson(*from)));
    return ErrorAnswer(404, "a page may ask for program, and for program/output/FROM");
  }
  if (what == "stop") {
    program.Stop(teaches ? "The teacher stopped the program." : "The program was stopped.");
    return JsonAnswer(json::serialize(program.StateJson()));
  }
  if (teaches) return ErrorAnswer(403, "this is the student's program: you may read and stop it");
  if (!what.empty() && what != "run")
    return ErrorAnswer(404, "a page may send program, program/run and program/stop");
  const json::object said = ObjectIn(body);
  const json::value* const text = said.if_contains("text");
  if (text == nullptr || !text->is_string())
    return ErrorAnswer(400, "send the program as JSON: {\"text\": …, \"base\": its version before}");
  std::string error = program.Save(std::string_view(text->as_string()), TextIn(said, "base"));
  if (error.empty() && what == "run") error = program.Run();
  return error.empty() ? JsonAnswer(json::serialize(program.StateJson())) : ErrorAnswer(409, error);
}

}  // namespace coopdyn
