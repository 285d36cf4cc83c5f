// SPDX-License-Identifier: MIT
// What --set changes of a scenario: SECTION.key=value. Settings stand in the scenario's text, in a [SET] at
// its end, so that a recording has them too. Pure; any thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/section_reader.h"

namespace coopdyn {

using Settings = std::vector<std::string>;

/// The text with a [SET] for `settings`, each SECTION.key=value. Reports those of another form.
std::string WithSettings(std::string text, const Settings& settings, Diagnostics& diagnostics);

/// The settings in the [SET] of a text.
Settings SettingsIn(const std::string& text);

/// Takes the [SET] out of `sections` and gives keys of the others its values: in place of the one that stands
/// there, else as one more; an empty value takes the key away. ROBOTS.key means all robots and swarms.
/// Reports sections that are not there.
void ApplySettings(std::vector<Section>& sections, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn
