// SPDX-License-Identifier: MIT
#include "server/rosiml/grammar.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/grammar_tables.h"

namespace coopdyn::rosiml {

namespace {

/// One word of a row.
struct Word {
  std::string name;
  std::string kind;  // kind of a child, or type of an attribute
  bool is_needed = false, is_single = false, is_silent = false, is_not_yet = false;
};

std::vector<Word> WordsOf(std::string_view row) {
  std::vector<Word> words;
  for (const std::string& written : SplitWords(row)) {
    Word word;
    std::string_view rest = written;
    word.is_silent = rest.starts_with('-');
    word.is_not_yet = rest.starts_with('~');
    if (word.is_silent || word.is_not_yet) rest.remove_prefix(1);
    const std::size_t colon = rest.find(':');
    std::string_view name = rest.substr(0, colon);
    if (colon != std::string_view::npos) word.kind = rest.substr(colon + 1);
    word.is_needed = name.ends_with('!');
    word.is_single = word.is_needed || name.ends_with('?');
    if (word.is_single) name.remove_suffix(1);
    const std::size_t equals = name.find('=');
    word.name = name.substr(0, equals);
    if (colon == std::string_view::npos)
      word.kind = equals == std::string_view::npos ? name : name.substr(equals + 1);
    words.push_back(std::move(word));
  }
  return words;
}

struct ParsedRule {
  std::vector<Word> attributes, children;
};

std::vector<std::string> NamesOf(const std::vector<Word>& words) {
  std::vector<std::string> names;
  for (const Word& word : words) names.push_back(word.name);
  return names;
}

class Checker {
 public:
  Checker(Dialect dialect, const std::string& file, Diagnostics& diagnostics)
      : file_(file), diagnostics_(diagnostics) {
    for (const Rule& rule : RulesOf(dialect))
      rules_.emplace(rule.kind, ParsedRule{WordsOf(rule.attributes), WordsOf(rule.children)});
    for (auto& [kind, rule] : rules_) {
      Insert(&ParsedRule::attributes, rule);
      Insert(&ParsedRule::children, rule);
    }
  }

  void Check(Element& element, const std::string& kind) {
    const SourceLine where{file_, element.GetLineNum()};
    if (diagnostics_.StopAt(where)) return;
    const ParsedRule& rule = rules_.at(kind);
    CheckAttributes(element, rule);
    CheckTexts(element);
    std::map<std::string, int> counts;
    for (Element* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      auto word = std::ranges::find(rule.children, child->Name(), &Word::name);
      if (word == rule.children.end()) {
        if (diagnostics_.StopAt({file_, child->GetLineNum()})) return;
        const std::string meant = ErrorOfUnknown(*child, rule);
        word = std::ranges::find(rule.children, meant, &Word::name);
        if (word == rule.children.end() || (word->is_single && counts[meant] > 0)) continue;
        child->SetName(meant.c_str());
      }
      if (++counts[word->name] == 2 && word->is_single)
        Error(*child, "<" + word->name + "> stands twice in <" + element.Name() + ">: keep one");
      if (word->is_not_yet) NoteNotYet(*child, word->name);
      if (!word->is_not_yet && !word->is_silent) Check(*child, word->kind);
    }
    for (const Word& word : rule.children) {
      if (word.is_needed && counts[word.name] == 0)
        Error(element, "<" + std::string(element.Name()) + "> needs <" + word.name + ">");
    }
  }

  void SayNotYet() {
    for (const auto& [word, found] : not_yet_) {
      const auto known = std::ranges::find(NotSimulatedYet(), word, &NotYet::word);
      const NotYet said = known == NotSimulatedYet().end() ? NotYet{word, "it is left out"} : *known;
      diagnostics_.Warning(
          {file_, found.line},
          found.label + " " + std::string(said.is) + ": " + std::string(said.what) +
              (found.count > 1 ? " (" + std::to_string(found.count) + " in this file)" : ""));
    }
  }

