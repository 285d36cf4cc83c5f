// SPDX-License-Identifier: MIT
// docs/rosiml.xsd agrees with the reader's tables.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "server/base/words.h"
#include "server/rosiml/grammar_tables.h"
#include "tests/source_dir.h"

namespace coopdyn::rosiml {
namespace {

struct Word {
  std::string name, type;
};

/// The schema's type of a number with limits; empty for other words.
std::string LimitedType(const std::string& type) {
  const std::size_t dots = type.find("..");
  if (dots == std::string::npos) return "";
  const std::string least = type.substr(1, dots - 1), most = type.substr(dots + 2);
  if (type.front() == '+') return "above0to" + most;
  return (type.front() == 'i' ? "whole" : "from") + least + "to" + most;
}

/// The words of a row without quotes, including those of its &ROWs.
std::vector<Word> WordsOf(std::string_view kind, std::string_view Rule::*part) {
  std::vector<Word> words;
  for (const Rule& rule : RulesOf(Dialect::kPaper)) {
    if (rule.kind != kind) continue;
    for (std::string word : SplitWords(rule.*part)) {
      if (word.starts_with('&')) {
        for (Word& inside : WordsOf(word, part)) words.push_back(std::move(inside));
        continue;
      }
      word.erase(0, word.find_first_not_of("-~"));
      const std::size_t colon = word.find(':');
      words.push_back({word.substr(0, word.find_first_of("!?=:")),
                       colon == std::string::npos ? std::string() : word.substr(colon + 1)});
    }
  }
  return words;
}

TEST(SchemaTest, ItHasEachElementAndAttributeOfTheTables) {
  std::ifstream stream(SourceDir() + "/docs/rosiml.xsd");
  const std::string schema((std::istreambuf_iterator<char>(stream)), {});
  std::size_t types = 0;
  for (const Rule& rule : RulesOf(Dialect::kPaper)) {
    if (rule.kind.starts_with('&')) continue;
    ++types;
    const std::string head = "<xs:complexType name=\"" + std::string(rule.kind) + "\">";
    const std::size_t begin = schema.find(head);
    ASSERT_NE(begin, std::string::npos) << head;
    const std::string type = schema.substr(begin, schema.find("</xs:complexType>", begin) - begin);
    std::size_t names = 0;
    for (const auto part : {&Rule::attributes, &Rule::children}) {
      const std::string element = part == &Rule::attributes ? "<xs:attribute name=\"" : "<xs:element name=\"";
      for (const Word& word : WordsOf(rule.kind, part)) {
        const std::string limited = LimitedType(word.type);
        const std::string end = limited.empty() ? "\"" : "\" type=\"" + limited + "\"";
        EXPECT_NE(type.find(element + word.name + end), std::string::npos) << rule.kind << " " << word.name;
        ++names;
      }
    }
    std::size_t written = 0;
    for (std::size_t at = 0; (at = type.find(" name=\"", at + 1)) != std::string::npos;) ++written;
    EXPECT_EQ(written, names + 1) << rule.kind;  // and its own
  }
  std::size_t written = 0;
  for (std::size_t at = 0; (at = schema.find("<xs:complexType", at + 1)) != std::string::npos;) ++written;
  EXPECT_EQ(written, types);
}

}  // namespace
}  // namespace coopdyn::rosiml
