// SPDX-License-Identifier: MIT
// Files eight times as long take about eight times as long to read, valid and invalid ones alike.
#include <gtest/gtest.h>

#include <string>

#include "tests/cpu.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

/// `head`, then `part` n times with its number for each @, then `tail`.
using Kind = GrowingText;

class LinearScenarioTest : public ::testing::TestWithParam<Kind> {};

TEST_P(LinearScenarioTest, Reading) {
  const Kind& kind = GetParam();
  ExpectLinear([&](std::size_t n) { Read(kind.Of(n)); }, kind.size);
}

const std::string kWorld = "[WORLD]\nfile empty.world\n";

INSTANTIATE_TEST_SUITE_P(
    OfText, LinearScenarioTest,
    ::testing::Values(
        Kind{"robots", kWorld, "[ROBOT_@]\ntype minibot\nposition @ 0\n", "", 500},
        Kind{"things", kWorld, "[BOX_@]\ntype box\nsize 0.1 0.1 0.1\nposition @ 0 0.1\n", "", 500},
        Kind{"things in one place", kWorld, "[BOX_@]\ntype box\nsize 0.1 0.1 0.1\nposition 0 0 0.1\n", "",
             500},
        Kind{"unknown keys", kWorld + "[BOX_1]\ntype box\n", "key@ 1\n", "", 4000},
        Kind{"one key again and again", kWorld + "[BOX_1]\ntype box\n", "size 1 1 1\n", "", 4000},
        Kind{"one section again and again", kWorld, "[BOX_1]\ntype box\nsize 1 1 1\n", "", 2000},
        Kind{"empty lines", kWorld, "\n", "", 50'000}, Kind{"brackets", kWorld, "[", "", 50'000},
        Kind{"one long line", kWorld + "[BOX_1]\ntype box\nsize ", "1 ", "", 50'000},
        Kind{"comments", kWorld, "# [BOX_@]\n", "", 20'000}));

class LinearModelTest : public ::testing::TestWithParam<Kind> {};

TEST_P(LinearModelTest, Reading) {
  const Kind& kind = GetParam();
  const auto read = [&](std::size_t n) {
    Diagnostics diagnostics;
    ReadRobotModelText(kind.Of(n), "test.sdf", "test", diagnostics);
  };
  ExpectLinear(read, kind.size);
}

const std::string kSdf = "<sdf version=\"1.9\"><model name=\"m\"><link name=\"base\"/>\n",
                  kSdfEnd = "</model></sdf>";
const std::string kUrdfBegin = "<robot name=\"m\"><link name=\"base\"/>\n", kUrdfEnd = "</robot>";
const std::string kBox = "<geometry><box><size>1 1 1</size></box></geometry>";

INSTANTIATE_TEST_SUITE_P(
    OfSdf, LinearModelTest,
    ::testing::Values(
        Kind{"links", kSdf,
             "<link name=\"l@\"/><joint name=\"j@\" "
             "type=\"fixed\"><parent>base</parent><child>l@</child></joint>\n",
             kSdfEnd, 30},
        Kind{"shapes", kSdf + "<link name=\"l\">", "<collision name=\"c@\">" + kBox + "</collision>\n",
             "</link>" + kSdfEnd, 200},
        Kind{"links of one name", kSdf, "<link name=\"l\"/>\n", kSdfEnd, 500},
        Kind{"unknown elements", kSdf, "<x@/>\n", kSdfEnd, 2000},
        Kind{"unknown elements of ours", kSdf, "<coopdyn:x@/>\n", kSdfEnd, 2000},
        Kind{"elements within each other", kSdf, "<x>", kSdfEnd, 2000},
        Kind{"attributes", "<sdf version=\"1.9\" ", "a@=\"\" ", ">" + kSdfEnd, 2000},
        Kind{"entities", kSdf + "<link name=\"l\"><pose>", "&#49; ", "</pose></link>" + kSdfEnd, 20'000},
        Kind{"comments", kSdf, "<!-- @ -->\n", kSdfEnd, 10'000},
        Kind{"links of a URDF file", kUrdfBegin,
             "<link name=\"l@\"/><joint name=\"j@\" type=\"fixed\"><parent link=\"base\"/><child "
             "link=\"l@\"/></joint>\n",
             kUrdfEnd, 30},
        Kind{"unknown elements of a URDF file", kUrdfBegin, "<x@/>\n", kUrdfEnd, 2000},
        Kind{"attributes of a URDF file", "<robot name=\"m\" ", "a@=\"\" ",
             "><link name=\"base\"/>" + kUrdfEnd, 2000},
        Kind{"comments in a URDF file", kUrdfBegin, "<!-- @ -->\n", kUrdfEnd, 10'000},
        Kind{"damaged meshes", kSdf + kSdfEnd + "\n", "<!--coopdyn:mesh mesh:@ AAAA-->\n", "", 5000}));

}  // namespace
}  // namespace coopdyn
