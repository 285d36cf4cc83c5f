// SPDX-License-Identifier: MIT
// Worlds and robot models that came over the page: kept in a folder of their own on the search path, which
// goes when the daemon ends. One thread, but for folder().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

/// What became of an upload.
struct Upload {
  unsigned status = 200;  // of HTTP
  std::string text = {};  // why it was refused
  std::string kind = {};  // world or robot
  std::string name = {};  // of the file, or the type of the robot; not always as it was sent
  std::filesystem::path file = {};
};

class Uploads {
 public:
  static constexpr std::size_t kMaxFiles = 200;
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{256} << 20;  // all together
  static constexpr std::size_t kMaxName = 63;

  /// A folder that nobody can guess; it is made with the first upload.
  static std::filesystem::path ChooseFolder();

  /// `folder`: the last one of `path`.
  Uploads(std::filesystem::path folder, SearchPath path)
      : folder_(std::move(folder)), path_(std::move(path)) {}
  /// Removes the folder.
  ~Uploads();
  Uploads(const Uploads&) = delete;
  Uploads& operator=(const Uploads&) = delete;

  /// Keeps the text of a .world, .sdf or .urdf. It gets another name if its own is taken on the path.
  Upload Keep(const std::string& name, const std::string& text);
  /// Forgets what Keep() has kept.
  void Remove(const Upload& upload);
  /// Writes `text` into a file called `name` outside the path, to be looked into; empty: it cannot be.
  std::filesystem::path Scratch(const std::string& name, const std::string& text);

  /// Why a file `name` with this text is not taken; empty if it is.
  static std::string Objection(const std::string& name, const std::string& text);

 private:
  /// The first of NAME, NAME_2, … that is free.
  std::string FreeName(const std::string& stem, const std::string& extension, bool robot) const;
  bool Write(const std::filesystem::path& file, const std::string& text);

  const std::filesystem::path folder_;
  const SearchPath path_;
  std::size_t files_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace coopdyn
