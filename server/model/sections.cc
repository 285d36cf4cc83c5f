// SPDX-License-Identifier: MIT
#include "server/model/sections.h"

#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// `line` without a comment: from a # or ; at its start or after a space.
std::string_view WithoutComment(std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
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
  std::unordered_map<std::string, int> lines_;  // of the sections by word
  int line_ = 0;
  std::size_t count_ = 0;  // of lines that say something
  bool outside_ = false;   // said that something stands before the first section
};

}  // namespace

std::vector<Section> ReadSections(const std::string& text, const std::string& file,
                                  Diagnostics& diagnostics) {
  return SectionsReader(file, diagnostics).Read(text);
}

}  // namespace coopdyn
