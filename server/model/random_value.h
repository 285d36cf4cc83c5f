// SPDX-License-Identifier: MIT
// The value of a key in [RANDOM]: `uniform 0.1 0.3  0.2  normal 0.3 0.05`, `choice red green blue`. Pure; any
// thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// Everything that a drawn number depends on.
struct RandomDraw {
  std::uint64_t seed = 1;
  std::string_view key;       // box_1.size
  std::uint32_t attempt = 0;  // incremented while things overlap
};

/// A value made of fixed words and drawn components.
class RandomValue {
 public:
  /// Normal values further from the mean are drawn again, so that they are bounded.
  static constexpr double kMostDeviations = 3;

  /// Parses `text`. Returns nullopt if it is invalid; `error` then says what to write instead.
  static std::optional<RandomValue> Parse(std::string_view text, std::string& error);

  /// The drawn value as written in a file. The same draw gives the same text.
  std::string Draw(const RandomDraw& draw) const;

 private:
  enum class Kind { kPlain, kUniform, kNormal, kChoice };
  struct Component {
    std::string before;  // `speed=`
    Kind kind = Kind::kPlain;
    std::string text;                  // kPlain
    double first = 0, second = 0;      // minimum and maximum, or mean and standard deviation
    std::string unit;                  // of both
    std::vector<std::string> choices;  // kChoice
  };
  std::vector<Component> components_;
};

}  // namespace coopdyn
