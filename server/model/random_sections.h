// SPDX-License-Identifier: MIT
// [RANDOM] of a scenario: keys of other sections whose values are drawn from the seed. One thread.
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
  /// The draws of one section that may stand in something.
  static constexpr std::uint32_t kMaxTries = 1000;
  /// All keys of all [RANDOM].
  static constexpr std::size_t kMaxKeys = 1000;

  /// Takes each [RANDOM] and [RANDOM_n] of `file` out of `sections`, and reports all that is wrong there.
  RandomSections(std::vector<Section>& sections, std::string file, Diagnostics& diagnostics);

  bool empty() const { return keys_.empty(); }

  /// Reads robots and things as `sections` say, without swarms and copies, which find free places by
  /// themselves. Null with errors, which the caller will find again.
  using Read = std::function<std::shared_ptr<const Scenario>(const std::vector<Section>&)>;
  /// Gives the keys in `sections` their values for `seed`. Places and sizes are drawn again until nothing
  /// that is drawn stands in anything; reports what does after kMaxTries.
  std::vector<RandomKey> Draw(std::uint64_t seed, std::vector<Section>& sections, const Read& read);

 private:
  struct Key {
    std::string name;  // as written: BOX_1.size
    std::string lower, section, key;
    Entry entry;  // in [RANDOM]
    RandomValue value;
  };
  /// A section with keys that place it.
  struct Placed {
    std::string section;
    SourceLine of;     // the section
    SourceLine where;  // its first line in [RANDOM]
    std::uint32_t tries = 0;
  };

  void ReadKey(const Entry& entry, std::vector<Section>& sections);
  std::uint32_t TriesOf(const std::string& section) const;
  void Apply(std::uint64_t seed, std::vector<Section>& sections) const;
  /// Counts on the tries of what stands in something; false if nothing does.
  bool CountOn(const Scenario& scenario, std::uint64_t seed);

  const std::string file_;
  Diagnostics& diagnostics_;
  std::vector<Key> keys_;
  std::vector<Placed> placed_;  // in file order
};

}  // namespace coopdyn
