// SPDX-License-Identifier: MIT
#include "server/model/controller_line.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "controller";
constexpr const char* kExample = "controller diffuse speed=0.2";

bool IsOptionName(const std::string& name) {
  constexpr std::size_t kMaxName = 63;
  return !name.empty() && name.size() <= kMaxName && name.front() >= 'a' && name.front() <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// Of a path as written: `\` means `/`, .so may be left out.
fs::path WithExtension(std::string written) {
  std::replace(written.begin(), written.end(), '\\', '/');
  return written.ends_with(".so") ? written : written + ".so";
}

/// Finds the files of one section's controller.
class FileFinder {
 public:
  FileFinder(SectionReader& reader, const RobotLibrary& library, const std::optional<fs::path>& beside)
      : reader_(reader), library_(library), beside_(beside) {}

  /// Empty, and said, if it is not there.
  std::string Find(const std::string& written) const {
    const std::string name = fs::path(WithExtension(written)).stem().string();
    if (written.find_first_of("/\\") == std::string::npos) return FindByName(name);
    if (!beside_) {
      reader_.ErrorAt(kKey,
                      "a scenario sent over a socket names its controller by the bare name of one on the "
                      "search path, for example: " +
                          std::string(kExample));
      return {};
    }
    // An absolute path stays as it is.
    const fs::path file = (*beside_ / WithExtension(written)).lexically_normal();
    std::error_code code;
    if (fs::is_regular_file(file, code)) return file.string();
    // A recording may be read where its run's folders are not.
    if (library_.is_of_recording()) return FindByName(name);
    Missing("there is no controller '" + written + "': the file " + file.string() + " is missing");
    return {};
  }

 private:
  std::string FindByName(const std::string& name) const {
    const SearchPath& path = library_.path();
    const fs::path folder = beside_.value_or(fs::path());
    if (const auto found = path.FindController(name, folder)) return found->string();
    const std::vector<std::string> known = path.ControllerNames(folder);
    const std::string near = Nearest(name, known);
    std::string text = "there is no controller '" + name + "' " + (beside_ ? "beside the scenario or " : "") +
                       "on the search path";
    if (!near.empty()) text += "; did you mean '" + near + "'?";
    text += near.empty() ? "; " : " ";
    text += known.empty() ? "none is there: coopdyn new-controller NAME writes a start"
                          : "There are " + JoinNames(known);
    Missing(std::move(text));
    return {};
  }
  void Missing(std::string text) const {
    if (library_.is_of_recording()) {
      reader_.WarningAt(kKey, std::move(text));
    } else {
      reader_.ErrorAt(kKey, std::move(text));
    }
  }

  SectionReader& reader_;
  const RobotLibrary& library_;
  const std::optional<fs::path>& beside_;
};

}  // namespace

ControllerChoice ReadController(SectionReader& reader, const RobotLibrary& library,
                                const std::optional<fs::path>& beside) {
  ControllerChoice choice;
  const std::optional<std::string> text = reader.Text(kKey);
  if (!text) return choice;
  choice.where = reader.LineOf(kKey);
  const std::vector<std::string> words = SplitWords(*text);
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t equals = word.find('=');
    const std::string name = ToLower(word.substr(0, std::min(equals, word.size())));
    if (equals == std::string::npos || equals + 1 == word.size() || !IsOptionName(name)) {
      reader.ErrorAt(kKey, "'controller': options are written name=value without spaces, for example: " +
                               std::string(kExample) + "; not '" + word + "'");
      return choice;
    }
    const ParsedNumber value = ParseNumber(std::string_view(word).substr(equals + 1), Quantity::kAny);
    if (!value.error.empty()) reader.ErrorAt(kKey, "'controller', option '" + name + "': " + value.error);
    const bool twice = std::any_of(choice.options.begin(), choice.options.end(),
                                   [&](const auto& option) { return option.first == name; });
    if (twice) reader.ErrorAt(kKey, "'controller': option '" + name + "' stands twice: keep one");
    choice.options.emplace_back(name, value.value);
  }
  choice.file = FileFinder(reader, library, beside).Find(words.front());
  choice.name = fs::path(WithExtension(words.front())).stem().string();
  return choice;
}

}  // namespace coopdyn
