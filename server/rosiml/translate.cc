// SPDX-License-Identifier: MIT
#include "server/rosiml/translate.h"

#include <algorithm>

#include "server/rosiml/grammar.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/write_scenario.h"
#include "server/rosiml/xml.h"

namespace coopdyn::rosiml {

bool IsExperiment(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\r\n";
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
    const bool comment = text.starts_with("<!--");
    if (!comment && !text.starts_with("<?") && !text.starts_with("<!DOCTYPE")) break;
    const std::string_view end = comment ? "-->" : ">";
    const std::size_t at = text.find(end, comment ? 4 : 2);
    if (at == std::string_view::npos) return false;
    text.remove_prefix(at + end.size());
  }
  constexpr std::string_view kRoot = "<rosiml";
  return text.starts_with(kRoot) && text.find_first_of(" \t\r\n/>") == kRoot.size();
}

std::optional<Translation> TranslateSound(std::string_view text, const std::string& file,
                                          const std::string& prefix, Diagnostics& diagnostics,
                                          const HasController& has_controller) {
  Diagnostics found(file);
  tinyxml2::XMLDocument document;
  std::optional<Translation> made;
  if (Element* const root = Parse(text, file, document, found)) {
    const Dialect dialect = DialectOf(*root);
    CheckGrammar(*root, dialect, file, found);
    const Experiment experiment = dialect == Dialect::kPaper ? ReadPaper(*root, file, found)
                                                             : ReadPublic(*root, file, has_controller, found);
    // Of more mistakes not all lines are known.
    if (found.errors() < static_cast<int>(Diagnostics::kMaxKept))
      made = WriteScenario(experiment, file, prefix, found);
  }
  diagnostics.Append(found);
  return made;
}

std::optional<Translation> Translate(std::string_view text, const std::string& file,
                                     const std::string& prefix, Diagnostics& diagnostics,
                                     const HasController& has_controller) {
  const int before = diagnostics.errors();
  auto made = TranslateSound(text, file, prefix, diagnostics, has_controller);
  return diagnostics.errors() > before ? std::nullopt : std::move(made);
}

}  // namespace coopdyn::rosiml
