// SPDX-License-Identifier: MIT
#include "server/app/progress_bar.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(ProgressText, SaysTheShareAndWhatIsLeft) {
  EXPECT_EQ(ProgressText(0.25, 10), "[##########..............................]  25 %  30 s left");
  EXPECT_EQ(ProgressText(0.5, 1000), "[####################....................]  50 %  17 min left");
}

TEST(ProgressText, SaysNothingOfTheRestAtTheEnds) {
  EXPECT_EQ(ProgressText(0, 1), "[........................................]   0 %");
  EXPECT_EQ(ProgressText(1, 1), "[########################################] 100 %");
  EXPECT_EQ(ProgressText(7, 1), ProgressText(1, 1));
}

}  // namespace
}  // namespace coopdyn
