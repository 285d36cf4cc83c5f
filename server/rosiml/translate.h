// SPDX-License-Identifier: MIT
// Translates a YARS experiment, one XML text in the public grammar 0.8 or the YARS paper's grammar, into
// coopdyn's own texts. Pure; any thread.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

/// A robot's model.
struct MadeModel {
  std::string name;
  std::string type;  // its name in the scenario
  MadeText sdf;
  std::vector<std::string> mesh_files;  // as written in the experiment
};

struct Translation {
  MadeText scenario;
  std::vector<MadeModel> models;
};

/// True if a text is an experiment: its root element is <rosiml>.
bool IsExperiment(std::string_view text);

/// True if a loaded controller `name` exists.
using HasController = std::function<bool(const std::string& name)>;

/// Translates `text` into a scenario and models. Returns nullopt if there are errors, all of which are
/// reported. `file`: for messages. A model's type is `prefix` + its name.
std::optional<Translation> Translate(std::string_view text, const std::string& file,
                                     const std::string& prefix, Diagnostics& diagnostics,
                                     const HasController& has_controller = nullptr);
/// The same, but in spite of errors returns the parts without errors, so that the caller can check them too.
std::optional<Translation> TranslateSound(std::string_view text, const std::string& file,
                                          const std::string& prefix, Diagnostics& diagnostics,
                                          const HasController& has_controller = nullptr);

}  // namespace coopdyn::rosiml
