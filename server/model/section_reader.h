// SPDX-License-Identifier: MIT
// The common form of .world and .scenario: `[SECTION]` and `key values`, and the values of one section, each
// asked for by its key. What is wrong is reported with its line; what nobody asked for is an unknown word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/geometry/shape.h"
#include "server/model/values.h"
#include "server/model/world_model.h"

namespace coopdyn {

/// `key value`, without `=` or `:` after the key and without comment.
struct Entry {
  std::string key;  // lower case
  std::string value;
  int line = 0;
  std::string set_as = {};  // "--set SECTION.key=value", in place of the line, if a setting gave it

  /// Where messages about it point.
  SourceLine In(const std::string& file) const {
    return set_as.empty() ? SourceLine{file, line} : SourceLine{set_as, 0};
  }
};

struct Section {
  std::string name;  // as written, e.g. WALL_1
  std::string word;  // lower case
  int line = 0;
  std::vector<Entry> entries;
  std::string set_as = {};  // "--set SECTION.key=value", in place of the line, if a setting made it
  int part = 0;             // of the line

  SourceLine In(const std::string& file) const {
    return set_as.empty() ? SourceLine{file, line, part} : SourceLine{set_as, 0};
  }
};

/// What nobody writes by hand, and few programs do.
inline constexpr std::size_t kMaxFileSections = 100'000;
inline constexpr std::size_t kMaxFileLines = 1'000'000;

/// Splits `text` (decoded) into sections in file order. Errors: lines that are neither, keys before the first
/// section, sections that stand there twice (both are returned), names that are none. It stops reading when
/// there are too many errors, sections or lines.
std::vector<Section> ReadSections(const std::string& text, const std::string& file, Diagnostics& diagnostics);

/// Bounds that keep all that is computed from a file finite and sane.
inline constexpr double kMaxFileLength_m = 1e5;
inline constexpr double kMinFileSize_m = 1e-4;
inline constexpr double kMinFileMass_kg = 1e-6;
inline constexpr double kMaxFileMass_kg = 1e9;
inline constexpr double kMaxSpeed = 1e6;       // times the wall clock
inline constexpr double kMaxDuration_s = 1e9;  // in nanoseconds it fits into 64 bits
inline constexpr std::uint64_t kMaxSeed = std::numeric_limits<std::uint64_t>::max();

/// Reads one section. `section` and `diagnostics` outlive it. One thread.
class SectionReader {
 public:
  /// `degrees`: angles without unit are in degrees. Reports keys that stand there twice.
  SectionReader(const Section& section, std::string file, bool degrees, Diagnostics& diagnostics);

  bool Has(const std::string& key);
  /// The rest of the line, not empty; without quotes around it.
  std::optional<std::string> Text(const std::string& key);
  /// One word.
  std::optional<std::string> Word(const std::string& key);
  /// One number in [min, max] (in SI units).
  std::optional<double> Number(const std::string& key, Quantity quantity, double min, double max);
  std::optional<std::uint64_t> WholeNumber(const std::string& key, std::uint64_t min, std::uint64_t max);
  /// As many numbers as one of `counts`, each in [min, max]. `form` says what they are, e.g. "x y z".
  std::optional<std::vector<double>> Numbers(const std::string& key, Quantity quantity,
                                             std::initializer_list<std::size_t> counts,
                                             const std::string& form, double min, double max);
  std::optional<bool> YesNo(const std::string& key);
  /// Index of the word among `words`.
  std::optional<std::size_t> Choice(const std::string& key, std::span<const std::string> words);
  /// The same for an enumeration with these words.
  template <typename Enum>
  std::optional<Enum> Choice(const std::string& key, std::span<const std::string> words) {
    const std::optional<std::size_t> index = Choice(key, words);
    return index ? std::optional(static_cast<Enum>(*index)) : std::nullopt;
  }
  /// A colour word or R G B in 0…1, or 0…255 if any is above 1.
  std::optional<Color> ColorValue(const std::string& key);
  /// roll pitch yaw, or yaw alone.
  std::optional<Quaternion> Orientation(const std::string& key);

  /// Reports `text` at the line of `key`, or of the section if the key is missing.
  void ErrorAt(const std::string& key, std::string text);
  void WarningAt(const std::string& key, std::string text);
  void Error(std::string text);  // at the section
  /// Reports that `key` is needed if it is missing; `example` says what to write.
  void Require(const std::string& key, const std::string& example);
  /// Reports what was never asked for.
  void Finish();

  const Section& section() const { return section_; }
  SourceLine where() const { return section_.In(file_); }
  SourceLine LineOf(const std::string& key) const;
  std::string title() const { return "[" + section_.name + "]"; }

 private:
  const Entry* Find(const std::string& key);
  /// The numbers of `entry` with and without units; nothing with errors reported.
  std::optional<std::vector<ParsedNumber>> ParseNumbers(const Entry& entry, Quantity quantity);
  void Report(const Entry& entry, const std::string& text);

  const Section& section_;
  std::string file_;
  bool degrees_;
  Diagnostics& diagnostics_;
  std::vector<std::string> known_;
};

/// Gives `to` the value that was read, if there is one.
template <typename From, typename To>
void Take(const std::optional<From>& value, To& to) {
  if (value) to = *value;
}

/// Whether a section says `angles deg`; reports anything but deg and rad.
bool SaysDegrees(const Section& section, const std::string& file, Diagnostics& diagnostics);

// --- [FLOOR] and objects: the sections that .world and .scenario share

class Textures;

/// Reads [FLOOR]; `angles` in it is read by SaysDegrees, and its `ambient_light` goes to `ambient_light`.
Floor ReadFloor(SectionReader& reader, Textures& textures, std::optional<double>& ambient_light);
/// `ambient_light` of [FLOOR] or [SIMULATION].
std::optional<double> ReadAmbientLight(SectionReader& reader);
/// `watchdog` of [SIMULATION], [ROBOT_n] or [SWARM_n], s; 0: off.
std::optional<double> ReadWatchdog(SectionReader& reader);
/// Reads a [LIGHT_n]; nothing with an error.
std::optional<PointLight> ReadLight(SectionReader& reader);
/// The most that a scenario may have with its world.
inline constexpr std::size_t kMaxLights = 100;

/// What an object's section says: one at its position, or copies by `count`; neither if it has errors.
struct ObjectSection {
  std::optional<WorldObject> object;
  std::optional<ScatteredObjects> scattered;
};

/// Reads a box, cylinder or sphere. `other_sections`: what its section's name may have been meant to be.
ObjectSection ReadObject(SectionReader& reader, std::span<const std::string> other_sections,
                         Textures& textures);

/// `area x y length width`; nothing if missing or wrong (then reported).
std::optional<FloorArea> ReadArea(SectionReader& reader);

/// The most that one [SWARM_n] or one object's section may have.
inline constexpr std::uint64_t kMaxSwarm = 100'000;
/// The most that all [SWARM_n] together may have, and likewise all objects' sections with a count.
inline constexpr std::uint64_t kMaxSwarms = 200'000;

/// Whether `word` is `kind`, or `kind_` and more: robot, robot_1.
bool IsNumbered(const std::string& word, const std::string& kind);

}  // namespace coopdyn
