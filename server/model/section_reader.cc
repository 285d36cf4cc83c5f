// SPDX-License-Identifier: MIT
#include "server/model/section_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/model/text_file.h"

namespace coopdyn {

namespace {

/// The canonical spelling of a key.
std::string_view Canonical(std::string_view key) {
  return key == "colour" ? "color" : key;
}

std::string CountText(std::initializer_list<std::size_t> counts) {
  std::string out;
  for (const std::size_t count : counts) out += (out.empty() ? "" : " or ") + std::to_string(count);
  return out + (counts.size() == 1 && *counts.begin() == 1 ? " number" : " numbers");
}

/// `line` without a comment: from a # or ; at its start or after a space, outside "…".
std::string_view WithoutComment(std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (const std::size_t end = line[i] == '"' ? line.find('"', i + 1) : line.npos; end != line.npos) i = end;
    if (line[i] != '#' && line[i] != ';') continue;
    if (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t') return line.substr(0, i);
  }
  return line;
}

bool IsSectionName(std::string_view name) {
  constexpr std::size_t kMaxName = 63;
  if (name.empty() || name.size() > kMaxName) return false;
  for (const char c : name) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '_' || c == '-' || (static_cast<unsigned char>(c) & 0x80) != 0;
    if (!good) return false;
  }
  return true;
}

class SectionsReader {
 public:
  SectionsReader(const std::string& file, Diagnostics& diagnostics)
      : file_(file), diagnostics_(diagnostics) {}

  std::vector<Section> Read(const std::string& text) {
    for (std::string_view rest = text; !rest.empty();) {
      ++line_;
      const std::string_view line = Trim(WithoutComment(TakeLine(rest)));
      if (line.empty()) continue;
      if (diagnostics_.StopAt({file_, line_}) || IsTooLong()) break;
      if (line.front() == '[') {
        ReadHeader(line);
      } else {
        ReadEntry(line);
      }
    }
    return std::move(sections_);
  }

 private:
  void Error(std::string text) { diagnostics_.Error({file_, line_}, std::move(text)); }

  bool IsTooLong() {
    if (++count_ <= kMaxFileLines && sections_.size() <= kMaxFileSections) return false;
    Error("a file has at most " + std::to_string(kMaxFileSections) + " sections and " +
          std::to_string(kMaxFileLines) + " lines that are not empty");
    diagnostics_.Stop({file_, line_});
    sections_.clear();
    return true;
  }

  void ReadHeader(std::string_view line) {
    const auto end = line.find(']');
    std::string_view name = line.substr(1);
    if (end == std::string_view::npos) {
      Error("']' is missing: write " + std::string(Trim(line)) + "]");
    } else {
      if (end + 1 != line.size()) Error("nothing may follow ']' but a comment: start a new line");
      name = line.substr(1, end - 1);
    }
    name = Trim(name);
    if (!IsSectionName(name)) {
      Error("a section's name is made of letters, digits, _ and -, at most 63, as in [WALL_1]");
    }
    Section section{std::string(name), ToLower(name), line_, {}};
    const auto [first, is_new] = lines_.emplace(section.word, line_);
    if (!is_new) {
      Error("[" + section.name + "] stands here twice (first in line " + std::to_string(first->second) +
            "): put both together, or give an object or robot another number, as in [WALL_2]");
    }
    sections_.push_back(std::move(section));
  }

  void ReadEntry(std::string_view line) {
    const std::size_t key_end = std::min(line.find_first_of(" \t=:"), line.size());
    std::string_view value = Trim(line.substr(key_end));
    if (!value.empty() && (value.front() == '=' || value.front() == ':')) value = Trim(value.substr(1));
    if (key_end == 0) {
      Error("a line starts with a word or a [SECTION]");
      return;
    }
    const std::string key = ToLower(line.substr(0, key_end));
    if (sections_.empty()) {
      if (!outside_) Error("'" + key + "' stands before the first [SECTION]");
      outside_ = true;
      return;
    }
    sections_.back().entries.push_back({key, std::string(value), line_});
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
  std::vector<Section> sections_;
  std::unordered_map<std::string, int> lines_;  // of sections, by word
  int line_ = 0;
  std::size_t count_ = 0;  // number of non-empty lines
  bool outside_ = false;   // has reported a line before the first section
};

}  // namespace

std::vector<Section> ReadSections(const std::string& text, const std::string& file,
                                  Diagnostics& diagnostics) {
  return SectionsReader(file, diagnostics).Read(text);
}

SectionReader::SectionReader(const Section& section, std::string file, bool degrees, Diagnostics& diagnostics)
    : section_(section), file_(std::move(file)), degrees_(degrees), diagnostics_(diagnostics) {
  if (section.word == "target") return;  // its keys are colours and may repeat
  std::unordered_map<std::string_view, int> lines;
  for (const Entry& entry : section.entries) {
    if (diagnostics_.StopAt(entry.In(file_))) return;
    const auto [first, is_new] = lines.emplace(Canonical(entry.key), entry.line);
    if (!is_new) {
      diagnostics_.Error(entry.In(file_), "'" + entry.key + "' stands twice in " + title() +
                                              " (first in line " + std::to_string(first->second) +
                                              "): keep one");
    }
  }
}

const Entry* SectionReader::Find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  for (const Entry& entry : section_.entries) {
    if (Canonical(entry.key) == key) return &entry;
  }
  return nullptr;
}

