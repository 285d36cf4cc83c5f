// SPDX-License-Identifier: MIT
// Reads YARS experiments (server/rosiml) as scenarios. The text remains one unchanged XML with all its
// robots. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/readers.h"
#include "server/model/section_reader.h"

namespace coopdyn {

/// True if a text is an experiment: by its root element, or because its file ends in .xml and the text is
/// neither SDF nor MJCF nor a scenario.
bool IsExperiment(const std::string& text, const std::string& file);

/// The sections of the scenario in `text`, with the lines of the XML, and the [SET] after the XML. Adds the
/// robots' models to `library`; their types begin with `name`. `has_files`: false if the text came without
/// the meshes and controllers that it names.
std::vector<Section> ReadExperiment(const std::string& text, const std::string& file, const std::string& name,
                                    bool has_files, RobotLibrary& library, Diagnostics& diagnostics);

/// The models in an experiment's file, by robot name.
std::map<std::string, std::shared_ptr<const RobotModel>> ReadExperimentModels(
    const std::filesystem::path& file, const SearchPath& path, Diagnostics& diagnostics);

}  // namespace coopdyn
