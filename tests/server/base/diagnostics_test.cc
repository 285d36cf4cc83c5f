// SPDX-License-Identifier: MIT
#include "server/base/diagnostics.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(Diagnostics, PrintFileLineAndLevel) {
  Diagnostics diagnostics;
  diagnostics.Error({"a.world", 3}, "no such word");
  diagnostics.Warning({"b.scenario", 0}, "odd");
  EXPECT_EQ(diagnostics.ToString(), "a.world:3: error: no such word\nb.scenario: warning: odd\n");
}

TEST(Diagnostics, WarningsAreNoErrors) {
  Diagnostics diagnostics;
  diagnostics.Warning({"a", 1}, "odd");
  EXPECT_FALSE(diagnostics.has_errors());
  Diagnostics more;
  more.Error({"a", 2}, "wrong");
  diagnostics.Append(more);
  EXPECT_EQ(diagnostics.errors(), 1);
}

}  // namespace
}  // namespace coopdyn
