// SPDX-License-Identifier: MIT
#include "server/model/experiment.h"

#include <algorithm>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "server/model/mjcf.h"
#include "server/model/resources.h"
#include "server/model/text_file.h"
#include "server/model/values.h"
#include "server/rosiml/translate.h"

namespace coopdyn {

namespace {

/// The XML line from which line `line` of a generated text comes.
int LineIn(std::span<const int> lines, int line) {
  if (line < 1 || lines.empty()) return 0;
  return lines[std::min(static_cast<std::size_t>(line), lines.size()) - 1];
}

/// The length of the XML. [SET] and a line with the file's name may follow it.
std::size_t XmlSize(const std::string& text) {
  constexpr std::string_view kEnd = "</rosiml>";
  const std::size_t end = text.rfind(kEnd);
  if (end == std::string::npos) return text.size();
  for (const std::string_view mark : {"\n[SET]\n", "\n# file: "}) {
    if (const std::size_t at = text.find(mark, end); at != std::string::npos) return at + 1;
  }
  return text.size();
}

/// Reads a generated model. Reports its errors at the lines of the experiment.
std::shared_ptr<const RobotModel> ReadMade(const rosiml::MadeModel& made, const std::string& file,
                                           const Resources* resources, Diagnostics& diagnostics) {
  Diagnostics found;
  auto model = ReadRobotModelText(made.sdf.text, file, made.type, found, resources);
  for (const Diagnostic& one : found.all()) {
    const SourceLine where{file, LineIn(made.sdf.lines, one.where.line)};
    std::string text = "robot '" + made.name + "': " + one.text;
    if (one.level == Diagnostic::Level::kError)
      diagnostics.Error(where, std::move(text));
    else
      diagnostics.Warning(where, std::move(text));
  }
  return model;
}

/// Removes robots without a model and [RANDOM], which may name them: they would only cause more errors.
void LeaveOutWrong(const std::set<std::string>& types, std::vector<Section>& sections) {
  std::erase_if(sections, [&types](const Section& section) {
    if (section.word == "random") return !types.empty();
    const auto type = std::ranges::find(section.entries, "type", &Entry::key);
    return type != section.entries.end() && types.contains(type->value);
  });
}

}  // namespace

bool IsExperiment(const std::string& text, const std::string& file) {
  if (rosiml::IsExperiment(text)) return true;
  // A scenario begins with ; or [.
  if (IsMjcf(text) || text.starts_with(';') || text.starts_with('[')) return false;
  const bool is_xml = ToLower(std::filesystem::path(file).extension().string()) == ".xml";
  return is_xml && text.find("<sdf") == std::string::npos;
}

std::vector<Section> ReadExperiment(const std::string& text, const std::string& file, const std::string& name,
                                    bool has_files, RobotLibrary& library, Diagnostics& diagnostics) {
  const std::size_t size = XmlSize(text);
  const std::string prefix = rosiml::Simple(name, 40) + ".";
  const std::filesystem::path beside = has_files ? std::filesystem::absolute(file).parent_path() : "";
  const auto has_controller = [&](const std::string& controller) {
    return library.path().FindController(controller, beside).has_value();
  };
  auto made = rosiml::TranslateSound(std::string_view(text).substr(0, size), file, prefix, diagnostics,
                                     has_controller);
  if (!made) return {};
  std::optional<Resources> resources;
  if (has_files) resources.emplace(library.path(), file);
  std::set<std::string> wrong;  // types
  for (const rosiml::MadeModel& model : made->models) {
    // A recording embeds its models.
    if (library.Embedded("robot", model.type) != nullptr || library.IsMade(model.type, model.sdf.text))
      continue;
    if (auto read = ReadMade(model, file, resources ? &*resources : nullptr, diagnostics))
      library.AddMade(model.type, model.sdf.text, std::move(read));
    else
      wrong.insert(model.type);
  }
  const bool is_whole = !diagnostics.has_errors();
  int line = static_cast<int>(std::ranges::count(std::string_view(text).substr(0, size), '\n'));
  for (std::string_view rest = std::string_view(text).substr(size); is_whole && !rest.empty();)
    made->scenario.Add(++line, TakeLine(rest));
  std::vector<Section> sections = ReadSections(made->scenario.text, file, diagnostics);
  int part = 0;
  for (Section& section : sections) {
    section.part = ++part;
    section.line = LineIn(made->scenario.lines, section.line);
    for (Entry& entry : section.entries) entry.line = LineIn(made->scenario.lines, entry.line);
  }
  if (!is_whole) LeaveOutWrong(wrong, sections);
  return sections;
}

std::map<std::string, std::shared_ptr<const RobotModel>> ReadExperimentModels(
    const std::filesystem::path& file, const SearchPath& path, Diagnostics& diagnostics) {
  const std::string name = file.string();
  const auto text = ReadTextFile(name, {name, 0}, diagnostics);
  if (!text) return {};
  const auto made =
      rosiml::Translate(std::string_view(*text).substr(0, XmlSize(*text)), name, "", diagnostics);
  std::map<std::string, std::shared_ptr<const RobotModel>> models;
  if (!made) return models;
  const Resources resources(path, file);
  for (const rosiml::MadeModel& model : made->models)
    models[model.name] = ReadMade(model, name, &resources, diagnostics);
  return models;
}

}  // namespace coopdyn