bool SectionReader::Has(const std::string& key) {
  return Find(key) != nullptr;
}

void SectionReader::Report(const Entry& entry, const std::string& text) {
  diagnostics_.Error(entry.In(file_), text);
}

std::optional<std::string> SectionReader::Text(const std::string& key) {
  const Entry* entry = Find(key);
  if (entry == nullptr) return std::nullopt;
  std::string value = entry->value;
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
    value = value.substr(1, value.size() - 2);
  if (value.empty()) {
    Report(*entry, "'" + key + "' has no value");
    return std::nullopt;
  }
  return value;
}

std::optional<std::string> SectionReader::Word(const std::string& key) {
  const std::optional<std::string> text = Text(key);
  if (text && text->find_first_of(" \t") != std::string::npos) {
    ErrorAt(key, "'" + key + "' takes one word, not '" + *text + "'");
    return std::nullopt;
  }
  return text;
}

std::optional<std::vector<ParsedNumber>> SectionReader::ParseNumbers(const Entry& entry, Quantity quantity) {
  std::vector<ParsedNumber> numbers;
  bool fine = true, comma_before = true;
  for (std::string word : SplitWords(entry.value)) {
    const bool comma = word.size() > 1 && word.back() == ',';
    if (word == ",") {
      if (comma_before) Report(entry, "'" + entry.key + "': a number is missing before ','");
      fine = fine && !comma_before;
      comma_before = true;
      continue;
    }
    if (comma) word.pop_back();
    comma_before = comma;
    ParsedNumber number = ParseNumber(word, quantity);
    if (!number.error.empty()) {
      Report(entry, "'" + entry.key + "': " + number.error);
      fine = false;
    }
    numbers.push_back(std::move(number));
  }
  if (fine && comma_before && !numbers.empty()) {
    Report(entry, "'" + entry.key + "': a number is missing after ','");
    fine = false;
  }
  if (!fine) return std::nullopt;
  return numbers;
}

std::optional<std::vector<double>> SectionReader::Numbers(const std::string& key, Quantity quantity,
                                                          std::initializer_list<std::size_t> counts,
                                                          const std::string& form, double min, double max) {
  const Entry* entry = Find(key);
  if (entry == nullptr) return std::nullopt;
  const std::optional<std::vector<ParsedNumber>> numbers = ParseNumbers(*entry, quantity);
  if (!numbers) return std::nullopt;
  if (std::find(counts.begin(), counts.end(), numbers->size()) == counts.end()) {
    Report(*entry, "'" + key + "' needs " + CountText(counts) + " (" + form + "), not " +
                       std::to_string(numbers->size()));
    return std::nullopt;
  }
  std::vector<double> values;
  for (const ParsedNumber& number : *numbers) {
    const bool to_radians = quantity == Quantity::kAngle && degrees_ && !number.has_unit;
    const double value = to_radians ? number.value * std::numbers::pi / 180 : number.value;
    if (value < min || value > max) {
      Report(*entry, "'" + key + "' must be " + (value < min ? "at least " : "at most ") +
                         FormatNumber(value < min ? min : max) + ", not " + FormatNumber(value));
      return std::nullopt;
    }
    const bool is_rate = key == "turn_rate";  // more than a turn per second is usual
    if (quantity == Quantity::kAngle && !is_rate && !degrees_ && !number.has_unit &&
        std::abs(value) > 2 * std::numbers::pi + 1e-9) {
      diagnostics_.Warning(entry->In(file_), "'" + key + "': angles are in radians, and " +
                                                 FormatNumber(value) +
                                                 " is more than a turn; for degrees write " +
                                                 FormatNumber(value) + "deg, or 'angles deg'");
    }
    values.push_back(value);
  }
  return values;
}

std::optional<double> SectionReader::Number(const std::string& key, Quantity quantity, double min,
                                            double max) {
  const auto values = Numbers(key, quantity, {1}, "one value", min, max);
  if (!values) return std::nullopt;
  return values->front();
}

std::optional<std::uint64_t> SectionReader::WholeNumber(const std::string& key, std::uint64_t min,
                                                        std::uint64_t max) {
  const std::optional<std::string> word = Word(key);
  if (!word) return std::nullopt;
  std::uint64_t value = 0;
  const auto [end, code] = std::from_chars(word->data(), word->data() + word->size(), value);
  if (code != std::errc() || end != word->data() + word->size() || value < min || value > max) {
    ErrorAt(key, "'" + key + "' must be a whole number from " + std::to_string(min) + " to " +
                     std::to_string(max) + ", not '" + *word + "'");
    return std::nullopt;
  }
  return value;
}

