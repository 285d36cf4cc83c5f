// SPDX-License-Identifier: MIT
// Translates the plugins of models and worlds made for Gazebo. One thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/resources.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

/// A `<plugin>` of a model, and the prefix of the model's names.
struct GazeboPlugin {
  XmlNode node;
  std::string scope;
};

/// The kind of a plugin: the last word of gz::sim::systems::DiffDrive, or the core of a file name such as
/// libgazebo_ros_diff_drive.so. Lower case, without - and _: diffdrive.
std::string PluginWord(const XmlNode& plugin);

/// Collects plugins whose work coopdyn does anyway, for a report in one line.
class NeedlessPlugins {
 public:
  /// If `plugin` is needless, collects it and returns true.
  bool Take(const XmlNode& plugin);
  void Say(Diagnostics& diagnostics) const;

 private:
  std::vector<std::string> words_;
  SourceLine first_;
};

/// Reports that `plugin`, which occurs `count` times, is not used and, if known, how the model then behaves
/// differently.
void LeaveOutPlugin(const XmlNode& plugin, int count, Diagnostics& diagnostics);

/// Adds coopdyn elements equivalent to `plugins` to `model`. Reports omitted and `needless` plugins.
/// `resources`: for the files that plugins name; may be null.
void TranslatePlugins(const std::vector<GazeboPlugin>& plugins, const Resources* resources, XmlNode& model,
                      NeedlessPlugins& needless, Diagnostics& diagnostics);

}  // namespace coopdyn
