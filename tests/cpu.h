// SPDX-License-Identifier: MIT
// Tests how a cost grows with size, in CPU time of this thread, which other processes do not affect.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <ostream>
#include <string>

namespace coopdyn {

template <typename Function>
double Cpu_s(const Function& run) {
  const auto now_s = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  const double begin_s = now_s();
  run();
  return now_s() - begin_s;
}

/// Fails if `run(size)` takes quadratic time: then eight times the size would take 64 times as long.
template <typename Run>
void ExpectLinear(const Run& run, std::size_t size) {
  double small_s = Cpu_s([&] { run(size); });
  small_s = std::min(small_s, Cpu_s([&] { run(size); }));
  constexpr double kNoise_s = 0.02;
  EXPECT_LT(Cpu_s([&] { run(8 * size); }), 24 * (small_s + kNoise_s));
}

/// A text with any number of parts, for ExpectLinear().
struct GrowingText {
  const char* name;
  std::string head, part, tail;
  std::size_t size = 0;  // parts of the short text

  /// `@` in a part stands for the part's number, from 1.
  std::string Of(std::size_t parts) const {
    std::string text = head;
    for (std::size_t i = 1; i <= parts; ++i) {
      for (const char c : part) c == '@' ? text += std::to_string(i) : text += c;
    }
    return text + tail;
  }
};
inline void PrintTo(const GrowingText& text, std::ostream* out) {
  *out << text.name;
}

}  // namespace coopdyn
