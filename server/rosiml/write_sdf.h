// SPDX-License-Identifier: MIT
// Writes a model as SDF with coopdyn's own elements. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/rosiml/connect.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

struct WrittenModel {
  MadeText sdf;
  bool has_modules = false;  // has modules that a client or controller can use

  void AddModule(int line, const char* type, const std::string& name);
};

/// <tag>text</tag>
std::string Tag(const char* tag, const std::string& text);

WrittenModel WriteSdf(const Movable& movable, const Model& model, const std::string& name,
                      const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
