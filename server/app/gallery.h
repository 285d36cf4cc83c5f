// SPDX-License-Identifier: MIT
// The worlds, scenarios and robots on the search path with titles, counts and pictures, cached until their
// files change. One thread, except TextOf().
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "server/model/readers.h"
#include "server/state/image_board.h"

namespace coopdyn {

/// The names of `what` on a search path: "scenarios", "worlds" or "robots".
std::vector<std::string> NamesOf(const SearchPath& path, const std::string& what);

enum class GalleryKind { kWorld, kScenario, kRobot };

class Gallery {
 public:
  static constexpr std::size_t kMaxListed = 1000;  // per kind
  static constexpr std::size_t kMaxKept = 300;     // cached pictures
  static constexpr int kWidth = 320, kHeight = 200;

  /// `draw`: null without pictures. `path` must outlive the gallery.
  Gallery(const SearchPath& path, DrawImage draw) : path_(path), draw_(std::move(draw)) {}

  /// {"worlds":[{"name":…,"title":…,"summary":…,"thumb":…}],"scenarios":[…],"robots":[…]}; incomplete if
  /// `stop` is requested.
  std::string List(const std::stop_token& stop = {});
  /// A PNG, or an error. `kind`: world, scenario or robot.
  ImageResult Thumb(const std::string& kind, const std::string& name);

  /// The text of a world or a scenario; nullopt if the name is unknown. Any thread.
  std::optional<std::string> TextOf(const std::string& kind, const std::string& name) const;

  /// The first sentence of the leading comment of a file: lines with #, or the first XML comment that is not
  /// about a licence.
  static std::string TitleOf(const std::string& text);

 private:
  struct Known {
    std::filesystem::file_time_type written;
    std::string title, summary;
  };
  struct Picture {
    std::filesystem::file_time_type written;
    ImageResult result;
  };

  std::vector<std::string> NamesOf(GalleryKind kind) const;
  std::filesystem::path FileOf(GalleryKind kind, const std::string& name) const;
  const Known& Look(GalleryKind kind, const std::string& name, const std::filesystem::path& file,
                    RobotLibrary& robots);
  ImageResult Draw(GalleryKind kind, const std::filesystem::path& file) const;

  const SearchPath& path_;
  const DrawImage draw_;
  std::map<std::filesystem::path, Known> known_;
  std::map<std::filesystem::path, Picture> pictures_;
};

}  // namespace coopdyn
