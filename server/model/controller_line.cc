// SPDX-License-Identifier: MIT
// Reads `controller NAME option=value …` of a robot's or swarm's section, and `supervisor` of [SIMULATION].
#include <algorithm>
#include <system_error>

#include "server/model/robot_sections.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// An example line for messages.
std::string ExampleOf(const std::string& key) {
  return key + (key == kSupervisorKey ? " referee rounds=3" : " diffuse speed=0.2");
}

bool IsOptionName(const std::string& name) {
  constexpr std::size_t kMaxName = 63;
  return !name.empty() && name.size() <= kMaxName && name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// A path as written, with `\` replaced by `/` and the extension .so added if missing.
fs::path WithExtension(std::string written) {
  std::replace(written.begin(), written.end(), '\\', '/');
  return written.ends_with(".so") ? written : written + ".so";
}

/// The file of the controller `written`. Reports a missing file and returns an empty text.
std::string FindFile(const std::string& written, const std::string& key, SectionReader& reader,
                     const RobotLibrary& library, const std::optional<fs::path>& beside) {
  const auto missing = [&](std::string text) {
    if (library.is_of_recording()) {
      reader.WarningAt(key, std::move(text));
    } else {
      reader.ErrorAt(key, std::move(text));
    }
    return std::string();
  };
  if (written.find_first_of("/\\") != std::string::npos) {
    if (!beside) {
      reader.ErrorAt(key,
                     "a scenario sent over a socket names its controller by the bare name of one on the "
                     "search path, for example: " +
                         ExampleOf(key));
      return {};
    }
    // operator/ keeps an absolute path unchanged.
    const fs::path file = (*beside / WithExtension(written)).lexically_normal();
    std::error_code code;
    if (fs::is_regular_file(file, code)) return file.string();
    // A recording may be read without its run's folders: then look for the name.
    if (!library.is_of_recording()) {
      return missing("there is no controller '" + written + "': the file " + file.string() + " is missing");
    }
  }
  const std::string name = WithExtension(written).stem().string();
  const fs::path folder = beside.value_or(fs::path());
  if (const auto found = library.path().FindController(name, folder)) return found->string();
  const std::vector<std::string> known = library.path().ControllerNames(folder);
  const std::string near = Nearest(name, known);
  return missing("there is no controller '" + name + "' " + (beside ? "beside the scenario or " : "") +
                 "on the search path" + (near.empty() ? "; " : "; did you mean '" + near + "'? ") +
                 (known.empty() ? "none is there: coopdyn's own are in the folder controllers of its build, "
                                  "which --scenarios FOLDER or COOPDYN_PATH adds; coopdyn new-controller "
                                  "NAME writes a start"
                                : (near.empty() ? "there are " : "There are ") + JoinNames(known)));
}

}  // namespace

ControllerChoice ReadController(SectionReader& reader, const std::string& key, const RobotLibrary& library,
                                const std::optional<fs::path>& beside) {
  ControllerChoice choice;
  const std::optional<std::string> text = reader.Text(key);
  if (!text) return choice;
  choice.where = reader.LineOf(key);
  const std::vector<std::string> words = SplitWords(*text);
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t equals = word.find('=');
    const std::string name = ToLower(word.substr(0, std::min(equals, word.size())));
    if (equals == std::string::npos || equals + 1 == word.size() || !IsOptionName(name)) {
      reader.ErrorAt(key, "'" + key + "': options are written name=value without spaces, for example: " +
                              ExampleOf(key) + "; not '" + word + "'");
      return choice;
    }
    const ParsedNumber value = ParseNumber(std::string_view(word).substr(equals + 1), Quantity::kAny);
    if (!value.error.empty()) reader.ErrorAt(key, "'" + key + "', option '" + name + "': " + value.error);
    const bool twice = std::any_of(choice.options.begin(), choice.options.end(),
                                   [&](const auto& option) { return option.first == name; });
    if (twice) reader.ErrorAt(key, "'" + key + "': option '" + name + "' stands twice: keep one");
    choice.options.emplace_back(name, value.value);
  }
  choice.file = FindFile(words.front(), key, reader, library, beside);
  choice.name = WithExtension(words.front()).stem().string();
  return choice;
}

}  // namespace coopdyn
