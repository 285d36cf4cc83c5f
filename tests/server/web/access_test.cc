// SPDX-License-Identifier: MIT
#include "server/web/access.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(Host, IsTheNameWithoutPort) {
  EXPECT_EQ(HostName("LabServer:10001"), "labserver");
  EXPECT_EQ(HostName("127.0.0.1"), "127.0.0.1");
  EXPECT_EQ(HostName("[::1]:10001"), "::1");
}

TEST(Host, MalformedOnesAreNoNames) {
  for (const char* host :
       {"", ":10001", "a b", "a:b", "a:1:2", "[::1", "[x]:1", "a/b", "a:123456", "user@host"}) {
    EXPECT_EQ(HostName(host), std::nullopt) << host;
  }
}

TEST(Host, AddressesAndLocalhostAreAlwaysOurs) {
  for (const char* host :
       {"127.0.0.1:10001", "192.168.7.3", "[fe80::1]:80", "localhost:10001", "LOCALHOST"}) {
    EXPECT_TRUE(HostAllowed(host, {})) << host;
  }
}

TEST(Host, OtherNamesMustBeConfigured) {
  EXPECT_FALSE(HostAllowed("evil.example:10001", {"labserver"}));
  EXPECT_FALSE(HostAllowed("labserver.evil.example", {"labserver"}));
  EXPECT_FALSE(HostAllowed("127.0.0.1.evil.example", {}));
  EXPECT_FALSE(HostAllowed("localhost.evil.example", {}));
  EXPECT_TRUE(HostAllowed("labserver:10001", {"LabServer"}));
}

TEST(Origin, MustBeTheHostThatWasAsked) {
  EXPECT_TRUE(OriginAllowed("http://127.0.0.1:10001", "127.0.0.1:10001"));
  EXPECT_TRUE(OriginAllowed("https://LabServer", "labserver"));
  for (const char* origin :
       {"http://127.0.0.1:10002", "http://localhost:10001", "null", "http://evil.example", "127.0.0.1:10001",
        "file://127.0.0.1:10001", "http://127.0.0.1:10001.evil.example"}) {
    EXPECT_FALSE(OriginAllowed(origin, "127.0.0.1:10001")) << origin;
  }
}

TEST(Token, IsReadFromTheAuthorizationHeader) {
  EXPECT_EQ(BearerToken("Bearer abc"), "abc");
  EXPECT_EQ(BearerToken("bearer abc"), "abc");
  EXPECT_EQ(BearerToken("Basic abc"), "");
  EXPECT_EQ(BearerToken(""), "");
}

}  // namespace
}  // namespace coopdyn
