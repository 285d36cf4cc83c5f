// SPDX-License-Identifier: MIT
#include "server/rosiml/xml_mistakes.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/base/words.h"

namespace coopdyn::rosiml {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

class XmlScanner {
 public:
  XmlScanner(std::string_view text, const std::string& file, Diagnostics& diagnostics)
      : rest_(text), file_(file), diagnostics_(diagnostics) {}

  void Scan() {
    while (!rest_.empty()) {
      if (diagnostics_.StopAt({file_, line_}) || !ScanNext()) return;
    }
    if (!has_root_) ErrorOfRoot(line_);
    for (const Open& one : open_) Error(one.line, "<" + one.name + "> has no end: write </" + one.name + ">");
  }

 private:
  struct Open {
    std::string name;
    int line = 0;
  };

  void Error(int line, std::string text) { diagnostics_.Error({file_, line}, std::move(text)); }
  bool ErrorOfRoot(int line) {
    Error(line, "an experiment starts with <rosiml version=\"…\">");
    return false;
  }
  static std::string Shown(std::string_view text) {
    constexpr std::size_t kMost = 60;
    return Printable(text, kMost);
  }

  /// Consumes the next `count` characters.
  std::string_view Take(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    line_ += static_cast<int>(std::ranges::count(taken, '\n'));
    rest_.remove_prefix(taken.size());
    return taken;
  }
  void SkipBlanks() { Take(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }
  std::string_view TakeName() { return Take(std::min(rest_.find_first_of(" \t\r\n/>=<\"'"), rest_.size())); }

  /// False if scanning must stop.
  bool ScanNext() {
    if (!rest_.starts_with('<')) {
      const std::string_view text = rest_.substr(0, rest_.find('<'));
      if (open_.empty() && has_root_ && text.find_first_not_of(kBlanks) != std::string_view::npos) {
        SkipBlanks();
        Error(line_, "text behind </rosiml>: remove it");
        return false;
      }
      CheckEntities(text);
      Take(std::min(rest_.find('<'), rest_.size()));
      return true;
    }
    for (const auto& [begin, end] :
         {std::pair("<!--", "-->"), {"<![CDATA[", "]]>"}, {"<?", "?>"}, {"<!", ">"}}) {
      if (rest_.starts_with(begin)) return Skip(begin, end);
    }
    return rest_.starts_with("</") ? ScanEnd() : ScanTag();
  }

  bool Skip(std::string_view begin, std::string_view end) {
    const std::size_t at = rest_.find(end, begin.size());
    if (at == std::string_view::npos) {
      Error(line_, "what begins with " + std::string(begin) + " has no end: write " + std::string(end));
      return false;
    }
    Take(at + end.size());
    return true;
  }

  /// </name>
  bool ScanEnd() {
    const int line = line_;
    Take(2);
    const std::string name(TakeName());
    SkipBlanks();
    if (!rest_.starts_with('>')) {
      Error(line, "</" + Shown(name) + " needs a > behind it");
      return false;
    }
    Take(1);
    const auto is_name = [&name](const Open& one) { return one.name == name; };
    if (open_.empty()) {
      Error(line, "</" + Shown(name) + "> ends nothing: remove it");
    } else if (std::ranges::any_of(open_, is_name)) {
      for (; !is_name(open_.back()); open_.pop_back()) {
        Error(line, "<" + open_.back().name + "> of line " + std::to_string(open_.back().line) +
                        " has no end: write </" + open_.back().name + "> before </" + name + ">");
      }
      open_.pop_back();
    } else {
      Error(line, "</" + Shown(name) + "> stands where <" + open_.back().name + "> of line " +
                      std::to_string(open_.back().line) + " ends: write </" + open_.back().name + ">");
      open_.pop_back();
    }
    return true;
  }

  /// <name attribute="…">
  bool ScanTag() {
    constexpr std::size_t kMostDepth = 90;  // the parser's limit is 100
    constexpr int kMostAttributes = 100;    // the parser's time is quadratic in their number
    const int line = line_;
    Take(1);
    const std::string name = Shown(TakeName());
    if (name.empty()) {
      Error(line, "a name follows <: write &lt; for the sign itself");
      return false;
    }
    if (open_.empty() && std::exchange(has_root_, true)) {
      Error(line, "<" + name + "> stands behind </rosiml>: all of an experiment stands before it");
    } else if (open_.empty() && name != "rosiml") {
      return ErrorOfRoot(line);
    }
    std::set<std::string, std::less<>> seen;
    for (int count = 0;; ++count) {
      SkipBlanks();
      if (rest_.starts_with("/>")) {
        Take(2);
        return true;
      }
      if (rest_.starts_with('>')) break;
      if (count == kMostAttributes) {
        Error(line_, "<" + name + "> has more than " + std::to_string(kMostAttributes) + " attributes");
        return false;
      }
      if (!ScanAttribute(name, line, seen)) return false;
    }
    Take(1);
    open_.push_back({name, line});
    if (open_.size() <= kMostDepth) return true;
    Error(line, "elements stand more than " + std::to_string(kMostDepth) + " deep in each other");
    return false;
  }

  bool ScanAttribute(const std::string& tag, int tag_line, std::set<std::string, std::less<>>& seen) {
    const int line = line_;
    const std::string name(TakeName()), shown = "'" + Shown(name) + "' in <" + tag + ">";
    if (name.empty()) {
      if (rest_.empty() || rest_.starts_with('<')) {
        Error(tag_line, "<" + tag + "> has no end: write > or />");
      } else {
        Error(line, "'" + Shown(rest_.substr(0, 1)) + "' in <" + tag +
                        "> is out of place: attributes are written name=\"value\"");
      }
      return false;
    }
    if (!seen.insert(name).second) Error(line, shown + " stands twice: keep one");
    SkipBlanks();
    if (!rest_.starts_with('=')) {
      Error(line, shown + " has no value: write " + Shown(name) + "=\"…\"");
      return true;
    }
    Take(1);
    SkipBlanks();
    if (rest_.empty() || (rest_.front() != '"' && rest_.front() != '\'')) {
      std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n>"));
      if (word.ends_with('/')) word.remove_suffix(1);
      Error(line,
            "the value of " + shown + " stands in quotes: write " + Shown(name) + "=\"" + Shown(word) + "\"");
      Take(word.size());
      return true;
    }
    const char quote = Take(1).front();
    const std::size_t end = std::min(rest_.find(quote), rest_.find('<'));
    if (end == std::string_view::npos || rest_[end] == '<') {
      Error(line, "the value of " + shown + " has no end: write a " + quote + " behind it" +
                      (end == std::string_view::npos ? "" : ", or &lt; for a < in it"));
      return false;
    }
    CheckEntities(rest_.substr(0, end));
    Take(end + 1);
    return true;
  }

  /// Reports unknown entities: without a DOCTYPE only XML's own exist.
  void CheckEntities(std::string_view text) {
    int line = line_;
    std::size_t counted = 0;  // position up to which lines have been counted
    for (std::size_t at = 0; (at = text.find('&', at)) != std::string_view::npos; ++at) {
      const std::string_view word = text.substr(at + 1, text.find_first_of(";& \t\r\n", at + 1) - at - 1);
      const bool has_end = text.substr(at + 1 + word.size()).starts_with(';');
      if (has_end && IsKnown(word)) continue;
      line += static_cast<int>(std::ranges::count(text.substr(counted, at - counted), '\n'));
      counted = at;
      if (diagnostics_.StopAt({file_, line})) return;
      Error(line, has_end && !word.empty()
                      ? "the entity '&" + Shown(word) +
                            ";' is not defined: write out what it stands for; there are &amp; &lt; &gt; "
                            "&quot; and &apos;"
                      : "a & by itself is no XML: write &amp;");
    }
  }

  static bool IsKnown(std::string_view word) {
    for (const char* known : {"amp", "lt", "gt", "quot", "apos"}) {
      if (word == known) return true;
    }
    if (!word.starts_with('#')) return false;
    const bool is_hex = word.starts_with("#x");
    word.remove_prefix(is_hex ? 2 : 1);
    unsigned code = 0;
    constexpr unsigned kLast = 0x10FFFF;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), code, is_hex ? 16 : 10);
    return error == std::errc() && end == word.data() + word.size() && code > 0 && code <= kLast;
  }

  std::string_view rest_;
  const std::string& file_;
  Diagnostics& diagnostics_;
  int line_ = 1;
  bool has_root_ = false;
  std::vector<Open> open_;
};

}  // namespace

void FindXmlMistakes(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  XmlScanner(text, file, diagnostics).Scan();
}

}  // namespace coopdyn::rosiml
