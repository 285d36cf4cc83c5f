// SPDX-License-Identifier: MIT
// YARS's experiments (server/rosiml) as scenarios: one XML text, kept as it is, with all its robots. One
// thread.
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

/// Whether a text is such an experiment: by its first element; or its file ends in .xml, and
/// it is no SDF, no file of MuJoCo and no scenario.
bool IsExperiment(const std::string& text, const std::string& file);

/// The sections of the scenario that `text` is, with the lines of the XML, and of what stands behind it:
/// [SET]. Its robots' models go to `library`; their types begin with `name`. Not `has_files`: the text came
/// without the meshes and controllers that it names.
std::vector<Section> ReadExperiment(const std::string& text, const std::string& file, const std::string& name,
                                    bool has_files, RobotLibrary& library, Diagnostics& diagnostics);

/// The models of an experiment's file, by the names of their robots.
std::map<std::string, std::shared_ptr<const RobotModel>> ReadExperimentModels(
    const std::filesystem::path& file, const SearchPath& path, Diagnostics& diagnostics);

}  // namespace coopdyn
