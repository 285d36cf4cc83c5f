// SPDX-License-Identifier: MIT
// The pictures on the floor and the things of one scenario: from files, or made. One thread.
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
  /// Of the scenario or world in `file`, which the scenario calls `world` (empty: of the scenario itself).
  /// `beside`: files lie beside it too; else only bare names on the search path will do. `library` outlives
  /// it: what a recording carries comes first.
  Textures(const RobotLibrary& library, const std::string& file, const std::string& world, bool beside);
  /// Without files: patterns alone.
  Textures() = default;

  /// The texture that `texture` and `texture_size` say, on what has `color`; none without the key, and with
  /// an error.
  Texture Read(SectionReader& reader, const Color& color);

  /// The files that were read, as a recording carries them.
  const std::vector<SourceText>& sources() const { return sources_; }

 private:
  struct Loaded {
    std::shared_ptr<const Image> image;  // null: it cannot be read
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

/// The picture of the texture called `name` on what has `color`, if it needs no file; else null.
std::shared_ptr<const Image> PatternOf(const std::string& name, const Color& color);
/// That of an embedded file; null if it is damaged.
std::shared_ptr<const Image> EmbeddedTexture(const SourceText& source);

}  // namespace coopdyn
