// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "server/model/readers.h"
#include "server/model/text_file.h"
#include "server/model/world_sections.h"

namespace coopdyn {

WorldModel ReadWorld(const std::string& text, const std::string& file, Diagnostics& diagnostics) {
  WorldModel world;
  world.file = file;
  std::optional<std::string> decoded = DecodeText(text, {file, 0}, diagnostics);
  if (!decoded) return world;
  world.text = std::move(*decoded);
  const std::vector<Section> sections = ReadSections(world.text, file, diagnostics);
  const auto floor =
      std::find_if(sections.begin(), sections.end(), [](const Section& s) { return s.word == "floor"; });
  const bool degrees = floor != sections.end() && SaysDegrees(*floor, file, diagnostics);
  const std::vector<std::string> own = {"FLOOR"};
  for (const Section& section : sections) {
    if (diagnostics.StopAt({file, section.line})) break;
    SectionReader reader(section, file, degrees, diagnostics);
    if (section.word == "floor") {
      if (!world.floor) world.floor = ReadFloor(reader);
      continue;
    }
    const bool scenarios = section.word == "world" || section.word == "simulation" ||
                           section.word == "target" || IsNumbered(section.word, "robot") ||
                           IsNumbered(section.word, "swarm");
    if (scenarios) {
      reader.Error(reader.title() + " belongs into a .scenario; a .world has [FLOOR] and objects only");
      continue;
    }
    const std::string near = Nearest(section.name, own);
    ObjectSection read = ReadObject(reader, near.empty() ? "" : "; or did you mean [" + near + "]?");
    if (read.object) world.objects.push_back(std::move(*read.object));
    if (read.scattered) world.scattered.push_back(std::move(*read.scattered));
  }
  return world;
}

}  // namespace coopdyn
