// SPDX-License-Identifier: MIT
// Experiments eight times as long take about eight times as long to read, valid and invalid ones alike.

#include "tests/cpu.h"
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

using Kind = GrowingText;

class LinearTest : public testing::TestWithParam<Kind> {};

TEST_P(LinearTest, Reading) {
  ExpectLinear([&](std::size_t n) { Said(GetParam().Of(n)); }, GetParam().size);
}

const std::string kExperiment = "<rosiml version=\"0.8.41\"><simulator frequency=\"100\"/>",
                  kEnvironment = kExperiment + "<environment>",
                  kRobots = kExperiment + "<environment/><robots>", kRobotsEnd = "</robots></rosiml>";

INSTANTIATE_TEST_SUITE_P(
    OfExperiments, LinearTest,
    testing::Values(
        Kind{"things", kEnvironment, Ball("b@"), "</environment><robots/></rosiml>", 500},
        Kind{"robots", kRobots,
             "<robot name=\"r@\"><body>" + Ball("b") + "</body><actuators/><sensors/></robot>", kRobotsEnd,
             200},
        Kind{"bodies of one robot", kRobots + "<robot name=\"r\"><body>", Ball("b@"),
             "</body><actuators/><sensors/></robot>" + kRobotsEnd, 100},
        Kind{"bodies of one name", kRobots + "<robot name=\"r\"><body>", Ball("b"),
             "</body><actuators/><sensors/></robot>" + kRobotsEnd, 500},
        Kind{"hinges to the world", kRobots + "<robot name=\"r\"><body>" + Ball("b") + "</body><actuators>",
             "<hinge name=\"j@\" type=\"active\" mode=\"positional\"><source name=\"b\"/><force "
             "max=\"2\"/><velocity max=\"5\"/><pose/></hinge>\n",
             "</actuators><sensors/></robot>" + kRobotsEnd, 200},
        Kind{"macros", kExperiment + "<macros>", "<macro name=\"m@\"><box/></macro>",
             "</macros><environment/>" + kRobotsEnd, 500},
        Kind{"unknown elements", kRobots, "<x@/>\n", kRobotsEnd, 2000},
        Kind{"elements within each other", kRobots, "<x>", kRobotsEnd, 4000},
        Kind{"elements without end", kExperiment, "<x", "", 20'000},
        Kind{"unknown attributes", kExperiment + "<environment", " a@=\"1\"", "/><robots>" + kRobotsEnd,
             2000},
        Kind{"an attribute", kExperiment + "<environment a=\"", "x", "\"/><robots>" + kRobotsEnd, 200'000},
        Kind{"text", kRobots, "x ", kRobotsEnd, 100'000},
        Kind{"comments", kRobots, "<!-- @ -->\n", kRobotsEnd, 20'000},
        Kind{"comments without end", kRobots, "<!-- ", kRobotsEnd, 50'000},
        Kind{"entities", kRobots, "&amp;", kRobotsEnd, 50'000},
        Kind{"signs", kRobots, "&", kRobotsEnd, 50'000},
        Kind{"empty lines", kRobots, "\n", kRobotsEnd, 200'000}));

}  // namespace
}  // namespace coopdyn::rosiml
