// SPDX-License-Identifier: MIT
#include "server/model/random_sections.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "server/model/ground_plan.h"

namespace coopdyn {

namespace {

constexpr std::array<std::string_view, 5> kPlacing = {"position", "orientation", "quaternion", "size",
                                                      "type"};
/// Sections that a scenario may omit; created if a drawn key needs one.
constexpr std::array<std::string_view, 3> kMayBeMade = {"simulation", "floor", "target"};

bool IsRandom(const Section& section) {
  return IsNumbered(section.word, "random");
}

bool IsColor(const std::string& key) {
  return key == "color" || key == "colour";
}

/// Why `section`.`key` cannot be random; empty if it can.
std::string WhyFixed(const std::string& section, const std::string& key) {
  if (section == "simulation" && key != "gravity" && key != "ambient_light") {
    return "of [SIMULATION] only gravity and ambient_light can be random";
  }
  for (const char* word : {"world", "set"}) {
    if (section == word)
      return std::string("[") + (section == "set" ? "SET" : "WORLD") + "] cannot be random";
  }
  const bool robots = IsNumbered(section, "robot") || IsNumbered(section, "swarm");
  for (const char* fixed : {"name", "type", "count", "sockets"}) {
    if (robots && key == fixed) {
      return "'" + key +
             "' of robots cannot be random, since their clients stay over a reset: write it in [" +
             ToUpper(section) + "]";
    }
  }
  if (section == "floor" && key == "angles") return "'angles' cannot be random";
  return {};
}

}  // namespace

RandomSections::RandomSections(std::vector<Section>& sections, std::string file, Diagnostics& diagnostics)
    : file_(std::move(file)), diagnostics_(diagnostics) {
  std::vector<Section> random;
  for (Section& section : sections) {
    if (IsRandom(section)) random.push_back(std::move(section));
  }
  if (random.empty()) return;
  std::erase_if(sections, [](const Section& section) { return section.name.empty() || IsRandom(section); });
  for (const Section& section : random) {
    for (const Entry& entry : section.entries) {
      if (diagnostics_.StopAt(entry.In(file_))) return;
      if (keys_.size() == kMaxKeys) {
        diagnostics_.Error(entry.In(file_),
                           "at most " + std::to_string(kMaxKeys) + " keys of a scenario are random");
        return;
      }
      ReadKey(entry, sections);
    }
  }
  std::ranges::stable_sort(placed_, {},
                           [](const Placed& placed) { return std::pair(placed.of.line, placed.of.part); });
}

void RandomSections::ReadKey(const Entry& entry, std::vector<Section>& sections) {
  const auto error = [&](std::string text) { diagnostics_.Error(entry.In(file_), std::move(text)); };
  const std::size_t dot = entry.key.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == entry.key.size()) {
    error(
        "a line of [RANDOM] is SECTION.key and how to draw its value, for example: BOX_1.mass uniform 0.5 2");
    return;
  }
  Key key;
  key.lower = entry.key;
  key.section = entry.key.substr(0, dot);
  key.key = entry.key.substr(dot + 1);
  key.name = ToUpper(key.section) + "." + key.key;
  key.entry = entry;
  if (std::string why = WhyFixed(key.section, key.key); !why.empty()) {
    error(std::move(why));
    return;
  }
  std::string wrong;
  std::optional<RandomValue> value = RandomValue::Parse(entry.value, wrong);
  if (!value) {
    error("'" + key.name + "': " + wrong);
    return;
  }
  key.value = *std::move(value);
  const auto same = [&key](const Key& other) {
    const bool same_key = other.key == key.key || (IsColor(other.key) && IsColor(key.key));
    return other.section == key.section && same_key;
  };
  if (const auto first = std::ranges::find_if(keys_, same); first != keys_.end()) {
    error("'" + key.name + "' is drawn twice (first in line " + std::to_string(first->entry.line) +
          "): keep one");
    return;
  }
  auto section = std::ranges::find(sections, key.section, &Section::word);
  if (section == sections.end()) {
    if (std::ranges::find(kMayBeMade, key.section) == kMayBeMade.end()) {
      std::vector<std::string> names;
      for (const Section& one : sections) names.push_back(one.name);
      const std::string name = ToUpper(key.section);
      error("the scenario has no section [" + name + "]" + DidYouMean(name, names));
      return;
    }
    section = sections.insert(sections.end(), {ToUpper(key.section), key.section, entry.line, {}});
  }
  const auto in_section = [&key](const Entry& one) {
    return one.key == key.key || (IsColor(one.key) && IsColor(key.key));
  };
  if (std::ranges::count_if(section->entries, in_section) > 1) {
    error("'" + key.key + "' stands more than once in [" + section->name + "]: keep one to be drawn");
    return;
  }
  key.name = section->name + "." + key.key;
  const bool places = std::ranges::find(kPlacing, key.key) != kPlacing.end();
  const bool stands = section->word != "floor" && section->word != "simulation" &&
                      section->word != "target" && !IsNumbered(section->word, "swarm") &&
                      !IsNumbered(section->word, "light") && !IsNumbered(section->word, "score");
  const bool known = std::ranges::find(placed_, key.section, &Placed::section) != placed_.end();
  if (places && stands && !known) placed_.push_back({key.section, section->In(file_), entry.In(file_), 0});
  keys_.push_back(std::move(key));
}

