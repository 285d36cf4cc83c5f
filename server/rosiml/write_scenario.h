// SPDX-License-Identifier: MIT
// Writes an experiment as a scenario and the models of its robots. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/translate.h"

namespace coopdyn::rosiml {

Translation WriteScenario(const Experiment& experiment, const std::string& file, const std::string& prefix,
                          Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
