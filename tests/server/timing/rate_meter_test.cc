// SPDX-License-Identifier: MIT
#include "server/timing/pace.h"

#include <gtest/gtest.h>

#include "tests/server/timing/milliseconds.h"

namespace coopdyn {
namespace {

TEST(RateMeter, IsZeroWithoutNotes) {
  EXPECT_EQ(RateMeter().Factor(kMs, kMs), 0);
}

TEST(RateMeter, TellsSimulatedOverWallTime) {
  RateMeter meter;
  for (int k = 0; k <= 300; ++k) meter.Note(k * 10 * kMs, k * 25 * kMs);
  EXPECT_NEAR(meter.Factor(3000 * kMs, 7500 * kMs), 2.5, 1e-9);
}

TEST(RateMeter, ForgetsWhatIsOlderThanItsWindow) {
  RateMeter meter;
  for (int k = 0; k <= 500; ++k) meter.Note(k * 10 * kMs, k < 300 ? 0 : (k - 300) * 10 * kMs);
  EXPECT_NEAR(meter.Factor(5000 * kMs, 2000 * kMs), 1.0, 1e-9);
}

TEST(RateMeter, FallsToZeroWhileTheWorldStandsStill) {
  RateMeter meter;
  for (int k = 0; k <= 200; ++k) meter.Note(k * 10 * kMs, k * 10 * kMs);
  EXPECT_LT(meter.Factor(2500 * kMs, 2000 * kMs), 0.6);
  EXPECT_NEAR(meter.Factor(3500 * kMs, 2000 * kMs), 0, 1e-9);
}

}  // namespace
}  // namespace coopdyn
