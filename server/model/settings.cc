// SPDX-License-Identifier: MIT
#include "server/model/settings.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace coopdyn {

namespace {

constexpr std::string_view kWord = "set";
constexpr std::string_view kHead = "\n[SET]\n";
constexpr std::string_view kName = "# file: ";  // may begin a text's last line
constexpr std::string_view kFlag = "--set ";
constexpr std::string_view kRobots = "robots";  // every [ROBOT_n] and [SWARM_n]
/// Sections that a scenario may omit; created if a setting needs one.
constexpr std::array<std::string_view, 4> kOptional = {"SIMULATION", "FLOOR", "TARGET", "RANDOM"};

std::string Label(const Entry& setting) {
  std::string name = setting.key;
  const std::size_t dot = name.find('.');
  std::transform(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(dot), name.begin(), ::toupper);
  return std::string(kFlag) + name + "=" + setting.value;
}

/// Position of the last line if it names the text's file; else the end of the text.
std::size_t BeforeName(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n");
  if (end == std::string::npos) return text.size();
  const std::size_t line = text.find_last_of("\r\n", end);
  const std::size_t begin = line == std::string::npos ? 0 : line + 1;
  return std::string_view(text).substr(begin).starts_with(kName) ? begin : text.size();
}

void Apply(const Entry& setting, std::vector<Section>& sections, Diagnostics& diagnostics) {
  const std::string label = Label(setting);
  const std::size_t dot = setting.key.find('.');
  const std::string word = setting.key.substr(0, dot), key = setting.key.substr(dot + 1);
  auto section = std::ranges::find(sections, word, &Section::word);
  if (section == sections.end()) {
    const std::string asked = label.substr(kFlag.size(), dot);
    const bool made = IsNumbered(word, "score") || std::ranges::count(kOptional, asked) > 0;
    if (!made) {
      std::vector<std::string> names;
      for (const Section& one : sections) names.push_back(one.name);
      diagnostics.Error({label, 0}, "the scenario has no section [" + asked + "]" + DidYouMean(asked, names));
      return;
    }
    section = sections.insert(sections.end(), {asked, word, setting.line, {}, label});
  }
  std::vector<Entry>& entries = section->entries;
  const auto is_color = [](const std::string& word) { return word == "color" || word == "colour"; };
  const auto same = [&](const Entry& one) { return one.key == key || (is_color(one.key) && is_color(key)); };
  const auto count = std::ranges::count_if(entries, same);
  if (count > 1) {
    diagnostics.Error({label, 0}, "'" + key + "' stands " + std::to_string(count) + " times in [" +
                                      section->name + "]: change the scenario's file instead");
    return;
  }
  if (setting.value.empty()) {
    if (count == 0) {
      std::vector<std::string> keys;
      for (const Entry& one : entries) keys.push_back(one.key);
      diagnostics.Error({label, 0}, "[" + section->name + "] has no '" + key + "' to be taken away" +
                                        DidYouMean(key, keys));
    }
    std::erase_if(entries, same);
    return;
  }
  const Entry changed{key, setting.value, setting.line, label};
  const auto found = std::ranges::find_if(entries, same);
  if (found == entries.end())
    entries.push_back(changed);
  else
    *found = changed;
}

}  // namespace

std::string WithSettings(std::string text, const Settings& settings, Diagnostics& diagnostics) {
  if (settings.empty()) return text;
  std::string lines;
  for (const std::string& setting : settings) {
    const std::size_t dot = setting.find('.'), equals = setting.find('=');
    const bool whole = dot != std::string::npos && equals != std::string::npos && dot > 0 && dot + 1 < equals;
    const bool plain = setting.find_first_of("\r\n") == std::string::npos &&
                       setting.find(" #") == std::string::npos && setting.find(" ;") == std::string::npos &&
                       setting.find_first_of(" \t:") >= equals;
    if (!whole || !plain) {
      diagnostics.Error({std::string(kFlag) + setting, 0},
                        "a setting is SECTION.key=value, for example: --set SWARM_1.count=20");
      continue;
    }
    lines += setting.substr(0, equals) + " " + setting.substr(equals + 1) + "\n";
  }
  const std::size_t end = BeforeName(text);
  const std::string name = text.substr(end);
  text.erase(end);
  if (text.find(kHead) == std::string::npos) {
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += kHead;
  } else if (text.back() != '\n') {
    text += '\n';
  }
  return text + lines + name;
}

Settings SettingsIn(const std::string& text) {
  Diagnostics ignored;
  Settings settings;
  for (const Section& section : ReadSections(text, "", ignored)) {
    if (section.word != kWord) continue;
    for (const Entry& entry : section.entries) settings.push_back(entry.key + "=" + entry.value);
  }
  return settings;
}

void ApplySettings(std::vector<Section>& sections, const std::string& file, Diagnostics& diagnostics) {
  const auto found = std::ranges::find(sections, kWord, &Section::word);
  if (found == sections.end()) return;
  const Section set = *found;
  sections.erase(found);
  for (const Entry& setting : set.entries) {
    const std::size_t dot = setting.key.find('.');
    if (dot == std::string::npos || dot == 0 || dot + 1 == setting.key.size()) {
      diagnostics.Error({file, setting.line},
                        "a line of [SET] is SECTION.key value, for example: SWARM_1.count 20");
      continue;
    }
    const std::string word = setting.key.substr(0, dot);
    if (word != kRobots || std::ranges::find(sections, word, &Section::word) != sections.end()) {
      Apply(setting, sections, diagnostics);
      continue;
    }
    std::vector<std::string> words;
    for (const Section& section : sections) {
      if (IsNumbered(section.word, "robot") || IsNumbered(section.word, "swarm"))
        words.push_back(section.word);
    }
    if (words.empty())
      diagnostics.Error({Label(setting), 0}, "the scenario has no [ROBOT_n] and no [SWARM_n]");
    for (const std::string& one : words)
      Apply({one + setting.key.substr(dot), setting.value, setting.line}, sections, diagnostics);
  }
}

}  // namespace coopdyn
