// SPDX-License-Identifier: MIT
// Changes of a scenario by --set SECTION.key=value. Settings are stored in a [SET] at the end of the
// scenario's text, so that recordings contain them. Pure; any thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/section_reader.h"

namespace coopdyn {

using Settings = std::vector<std::string>;

/// The text with a [SET] for `settings`, each SECTION.key=value. Reports malformed settings.
std::string WithSettings(std::string text, const Settings& settings, Diagnostics& diagnostics);

/// The settings in the [SET] of a text.
Settings SettingsIn(const std::string& text);

/// Removes the [SET] from `sections` and applies it to the other sections: replaces a key's value, or adds
/// the key; an empty value removes the key. ROBOTS.key means all robots and swarms. Reports unknown sections.
void ApplySettings(std::vector<Section>& sections, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn
