// SPDX-License-Identifier: MIT
// YARS's experiments: one XML text, in the public grammar 0.8 or as the YARS paper tells it, as coopdyn's own
// texts. Pure; any thread.
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
  std::string type;  // as the scenario calls it
  MadeText sdf;
  std::vector<std::string> mesh_files;  // as the experiment names them
};

struct Translation {
  MadeText scenario;
  std::vector<MadeModel> models;
};

/// Whether a text is an experiment: its root element is <rosiml>.
bool IsExperiment(std::string_view text);

/// Whether there is a loaded controller called so.
using HasController = std::function<bool(const std::string& name)>;

/// The scenario and the models of `text`. Nothing, with all mistakes reported, if there are any. `file`: for
/// messages. A model's type is `prefix` and its name.
std::optional<Translation> Translate(std::string_view text, const std::string& file,
                                     const std::string& prefix, Diagnostics& diagnostics,
                                     const HasController& has_controller = nullptr);
/// The same, but with mistakes what has none, so that more can be said of that.
std::optional<Translation> TranslateSound(std::string_view text, const std::string& file,
                                          const std::string& prefix, Diagnostics& diagnostics,
                                          const HasController& has_controller = nullptr);

}  // namespace coopdyn::rosiml
