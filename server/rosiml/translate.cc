// SPDX-License-Identifier: MIT
#include "server/rosiml/translate.h"

#include <algorithm>

#include "server/base/words.h"
#include "server/rosiml/grammar.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/write_scenario.h"
#include "server/rosiml/xml.h"

namespace coopdyn::rosiml {

bool IsExperiment(std::string_view text) {
  return RootElement(text) == "rosiml";
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
    // With more errors than are kept, the lines of some are unknown.
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