std::optional<bool> SectionReader::YesNo(const std::string& key) {
  const std::vector<std::string> words = {"yes", "no", "true", "false", "on", "off"};
  const std::optional<std::string> word = Word(key);
  if (!word) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), ToLower(*word));
  if (found == words.end()) {
    ErrorAt(key, "'" + key + "' must be yes or no, not '" + *word + "'");
    return std::nullopt;
  }
  return (found - words.begin()) % 2 == 0;
}

std::optional<std::size_t> SectionReader::Choice(const std::string& key, std::span<const std::string> words) {
  const std::optional<std::string> word = Word(key);
  if (!word) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), ToLower(*word));
  if (found == words.end()) {
    ErrorAt(key, "'" + key + "' cannot be '" + *word + "'" + DidYouMean(*word, words));
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::optional<Color> SectionReader::ColorValue(const std::string& key) {
  const Entry* entry = Find(key);
  if (entry == nullptr) return std::nullopt;
  const std::string& value = entry->value;
  const bool is_word =
      !value.empty() && ((value[0] >= 'a' && value[0] <= 'z') || (value[0] >= 'A' && value[0] <= 'Z'));
  if (is_word) {
    const std::optional<Color> color = NamedColor(value);
    if (!color)
      Report(*entry, "unknown colour '" + value + "'" + DidYouMean(value, ColorNames()) + " (or R G B)");
    return color;
  }
  auto rgb = Numbers(key, Quantity::kPlain, {3}, "R G B, or a colour word", 0, 255);
  if (!rgb) return std::nullopt;
  const bool bytes = *std::max_element(rgb->begin(), rgb->end()) > 1;
  for (double& x : *rgb) x = bytes ? x / 255 : x;
  return Color{(*rgb)[0], (*rgb)[1], (*rgb)[2]};
}

std::optional<Quaternion> SectionReader::Orientation(const std::string& key) {
  constexpr double kMaxAngle_rad = 1e4, kUnit = 1e-6, kRounding = 1e-12;
  if (Has("quaternion")) {
    const auto wxyz = Numbers("quaternion", Quantity::kPlain, {4}, "w x y z", -2, 2);
    if (Has(key)) {
      ErrorAt("quaternion", "'quaternion' and '" + key + "' exclude each other: keep one");
      return std::nullopt;
    }
    if (!wxyz) return std::nullopt;
    const Quaternion q((*wxyz)[0], (*wxyz)[1], (*wxyz)[2], (*wxyz)[3]);
    if (std::abs(q.norm() - 1) > kUnit) {
      ErrorAt("quaternion", "a quaternion w x y z has length 1, not " + FormatNumber(q.norm()) +
                                ", for example: quaternion 1 0 0 0");
      return std::nullopt;
    }
    return std::abs(q.norm() - 1) > kRounding ? q.normalized() : q;
  }
  if (const Entry* entry = Find(key); entry != nullptr && ToLower(entry->value).starts_with("quaternion")) {
    Report(*entry, "'" + key + "' takes yaw, or roll pitch yaw; a quaternion w x y z is a line of its own, " +
                       "without '" + key + "': " + entry->value);
    return std::nullopt;
  }
  const auto angles =
      Numbers(key, Quantity::kAngle, {1, 3}, "yaw, or roll pitch yaw", -kMaxAngle_rad, kMaxAngle_rad);
  if (!angles) return std::nullopt;
  if (angles->size() == 1) return FromRollPitchYaw(0, 0, (*angles)[0]);
  return FromRollPitchYaw((*angles)[0], (*angles)[1], (*angles)[2]);
}

SourceLine SectionReader::LineOf(const std::string& key) const {
  for (const Entry& entry : section_.entries) {
    if (Canonical(entry.key) == key) return entry.In(file_);
  }
  return where();
}

void SectionReader::ErrorAt(const std::string& key, std::string text) {
  diagnostics_.Error(LineOf(key), std::move(text));
}

void SectionReader::WarningAt(const std::string& key, std::string text) {
  diagnostics_.Warning(LineOf(key), std::move(text));
}

void SectionReader::Error(std::string text) {
  diagnostics_.Error(where(), std::move(text));
}

void SectionReader::Require(const std::string& key, const std::string& example) {
  if (!Has(key)) Error(title() + " needs '" + key + "', for example: " + example);
}

void SectionReader::Finish() {
  for (const Entry& entry : section_.entries) {
    if (diagnostics_.StopAt(entry.In(file_))) return;
    if (std::find(known_.begin(), known_.end(), Canonical(entry.key)) == known_.end()) {
      Report(entry, "unknown word '" + entry.key + "' in " + title() + DidYouMean(entry.key, known_));
    }
  }
}

bool SaysDegrees(const Section& section, const std::string& file, Diagnostics& diagnostics) {
  Section only_angles = section;
  std::erase_if(only_angles.entries, [](const Entry& entry) { return entry.key != "angles"; });
  if (only_angles.entries.size() > 1) only_angles.entries.resize(1);
  const std::vector<std::string> words = {"rad", "deg"};
  return SectionReader(only_angles, file, false, diagnostics).Choice("angles", words).value_or(0) == 1;
}

}  // namespace coopdyn