std::uint32_t RandomSections::TriesOf(const std::string& section) const {
  const auto found = std::ranges::find(placed_, section, &Placed::section);
  return found == placed_.end() ? 0 : found->tries;
}

void RandomSections::Apply(std::uint64_t seed, std::vector<Section>& sections) const {
  for (const Key& key : keys_) {
    const auto section = std::ranges::find(sections, key.section, &Section::word);
    Entry drawn = key.entry;  // messages about the value point into [RANDOM]
    drawn.key = key.key;
    drawn.value = key.value.Draw({seed, key.lower, TriesOf(key.section)});
    const auto found = std::ranges::find_if(section->entries, [&key](const Entry& one) {
      return one.key == key.key || (IsColor(one.key) && IsColor(key.key));
    });
    if (found == section->entries.end()) {
      section->entries.push_back(std::move(drawn));
    } else {
      *found = std::move(drawn);
    }
  }
}

bool RandomSections::CountOn(const Scenario& scenario, std::uint64_t seed) {
  const std::vector<Standing> all = GroundPlan(scenario);
  const auto number_of = [this](const Standing& one) {
    const auto found = std::ranges::find(placed_, one.where, &Placed::of);
    return found == placed_.end() ? -1 : static_cast<int>(found - placed_.begin());
  };
  std::vector<int> numbers;
  for (const Standing& one : all) numbers.push_back(number_of(one));
  std::vector<bool> moves(placed_.size(), false);
  for (std::size_t place = 0; place < placed_.size(); ++place) {
    const int number = static_cast<int>(place);
    std::string other;
    // Later things yield to earlier ones. Things that will be redrawn block nothing.
    const auto is_free = [&](std::size_t i) {
      for (std::size_t k = 0; k < all.size(); ++k) {
        const bool counts =
            numbers[k] < number && (numbers[k] < 0 || !moves[static_cast<std::size_t>(numbers[k])]);
        if (!counts || !Overlap(all[i], all[k])) continue;
        other = all[k].name;
        return false;
      }
      return true;
    };
    for (std::size_t i = 0; i < all.size() && other.empty(); ++i) {
      if (numbers[i] == number && !is_free(i)) moves[place] = true;
    }
    if (!moves[place]) continue;
    if (++placed_[place].tries < kMaxTries) continue;
    diagnostics_.Error(placed_[place].where,
                       "[" + ToUpper(placed_[place].section) + "] stands in something in each of " +
                           std::to_string(kMaxTries) + " draws for seed " + std::to_string(seed) +
                           ", at last in " + other +
                           ": draw its position from a larger area, or take smaller or fewer things");
    return false;
  }
  return std::ranges::count(moves, true) > 0;
}

std::vector<RandomKey> RandomSections::Draw(std::uint64_t seed, std::vector<Section>& sections,
                                            const Read& read) {
  for (;;) {
    Apply(seed, sections);
    if (placed_.empty()) break;
    const std::shared_ptr<const Scenario> scenario = read(sections);
    if (scenario == nullptr || !CountOn(*scenario, seed)) break;
  }
  std::vector<RandomKey> drawn;
  for (const Key& key : keys_) {
    drawn.push_back({key.name, key.entry.value, key.value.Draw({seed, key.lower, TriesOf(key.section)})});
  }
  return drawn;
}

}  // namespace coopdyn
