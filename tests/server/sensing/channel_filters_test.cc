// SPDX-License-Identifier: MIT
// Effects of the filters of channels on values.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "server/sensing/channel_filters.h"

namespace coopdyn::channel_filters {
namespace {

constexpr double kStep_s = 0.01;

ValueFilter Filter(ValueFilter::Kind kind, int steps, double time_s = 1) {
  return {.kind = kind, .steps = steps, .time_s = time_s};
}

/// The filter's output after each of these values.
std::vector<double> Out(const ValueFilter& filter, const std::vector<double>& values) {
  std::vector<double> cells(filter.cells()), out;
  for (const double value : values) {
    TakeValue(filter, value, kStep_s, cells);
    out.push_back(FilteredValue(filter, cells, -99));
  }
  return out;
}

TEST(ChannelFiltersTest, AMeanIsThatOfTheLastValues) {
  EXPECT_EQ(Out(Filter(ValueFilter::Kind::kMean, 3), {3, 6, 9, 0, 0, 0}),
            (std::vector<double>{3, 4.5, 6, 5, 3, 0}));
}

TEST(ChannelFiltersTest, AMedianLeavesOutWhatStandsAlone) {
  EXPECT_EQ(Out(Filter(ValueFilter::Kind::kMedian, 3), {1, 100, 2, 3, -50, 3}),
            (std::vector<double>{1, 50.5, 2, 3, 2, 3}));
}

TEST(ChannelFiltersTest, ALowPassFollowsAStepByItsTimeConstant) {
  std::vector<double> values(101, 1.0);
  values[0] = 0;
  const std::vector<double> out = Out(Filter(ValueFilter::Kind::kLowPass, 1, 0.5), values);
  EXPECT_EQ(out[0], 0);
  EXPECT_NEAR(out[50], 1 - std::exp(-1), 1e-9);
  EXPECT_NEAR(out[100], 1 - std::exp(-2), 1e-9);
}

TEST(ChannelFiltersTest, BeforeItsFirstValueItChangesNothing) {
  const ValueFilter filter = Filter(ValueFilter::Kind::kMean, 3);
  EXPECT_EQ(FilteredValue(filter, std::vector<double>(filter.cells()), 7), 7);
}

TEST(ChannelFiltersTest, AValueThatIsNotFiniteIsLeftOut) {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Out(Filter(ValueFilter::Kind::kMean, 2), {4, kNoNumber, 6}), (std::vector<double>{4, 4, 5}));
  EXPECT_EQ(Out(Filter(ValueFilter::Kind::kLowPass, 1), {4, kNoNumber})[1], 4);
}

}  // namespace
}  // namespace coopdyn::channel_filters
