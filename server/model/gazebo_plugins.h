// SPDX-License-Identifier: MIT
// What the plug-ins of models and worlds made for Gazebo mean here. One thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/resources.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

/// A `<plugin>` of a model, and the prefix of the names in that.
struct GazeboPlugin {
  XmlNode node;
  std::string scope;
};

/// What a plug-in is, whatever its file is called: the last word of gz::sim::systems::DiffDrive, what is left
/// of libgazebo_ros_diff_drive.so without the words around it. Lower case, without - and _: diffdrive.
std::string PluginWord(const XmlNode& plugin);

/// Plug-ins whose work coopdyn does anyway: they are told in one line.
class NeedlessPlugins {
 public:
  /// Whether `plugin` is one; it is then told of.
  bool Take(const XmlNode& plugin);
  void Say(Diagnostics& diagnostics) const;

 private:
  std::vector<std::string> words_;
  SourceLine first_;
};

/// That `plugin` is not used, and what a model does otherwise without it, if that is known.
std::string UnusedPlugin(const XmlNode& plugin);

/// " (also 2 more times)" of what was left out `count` times; nothing for 1.
std::string MoreTimes(int count);

/// Adds elements of ours to `model` that say what `plugins` do, and tells what is left out, and `needless`.
/// `resources`: where the files are that they name; may be null.
void TranslatePlugins(const std::vector<GazeboPlugin>& plugins, const Resources* resources, XmlNode& model,
                      NeedlessPlugins& needless, Diagnostics& diagnostics);

}  // namespace coopdyn