 private:
  /// Expands each &ROW.
  void Insert(std::vector<Word> ParsedRule::*words, ParsedRule& rule) const {
    std::vector<Word> all;
    for (const Word& word : rule.*words) {
      if (!word.name.starts_with('&')) {
        all.push_back(word);
        continue;
      }
      const std::vector<Word>& part = rules_.at(word.name).*words;
      all.insert(all.end(), part.begin(), part.end());
    }
    rule.*words = std::move(all);
  }

  struct Found {
    int line = 0;
    int count = 0;
    std::string label;
  };

  static std::string Shown(std::string_view text) {
    constexpr std::size_t kMost = 60;
    return Printable(text, kMost);
  }
  void Error(const Element& at, std::string text) {
    diagnostics_.Error({file_, at.GetLineNum()}, std::move(text));
  }

  void NoteNotYet(const Element& at, const std::string& word, bool is_attribute = false) {
    Found& found = not_yet_[word];
    if (found.count++ > 0) return;
    found.line = at.GetLineNum();
    found.label = is_attribute ? "'" + word + "' of <" + at.Name() + ">" : "<" + word + ">";
  }

  /// Reports an unknown element. Returns the most similar word that is allowed there; empty if none.
  std::string ErrorOfUnknown(const Element& child, const ParsedRule& rule) {
    const std::vector<std::string> names = NamesOf(rule.children);
    const std::string meant = Nearest(child.Name(), names), home = HomeOf(child.Name());
    Error(child, "unknown element <" + Shown(child.Name()) + "> in <" + child.Parent()->Value() + ">" +
                     (meant.empty() && !home.empty() ? ": it stands in <" + home + ">"
                                                     : DidYouMean(child.Name(), names)));
    return meant;
  }

  /// The only element that may have this child; empty if there is none or several.
  std::string HomeOf(std::string_view child) const {
    std::vector<std::string> homes;
    for (const auto& [kind, rule] : rules_) {
      if (std::ranges::find(rule.children, child, &Word::name) != rule.children.end()) homes.push_back(kind);
    }
    return homes.size() == 1 && homes.front().find_first_of("_&") == std::string::npos ? homes.front() : "";
  }

  void CheckAttributes(Element& element, const ParsedRule& rule) {
    std::set<std::string> seen;
    const std::string in = " in <" + std::string(element.Name()) + ">";
    for (const auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
      const auto word = std::ranges::find(rule.attributes, one->Name(), &Word::name);
      if (word == rule.attributes.end()) {
        Error(element, "unknown attribute '" + Shown(one->Name()) + "'" + in +
                           DidYouMean(one->Name(), NamesOf(rule.attributes)));
        const std::string meant = Nearest(one->Name(), NamesOf(rule.attributes));
        if (!meant.empty() && element.Attribute(meant.c_str()) == nullptr)
          element.SetAttribute(meant.c_str(), one->Value());
        continue;
      }
      seen.insert(one->Name());
      if (const std::string wrong = WrongWith(one->Value(), word->kind); !wrong.empty())
        Error(element, "'" + word->name + "'" + in + " " + wrong + ", not '" + Shown(one->Value()) + "'");
      // A disabled feature needs no warning.
      if (word->is_not_yet && std::string_view(one->Value()) != "false")
        NoteNotYet(element, word->name, true);
    }
    for (const Word& word : rule.attributes) {
      if (word.is_needed && !seen.contains(word.name))
        Error(element, "<" + std::string(element.Name()) + "> needs the attribute '" + word.name + "'");
    }
  }

  /// Reports anything but comments and elements between tags.
  void CheckTexts(const Element& element) {
    for (const tinyxml2::XMLNode* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
      const bool is_text = node->ToText() != nullptr, is_unknown = node->ToUnknown() != nullptr;
      if (!is_text && !is_unknown) continue;
      diagnostics_.Error(
          {file_, node->GetLineNum()},
          is_text ? "text between the tags of <" + std::string(element.Name()) + ">: values are attributes"
                  : "a declaration <!…> is not read: remove it");
      return;
    }
  }

