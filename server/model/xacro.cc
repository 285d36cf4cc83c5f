// SPDX-License-Identifier: MIT
#include "server/model/xacro.h"

#include "server/base/run_program.h"
#include "server/model/readers.h"
#include "server/model/sdf_parts.h"

namespace coopdyn {

bool IsXacro(std::string_view text, const std::filesystem::path& file) {
  if (file.extension() == ".xacro") return true;
  constexpr std::string_view kBegin = "<!--", kEnd = "-->";
  while (!text.empty()) {
    const std::size_t comment = text.find(kBegin);
    if (text.substr(0, comment).find("<xacro:") != std::string_view::npos) return true;
    if (comment == std::string_view::npos) break;
    const std::size_t end = text.find(kEnd, comment + kBegin.size());
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + kEnd.size());
  }
  return false;
}

std::optional<std::string> ExpandXacro(const std::filesystem::path& file, const SearchPath& path,
                                       Diagnostics& diagnostics) {
  const auto fail = [&](const std::string& text) {
    diagnostics.Error({file.string(), 0}, text);
    return std::nullopt;
  };
  if (path.IsUpload(file)) return fail(kNoXacroUploads);
  NoEnd why = NoEnd::kNone;
  const auto end = RunProgram("xacro", {std::filesystem::absolute(file).string()}, kMaxModelBytes, why);
  if (why == NoEnd::kNoProgram) {
    return fail(
        "this is xacro, and there is no program xacro here: install it (ros-…-xacro, or pip install xacro), "
        "or write it out where there is one: xacro FILE > robot.urdf");
  }
  if (!end) return fail("xacro wrote nothing for a minute, or more than 4 MiB");
  if (!end->succeeded()) return fail("xacro: " + end->LastWords());
  const std::size_t start = end->out.find("<?xml");  // some versions write warnings before it
  return start == std::string::npos ? end->out : end->out.substr(start);
}

}  // namespace coopdyn
