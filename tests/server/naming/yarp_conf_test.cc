// SPDX-License-Identifier: MIT
#include "server/naming/yarp_conf.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace coopdyn {
namespace {

std::string FileWith(std::map<std::string, std::string> variables) {
  return YarpConfFile([&](const char* name) { return variables[name]; });
}

TEST(YarpConf, IsWhereYarpHasIt) {
  EXPECT_EQ(FileWith({{"HOME", "/home/me"}}), "/home/me/.config/yarp/yarp.conf");
  EXPECT_EQ(FileWith({{"HOME", "/home/me"}, {"XDG_CONFIG_HOME", "/etc/x"}}), "/etc/x/yarp/yarp.conf");
  EXPECT_EQ(FileWith({{"XDG_CONFIG_HOME", "/etc/x"}, {"YARP_CONFIG_HOME", "/y"}}), "/y/yarp.conf");
}

TEST(YarpConf, EachNamespaceHasItsFile) {
  EXPECT_EQ(FileWith({{"YARP_CONFIG_HOME", "/y"}, {"YARP_NAMESPACE", "/lab"}}), "/y/_lab.conf");
  EXPECT_EQ(FileWith({{"YARP_CONFIG_HOME", "/y"}, {"YARP_NAMESPACE", "/lab/two"}}), "/y/_lab_two.conf");
  EXPECT_EQ(FileWith({{"YARP_CONFIG_HOME", "/y"}, {"YARP_NAMESPACE", "/root"}}), "/y/yarp.conf");
}

TEST(YarpConf, HasTheServerInOneLineOrInTwo) {
  EXPECT_EQ(ServerInYarpConf("127.0.0.1 10000 yarp\n"), "127.0.0.1:10000");
  EXPECT_EQ(ServerInYarpConf("lab 10100\n"), "lab:10100");
  EXPECT_EQ(ServerInYarpConf("[name]\nhost lab\nport 10100\nmode yarp\n"), "lab:10100");
  EXPECT_EQ(ServerInYarpConf("::1 10000 yarp"), "[::1]:10000");
}

TEST(YarpConf, MayHaveNone) {
  for (const char* text : {"", "\n\n", "lab", "lab port", "[name]\nhost lab\n", "host lab\nport x\n"})
    EXPECT_EQ(ServerInYarpConf(text), "") << text;
}

}  // namespace
}  // namespace coopdyn
