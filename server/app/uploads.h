// SPDX-License-Identifier: MIT
// Worlds and robot models uploaded through the page, kept in their own folder on the search path until the
// daemon ends. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

/// The result of an upload.
struct Upload {
  unsigned status = 200;  // HTTP status
  std::string text = {};  // why it was rejected
  std::string kind = {};  // world or robot
  std::string name = {};  // file name or robot type; may differ from the sent name
  std::filesystem::path file = {};
};

class Uploads {
 public:
  static constexpr std::size_t kMaxFiles = 200;
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{256} << 20;  // total
  static constexpr std::size_t kMaxName = 63;

  /// Chooses an unguessable folder name. The first upload makes the folder.
  static std::filesystem::path ChooseFolder();

  /// `folder` must be the last one of `path`.
  Uploads(std::filesystem::path folder, SearchPath path)
      : folder_(std::move(folder)), path_(std::move(path)) {}
  /// Removes the folder.
  ~Uploads();
  Uploads(const Uploads&) = delete;
  Uploads& operator=(const Uploads&) = delete;

  /// Keeps the text of a .world, .sdf or .urdf, under another name if its name is taken on the path.
  Upload Keep(const std::string& name, const std::string& text);
  /// Removes an upload kept by Keep().
  void Remove(const Upload& upload);
  /// Writes `text` to a file called `name` outside the path, for checking; empty on failure.
  std::filesystem::path Scratch(const std::string& name, const std::string& text);

  /// Why a file `name` with this text is rejected; empty if it is accepted.
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
