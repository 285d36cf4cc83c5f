// SPDX-License-Identifier: MIT
#include "server/model/xacro.h"

#include <algorithm>

#include "server/base/printable.h"
#include "server/base/run_program.h"
#include "server/base/words.h"
#include "server/model/readers.h"
#include "server/model/sdf_parts.h"

namespace coopdyn {

namespace {

/// The error in xacro's output: it precedes the list of files.
std::string WhatFailed(const ProgramEnd& end) {
  constexpr std::string_view kMark = "error:";
  const std::size_t start = end.error.find(kMark);
  if (start == std::string::npos) return end.LastWords();
  const std::string_view rest = std::string_view(end.error).substr(start + kMark.size());
  constexpr std::size_t kMost = 300;
  const std::string_view line = Trim(rest.substr(0, std::min(rest.find('\n'), kMost)));
  return line.empty() ? end.LastWords() : Printable(line);
}

}  // namespace

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
  if (!end->succeeded()) {
    const std::string what = WhatFailed(*end);
    std::string cure;
    if (what.starts_with("Undefined substitution argument"))
      cure = ": give it one, xacro FILE NAME:=VALUE > robot.urdf, and load that";
    if (what.find("resource not found") != std::string::npos)
      cure = ": xacro finds packages in the folders of ROS_PACKAGE_PATH (ROS 2: AMENT_PREFIX_PATH)";
    return fail("xacro: " + what + cure);
  }
  if (end->out.find("<link") == std::string::npos)
    return fail("xacro wrote no <link>: the file holds macros alone; load the file that uses them");
  const std::size_t start = end->out.find("<?xml");  // some versions write warnings before it
  return start == std::string::npos ? end->out : end->out.substr(start);
}

}  // namespace coopdyn
