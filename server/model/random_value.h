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

/// What a drawn number depends on, and nothing else.
struct RandomDraw {
  std::uint64_t seed = 1;
  std::string_view key;       // box_1.size
  std::uint32_t attempt = 0;  // counts on when the things would overlap
};

/// Words that stay, and components that are drawn.
class RandomValue {
 public:
  /// A normal value further from the mean is drawn again, so that each one has bounds.
  static constexpr double kMostDeviations = 3;

  /// Reads `text`. Nothing, and `error` says what to write instead, if it is none.
  static std::optional<RandomValue> Parse(std::string_view text, std::string& error);

  /// The value as a file would say it. The same draw gives the same text.
  std::string Draw(const RandomDraw& draw) const;

 private:
  enum class Kind { kPlain, kUniform, kNormal, kChoice };
  struct Component {
    std::string before;  // `speed=`
    Kind kind = Kind::kPlain;
    std::string text;                  // kPlain
    double first = 0, second = 0;      // least and most, or mean and standard deviation
    std::string unit;                  // of both
    std::vector<std::string> choices;  // kChoice
  };
  std::vector<Component> components_;
};

}  // namespace coopdyn