  /// Says what a value of this type must be; empty if `text` is valid.
  static std::string WrongWith(std::string_view text, std::string_view type) {
    if (type == "s") return Trim(text).empty() ? "must not be empty" : "";
    if (type == "b")
      return text == "true" || text == "false" || text == "1" || text == "0" ? "" : "is true or false";
    if (type == "c") {
      const bool good = (text.size() == 6 || text.size() == 8) &&
                        text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
      return good ? "" : "is a colour RRGGBB, for example FF8000";
    }
    if (type.find('|') != std::string_view::npos) return WrongChoice(text, type);
    if (type == "r") return WrongRange(text);
    return WrongNumber(text, type);
  }

  static std::string WrongNumber(std::string_view text, std::string_view type) {
    const char letter = type.front();
    const std::size_t dots = type.find("..");
    const bool has_range = dots != std::string_view::npos;
    const std::string most(has_range                        ? type.substr(dots + 2)
                           : letter == 'n' || letter == '+' ? "100000"
                                                            : "1e9");
    const std::string least(has_range       ? std::string(type.substr(1, dots - 1))
                            : letter == '0' ? "0"
                                            : "-" + most);
    const double low = ParseNumber(least).value_or(0), high = *ParseNumber(most);
    const std::optional<double> value = ParseNumber(text);
    const bool is_kind = value && (letter != 'i' || *value == std::floor(*value));
    if (is_kind && *value <= high && (letter == '+' ? *value > 0 : *value >= low)) return "";
    const std::string said = letter == 'i' ? "is a whole number" : "is a number";
    const bool is_far = has_range || (value && std::abs(*value) > high);
    if (letter == '+') return said + " above 0" + (value && *value > high ? ", at most " + most : "");
    return said + (is_far ? " from " + least + " to " + most : letter == '0' ? ", 0 or more" : "");
  }

  static std::string WrongChoice(std::string_view text, std::string_view type) {
    std::vector<std::string> words;
    while (!type.empty()) {
      std::string word(type.substr(0, type.find('|')));
      type.remove_prefix(std::min(type.size(), word.size() + 1));
      std::ranges::replace(word, '_', ' ');
      if (word == text) return "";
      words.push_back(std::move(word));
    }
    const std::string near = Nearest(text, words);
    return "is one of " + JoinNames(words) + (near.empty() ? "" : " (did you mean '" + near + "'?)");
  }

  static std::string WrongRange(std::string_view text) {
    const std::vector<std::string> words = SplitWords(text);
    constexpr double kMost = 1e5;
    std::vector<double> values;
    for (const std::string& word : words) {
      const auto value = ParseNumber(word);
      if (value && std::abs(*value) <= kMost) values.push_back(*value);
    }
    const bool good = values.size() == words.size() && (values.size() == 1 || values.size() == 2);
    if (!good) return "is the least and the most, for example \"-2 2\"";
    return values.front() <= values.back() ? "" : "is the least and the most, in this order";
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
  std::map<std::string, ParsedRule, std::less<>> rules_;
  std::map<std::string, Found> not_yet_;
};

}  // namespace

Dialect DialectOf(const Element& root) {
  if (Child(root, "movables") != nullptr) return Dialect::kPaper;
  const bool is_public = Child(root, "robots") != nullptr || Child(root, "macros") != nullptr ||
                         Child(root, "screens") != nullptr || Text(root, "version").starts_with("0.");
  return is_public ? Dialect::kPublic : Dialect::kPaper;
}

void CheckGrammar(Element& root, Dialect dialect, const std::string& file, Diagnostics& diagnostics) {
  Checker checker(dialect, file, diagnostics);
  checker.Check(root, "rosiml");
  checker.SayNotYet();
}

}  // namespace coopdyn::rosiml
