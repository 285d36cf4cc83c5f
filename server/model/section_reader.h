// SPDX-License-Identifier: MIT
// Reads the common form of .world and .scenario files: `[SECTION]` lines and `key values` lines, and the
// values of one section by key. Reports errors with their lines; keys that were never read are reported as
// unknown.
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

/// A line `key value`, without `=` or `:` after the key and without comment.
struct Entry {
  std::string key;  // lower case
  std::string value;
  int line = 0;
  std::string set_as = {};  // "--set SECTION.key=value" in place of the line, if from a setting

  /// The place for messages about the entry.
  SourceLine In(const std::string& file) const {
    return set_as.empty() ? SourceLine{file, line} : SourceLine{set_as, 0};
  }
};

struct Section {
  std::string name;  // as written, e.g. WALL_1
  std::string word;  // lower case
  int line = 0;
  std::vector<Entry> entries;
  std::string set_as = {};  // "--set SECTION.key=value" in place of the line, if a setting made the section
  int part = 0;             // see SourceLine::part

  SourceLine In(const std::string& file) const {
    return set_as.empty() ? SourceLine{file, line, part} : SourceLine{set_as, 0};
  }
};

// More than people or most programs write.
inline constexpr std::size_t kMaxFileSections = 100'000;
inline constexpr std::size_t kMaxFileLines = 1'000'000;

/// Splits `text` (decoded) into sections in file order. Errors: lines that are neither section nor key, keys
/// before the first section, duplicate sections (both are returned), invalid names. Stops at too many errors,
/// sections or lines.
std::vector<Section> ReadSections(const std::string& text, const std::string& file, Diagnostics& diagnostics);

// Bounds that keep all values computed from a file finite and sane.
inline constexpr double kMaxFileLength_m = 1e5;
inline constexpr double kMinFileSize_m = 1e-4;
inline constexpr double kMinFileMass_kg = 1e-6;
inline constexpr double kMaxFileMass_kg = 1e9;
inline constexpr double kMaxSpeed = 1e6;       // times the wall clock
inline constexpr double kMaxDuration_s = 1e9;  // fits into 64 bits as nanoseconds
inline constexpr std::uint64_t kMaxSeed = std::numeric_limits<std::uint64_t>::max();

/// Reads one section. `section` and `diagnostics` must outlive it. One thread.
class SectionReader {
 public:
  /// `degrees`: angles without unit are in degrees. Reports duplicate keys.
  SectionReader(const Section& section, std::string file, bool degrees, Diagnostics& diagnostics);

  bool Has(const std::string& key);
  /// The rest of the line, not empty, without enclosing quotes.
  std::optional<std::string> Text(const std::string& key);
  /// One word.
  std::optional<std::string> Word(const std::string& key);
  /// One number in [min, max] (in SI units).
  std::optional<double> Number(const std::string& key, Quantity quantity, double min, double max);
  std::optional<std::uint64_t> WholeNumber(const std::string& key, std::uint64_t min, std::uint64_t max);
  /// A list of numbers in [min, max] whose length is one of `counts`. `form` describes them, e.g. "x y z".
  std::optional<std::vector<double>> Numbers(const std::string& key, Quantity quantity,
                                             std::initializer_list<std::size_t> counts,
                                             const std::string& form, double min, double max);
  std::optional<bool> YesNo(const std::string& key);
  /// Index of the value in `words`.
  std::optional<std::size_t> Choice(const std::string& key, std::span<const std::string> words);
  /// The same for an enumeration with these words.
  template <typename Enum>
  std::optional<Enum> Choice(const std::string& key, std::span<const std::string> words) {
    const std::optional<std::size_t> index = Choice(key, words);
    return index ? std::optional(static_cast<Enum>(*index)) : std::nullopt;
  }
  /// A colour word or R G B in 0…1, or 0…255 if any is above 1.
  std::optional<Color> ColorValue(const std::string& key);
  /// roll pitch yaw, or only yaw.
  std::optional<Quaternion> Orientation(const std::string& key);

  /// Reports `text` at the line of `key`, or of the section if the key is missing.
  void ErrorAt(const std::string& key, std::string text);
  void WarningAt(const std::string& key, std::string text);
  void Error(std::string text);  // at the section
  /// Reports an error if `key` is missing; `example` says what to write.
  void Require(const std::string& key, const std::string& example);
  /// Reports keys that were never read.
  void Finish();

  const Section& section() const { return section_; }
  SourceLine where() const { return section_.In(file_); }
  SourceLine LineOf(const std::string& key) const;
  std::string title() const { return "[" + section_.name + "]"; }

 private:
  const Entry* Find(const std::string& key);
  /// The numbers of `entry`, with or without units. Reports errors and returns nullopt on failure.
  std::optional<std::vector<ParsedNumber>> ParseNumbers(const Entry& entry, Quantity quantity);
  void Report(const Entry& entry, const std::string& text);

  const Section& section_;
  std::string file_;
  bool degrees_;
  Diagnostics& diagnostics_;
  std::vector<std::string> known_;
};

/// Assigns `value` to `to`, if there is one.
template <typename From, typename To>
void Take(const std::optional<From>& value, To& to) {
  if (value) to = *value;
}

/// True if a section has `angles deg`. Reports values other than deg and rad.
bool SaysDegrees(const Section& section, const std::string& file, Diagnostics& diagnostics);

// --- [FLOOR] and objects: the sections that .world and .scenario share

class Textures;

/// Reads [FLOOR], and its `ambient_light` into `ambient_light`. SaysDegrees() reads its `angles`.
Floor ReadFloor(SectionReader& reader, Textures& textures, std::optional<double>& ambient_light);
/// `ambient_light` of [FLOOR] or [SIMULATION].
std::optional<double> ReadAmbientLight(SectionReader& reader);
/// `watchdog` of [SIMULATION], [ROBOT_n] or [SWARM_n], s; 0: off.
std::optional<double> ReadWatchdog(SectionReader& reader);
/// Reads a [LIGHT_n]. Reports errors and returns nullopt on failure.
std::optional<PointLight> ReadLight(SectionReader& reader);
/// Maximum number of lights of a scenario with its world.
inline constexpr std::size_t kMaxLights = 100;

/// The content of an object section: one object at a position, or copies by `count`; neither on errors.
struct ObjectSection {
  std::optional<WorldObject> object;
  std::optional<ScatteredObjects> scattered;
};

/// Reads a box, cylinder or sphere. `other_sections`: names to suggest if the section's name is unknown.
ObjectSection ReadObject(SectionReader& reader, std::span<const std::string> other_sections,
                         Textures& textures);

/// `area x y length width`; nullopt if missing or invalid (then reported).
std::optional<FloorArea> ReadArea(SectionReader& reader);

/// Maximum count of one [SWARM_n] or one object section.
inline constexpr std::uint64_t kMaxSwarm = 100'000;
/// Maximum total count of all [SWARM_n], and of all object sections.
inline constexpr std::uint64_t kMaxSwarms = 200'000;

/// True if `word` is `kind`, or `kind_` and more: robot, robot_1.
bool IsNumbered(const std::string& word, const std::string& kind);

}  // namespace coopdyn
