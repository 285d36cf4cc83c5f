// SPDX-License-Identifier: MIT
#include "server/model/random_value.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "server/base/random.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr const char* kForms = "uniform LEAST MOST, normal MEAN DEVIATION or choice A B C";

/// The random numbers of one component, hashed from a counter.
class Numbers {
 public:
  Numbers(const RandomDraw& draw, std::size_t component) {
    state_ = AbsorbBits(AbsorbBits(0, draw.seed), HashOfBytes(draw.key));
    state_ = AbsorbBits(state_, static_cast<std::uint64_t>(draw.attempt) << 32 | component);
  }
  /// A number in the open interval (0, 1).
  double Next() { return UniformOf(AbsorbBits(state_, count_++)); }
  /// A normal deviate of mean 0 and standard deviation 1, truncated at kMostDeviations.
  double NextNormal() {
    for (;;) {
      const double u = Next(), v = Next();
      const double z = NormalOf(u, v);
      if (std::abs(z) <= RandomValue::kMostDeviations) return z;
    }
  }

 private:
  std::uint64_t state_ = 0, count_ = 0;
};

std::string NumberText(double value) {
  constexpr int kDigits = 9;
  std::array<char, 32> text{};
  const auto [end, code] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  return {text.data(), end};
}

/// A number and the unit directly after it, which may be any word.
struct Measure {
  double value = 0;
  std::string unit;
};

std::optional<Measure> ParseMeasure(std::string_view word) {
  const std::size_t last = word.find_last_of("0123456789.");
  if (last == std::string_view::npos) return std::nullopt;
  const std::optional<double> value = ParsePlain(word.substr(0, last + 1));
  if (!value || !ParseNumber(word, Quantity::kAny).error.empty()) return std::nullopt;
  return Measure{*value, std::string(word.substr(last + 1))};
}

/// The alternatives of a choice: words, or texts separated by bars.
std::vector<std::string> Alternatives(std::span<const std::string> words) {
  std::string rest;
  for (const std::string& word : words) rest += (rest.empty() ? "" : " ") + word;
  if (rest.find('|') == std::string::npos) return {words.begin(), words.end()};
  std::vector<std::string> found;
  for (std::size_t begin = 0; begin <= rest.size();) {
    const std::size_t end = std::min(rest.find('|', begin), rest.size());
    found.emplace_back(Trim(std::string_view(rest).substr(begin, end - begin)));
    begin = end + 1;
  }
  return found;
}

const std::array<std::string, 3> kWords = {"uniform", "normal", "choice"};

/// The error in the two numbers after `word`; empty if valid.
std::string WhyNotTwo(const std::string& word, std::span<const std::string> after) {
  const std::string example = word == "uniform" ? "uniform 0.1 0.3" : "normal 0.3 0.05";
  const std::string meaning =
      word == "uniform" ? "the least and the most" : "the mean and the standard deviation";
  const auto first = after.empty() ? std::nullopt : ParseMeasure(after[0]);
  const auto second = after.size() < 2 ? std::nullopt : ParseMeasure(after[1]);
  if (!first || !second) {
    const std::string not_this =
        after.empty() || (first && after.size() < 2) ? "" : ", not '" + (first ? after[1] : after[0]) + "'";
    return "'" + word + "' takes two numbers, " + meaning + not_this + ": write for example " + example;
  }
  if (first->unit != second->unit) {
    const std::string& unit = first->unit.empty() ? second->unit : first->unit;
    return "both numbers of '" + word + "' have the same unit: write " + word + " " +
           NumberText(first->value) + unit + " " + NumberText(second->value) + unit;
  }
  if (word == "uniform" && first->value > second->value) {
    return "'uniform' takes the least number first: write uniform " + after[1] + " " + after[0];
  }
  if (word == "normal" && second->value < 0) {
    return "the standard deviation, the second number of 'normal', is not below 0: write normal " + after[0] +
           " " + NumberText(-second->value) + second->unit;
  }
  return {};
}

}  // namespace

std::optional<RandomValue> RandomValue::Parse(std::string_view text, std::string& error) {
  RandomValue value;
  bool is_random = false;
  const std::vector<std::string> words = SplitWords(text);
  for (std::size_t i = 0; i < words.size(); ++i) {
    Component component;
    const std::size_t equals = words[i].find('=');
    const std::size_t begin = equals == std::string::npos ? 0 : equals + 1;
    component.before = words[i].substr(0, begin);
    component.text = words[i].substr(begin);
    const std::string word = ToLower(component.text);
    const std::span<const std::string> after = std::span(words).subspan(i + 1);
    if (word == "uniform" || word == "normal") {
      if (error = WhyNotTwo(word, after); !error.empty()) return std::nullopt;
      const Measure first = *ParseMeasure(after[0]), second = *ParseMeasure(after[1]);
      component.kind = word == "uniform" ? Kind::kUniform : Kind::kNormal;
      component.first = first.value;
      component.second = second.value;
      component.unit = first.unit;
      i += 2;
    } else if (word == "choice") {
      component.kind = Kind::kChoice;
      component.choices = Alternatives(after);
      for (const std::string& choice : component.choices) {
        if (choice.empty()) error = "a value of 'choice' is missing beside '|'";
      }
      if (component.choices.size() < 2) {
        error =
            "'choice' takes the values to choose from: write for example choice red green blue, or choice "
            "0 1 | 2 3";
      }
      if (!error.empty()) return std::nullopt;
      i = words.size();
    } else if (const std::size_t bracket = word.find('('); bracket != std::string::npos) {
      error = "numbers stand behind the word, without brackets: write for example " + component.before +
              "uniform 0.1 0.3";
      return std::nullopt;
    } else if (const std::string near = Nearest(word, kWords); !near.empty()) {
      error = "unknown distribution '" + component.text + "'; did you mean '" + near + "'?";
      return std::nullopt;
    }
    is_random |= component.kind != Kind::kPlain;
    value.components_.push_back(std::move(component));
  }
  if (!is_random) {
    error = "nothing is drawn here: write " + std::string(kForms);
    return std::nullopt;
  }
  return value;
}

std::string RandomValue::Draw(const RandomDraw& draw) const {
  std::string drawn;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const Component& component = components_[i];
    Numbers numbers(draw, i);
    if (i > 0) drawn += " ";
    drawn += component.before;
    switch (component.kind) {
      case Kind::kPlain:
        drawn += component.text;
        break;
      case Kind::kUniform:
        drawn += NumberText(component.first + (component.second - component.first) * numbers.Next()) +
                 component.unit;
        break;
      case Kind::kNormal:
        drawn += NumberText(component.first + component.second * numbers.NextNormal()) + component.unit;
        break;
      case Kind::kChoice: {
        const auto count = static_cast<double>(component.choices.size());
        const auto chosen = static_cast<std::size_t>(numbers.Next() * count);
        drawn += component.choices[std::min(chosen, component.choices.size() - 1)];
        break;
      }
    }
  }
  return drawn;
}

}  // namespace coopdyn
