// SPDX-License-Identifier: MIT
// [RANDOM] of a scenario: draws values for keys of other sections from the seed. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/random_value.h"
#include "server/model/scenario.h"
#include "server/model/section_reader.h"

namespace coopdyn {

class RandomSections {
 public:
  /// Maximum number of draws for a section that overlaps something.
  static constexpr std::uint32_t kMaxTries = 1000;
  /// Maximum number of keys in all [RANDOM] sections.
  static constexpr std::size_t kMaxKeys = 1000;

  /// Removes each [RANDOM] and [RANDOM_n] of `file` from `sections`, and reports all errors in them.
  RandomSections(std::vector<Section>& sections, std::string file, Diagnostics& diagnostics);

  bool empty() const { return keys_.empty(); }

  /// Reads the robots and things of `sections`, without swarms and copies, which find free places on their
  /// own. Returns null on errors, which the caller will find again.
  using Read = std::function<std::shared_ptr<const Scenario>(const std::vector<Section>&)>;
  /// Sets the keys in `sections` to their values for `seed`. Draws places and sizes again until no drawn
  /// thing overlaps anything; after kMaxTries reports the thing that still overlaps.
  std::vector<RandomKey> Draw(std::uint64_t seed, std::vector<Section>& sections, const Read& read);

 private:
  struct Key {
    std::string name;  // as written: BOX_1.size
    std::string lower, section, key;
    Entry entry;  // in [RANDOM]
    RandomValue value;
  };
  /// A section whose place or size is drawn.
  struct Placed {
    std::string section;
    SourceLine of;     // line of the section
    SourceLine where;  // line of its first such key in [RANDOM]
    std::uint32_t tries = 0;
  };

  void ReadKey(const Entry& entry, std::vector<Section>& sections);
  std::uint32_t TriesOf(const std::string& section) const;
  void Apply(std::uint64_t seed, std::vector<Section>& sections) const;
  /// Increments the tries of each section that overlaps something. False if none does, or after an error.
  bool CountOn(const Scenario& scenario, std::uint64_t seed);

  const std::string file_;
  Diagnostics& diagnostics_;
  std::vector<Key> keys_;
  std::vector<Placed> placed_;  // in file order
};

}  // namespace coopdyn
