// SPDX-License-Identifier: MIT
// The colour words of files.
#include <utility>

#include "server/model/values.h"
#include "server/model/world_model.h"

namespace coopdyn {

namespace {

using NamedEntry = std::pair<const char*, Color>;

/// The first ten are the palette of color_1, color_2, …
constexpr NamedEntry kColors[] = {
    {"red", {1, 0, 0}},
    {"green", {0, 0.8, 0}},
    {"blue", {0, 0, 1}},
    {"yellow", {1, 1, 0}},
    {"magenta", {1, 0, 1}},
    {"cyan", {0, 1, 1}},
    {"orange", {1, 0.55, 0}},
    {"purple", {0.5, 0, 0.7}},
    {"brown", {0.55, 0.27, 0.07}},
    {"pink", {1, 0.6, 0.75}},
    {"white", {1, 1, 1}},
    {"black", {0.05, 0.05, 0.05}},
    {"gray", {0.5, 0.5, 0.5}},
    {"grey", {0.5, 0.5, 0.5}},
    {"lightgray", {0.8, 0.8, 0.8}},
    {"lightgrey", {0.8, 0.8, 0.8}},
    {"darkgray", {0.3, 0.3, 0.3}},
    {"darkgrey", {0.3, 0.3, 0.3}},
    {"lime", {0.6, 1, 0}},
    {"navy", {0, 0, 0.5}},
    {"teal", {0, 0.5, 0.5}},
    {"olive", {0.5, 0.5, 0}},
    {"maroon", {0.5, 0, 0}},
    {"gold", {1, 0.84, 0}},
    {"silver", {0.75, 0.75, 0.75}},
    {"beige", {0.93, 0.87, 0.73}},
    {"violet", {0.56, 0, 1}},
};
constexpr int kPaletteSize = 10;

}  // namespace

std::optional<Color> NamedColor(const std::string& name) {
  const std::string lower = ToLower(name);
  for (const auto& [word, color] : kColors) {
    if (lower == word) return color;
  }
  return std::nullopt;
}

const std::vector<std::string>& ColorNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [word, color] : kColors) names.emplace_back(word);
    return names;
  }();
  return kNames;
}

const std::string& PaletteName(int n) {
  return ColorNames()[static_cast<std::size_t>((n - 1) % kPaletteSize)];
}

}  // namespace coopdyn
