// SPDX-License-Identifier: MIT
#include "server/yarp/links.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

namespace coopdyn {
namespace {

/// A session's socket, and its far end.
struct Pair {
  Pair() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    session = UniqueFd(ends[0]);
    far = UniqueFd(ends[1]);
  }
  bool ended() const {
    char byte = 0;
    return ::recv(session.get(), &byte, 1, MSG_DONTWAIT) == 0;
  }
  UniqueFd session, far;
};

YarpLink Out(const std::string& port, const std::string& other) {
  return {port, other, "tcp", YarpLink::Way::kOut};
}

TEST(YarpLinks, ListsWhatAPortHasOpened) {
  YarpLinks links;
  const Pair pair;
  links.Add(Out("/a/state:o", "/x"), pair.session);
  const YarpLinks::Id second = links.Add(Out("/a/state:o", "/y"), pair.session);
  links.Add(Out("/b/state:o", "/z"), pair.session);
  links.Add({"/a/state:o", "/sender", "udp", YarpLink::Way::kIn}, pair.session);
  ASSERT_EQ(links.From("/a/state:o").size(), 2u);
  EXPECT_EQ(links.From("/a/state:o")[0].other, "/x");
  links.Forget(second);
  EXPECT_EQ(links.From("/a/state:o").size(), 1u);
  EXPECT_FALSE(pair.ended());
}

TEST(YarpLinks, EndingOneEndsTheInputOfItsSession) {
  YarpLinks links;
  const Pair pair, other;
  links.Add(Out("/a", "/x"), pair.session);
  links.Add(Out("/a", "/y"), other.session);
  EXPECT_FALSE(links.End("/a", "/x", YarpLink::Way::kIn));
  EXPECT_TRUE(links.End("/a", "/x", YarpLink::Way::kOut));
  EXPECT_TRUE(pair.ended());
  EXPECT_FALSE(other.ended());
  EXPECT_FALSE(links.End("/a", "/x", YarpLink::Way::kOut));
}

TEST(YarpLinks, OfTooManyThatComeInTheOldestEnds) {
  YarpLinks links;
  const Pair out, first, second;
  links.Add(Out("/a", "/x"), out.session);
  links.Add({"/a", "/first", "udp", YarpLink::Way::kIn}, first.session);
  links.Add({"/a", "/second", "udp", YarpLink::Way::kIn}, second.session);
  const Pair more;
  for (std::size_t i = 2; i < YarpLinks::kMaxInputs; ++i)
    links.Add({"/a", "/more", "udp", YarpLink::Way::kIn}, more.session);
  EXPECT_FALSE(first.ended());
  links.Add({"/a", "/last", "udp", YarpLink::Way::kIn}, more.session);
  EXPECT_TRUE(first.ended());
  EXPECT_FALSE(second.ended());
  EXPECT_FALSE(out.ended());
}

}  // namespace
}  // namespace coopdyn
