// SPDX-License-Identifier: MIT
// The textures of the floor and things of one scenario, from files or generated. One thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/files/file_reader.h"
#include "server/model/readers.h"
#include "server/model/resources.h"
#include "server/model/section_reader.h"

namespace coopdyn {

class Textures {
 public:
  /// Textures of the scenario or world in `file`. `world`: the world's name in the scenario; empty: the
  /// scenario itself. `beside`: also allow files beside `file`; else only bare names on the search path.
  /// `library` must outlive it; a recording's embedded textures come first.
  Textures(const RobotLibrary& library, const std::string& file, const std::string& world, bool beside);
  /// Without files: only patterns.
  Textures() = default;

  /// The texture given by `texture` and `texture_size`, for a thing of colour `color`. None without these
  /// keys or on an error.
  Texture Read(SectionReader& reader, const Color& color);

  /// The files read so far, in the form in which recordings store them.
  const std::vector<SourceText>& sources() const { return sources_; }

 private:
  struct Loaded {
    std::shared_ptr<const Image> image;  // null if it cannot be read
    std::shared_ptr<const SourceText> source;
  };
  Loaded Load(const std::string& name, std::string& why);

  const RobotLibrary* library_ = nullptr;
  std::optional<Resources> files_;
  std::string file_, world_;
  bool beside_ = false;
  FileReader reader_;
  std::map<std::string, Loaded> known_;
  std::vector<SourceText> sources_;
};

/// The picture of the pattern `name` for a thing of colour `color`; null if the texture needs a file.
std::shared_ptr<const Image> PatternOf(const std::string& name, const Color& color);
/// The picture of an embedded file; null if it is damaged.
std::shared_ptr<const Image> EmbeddedTexture(const SourceText& source);

}  // namespace coopdyn
