// SPDX-License-Identifier: MIT
// The bytes are those of real programs of YARP.
#include "server/yarp/carrier.h"

#include <gtest/gtest.h>

#include "protocol/codec.h"
#include "tests/cpu.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

using Kind = YarpInput::Kind;

const std::string kTcpHello = Hex("'YA' e41e0000 'RP' 06000000 '/c3/w_'");
const std::string kIndex = Hex("'YA' 0a000000 'RP'");
const std::string kQuit = kIndex + Hex("0101 ffffffffffffffff 0a000000 00000000 02000000 7e000001 'q_'");
const std::string kData =
    kIndex + Hex("0201 ffffffffffffffff 08000000 08000000 00000000 00000000 7e440001 0100000002000000");

TEST(YarpCarrier, ConnectionsOfYarpAreKnownByTheirFirstBytes) {
  EXPECT_EQ(BeginsYarp(kTcpHello), Match::kYes);
  EXPECT_EQ(BeginsYarp("CONNECT /robot\r\n"), Match::kYes);
  EXPECT_EQ(BeginsYarp("CONNACK <ping>\r\n"), Match::kYes);
  for (const char* other : {"ping\n", "CDS1", "GET / HTTP/1.1\r\n", "CONNECT host:80 HTTP/1.1\r\n", "YA\n",
                            "YAW 1 2\n", "CONN\n", "0 \"\" 10 0 0\n"})
    EXPECT_EQ(BeginsYarp(other), Match::kNo) << other;
  EXPECT_EQ(BeginsYarp("CONNECT " + std::string(2000, 'x')), Match::kNo);
}

TEST(YarpCarrier, FirstBytesThatMayBecomeAConnectionOfYarpWait) {
  for (std::size_t size = 0; size < 8; ++size)
    EXPECT_EQ(BeginsYarp(std::string_view(kTcpHello).substr(0, size)), Match::kMaybe) << size;
  for (const char* begin : {"C", "CONN", "CONNECT ", "CONNECT /robot"})
    EXPECT_EQ(BeginsYarp(begin), Match::kMaybe) << begin;
}

TEST(YarpCarrier, AHelloNamesCarrierAndSender) {
  const std::pair<std::string, YarpCarrier> kHellos[] = {
      {kTcpHello, YarpCarrier::kTcp},
      {Hex("'YA' 641e0000 'RP' 06000000 '/c3/w_'"), YarpCarrier::kFastTcp},
      {Hex("'YA' 611e0000 'RP' 06000000 '/c3/w_'"), YarpCarrier::kUdp},
      {Hex("'YA' e11e0000 'RP' 06000000 '/c3/w_'"), YarpCarrier::kUdp},
      {"CONNECT /c3/w\r\n", YarpCarrier::kText},
      {"CONNACK /c3/w\n", YarpCarrier::kTextAck},
      {"CONNECT /c3/w (send portmonitor) (type lua)\r\n", YarpCarrier::kText},
  };
  for (const auto& [bytes, carrier] : kHellos) {
    YarpReader reader;
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_EQ(reader.Next(std::string_view(bytes).substr(0, size)).kind, Kind::kNeedMore) << size;
    const YarpInput hello = reader.Next(bytes + "more");
    EXPECT_EQ(hello.kind, Kind::kHello);
    EXPECT_EQ(hello.text, "/c3/w");
    EXPECT_EQ(hello.consumed, bytes.size());
    EXPECT_EQ(reader.carrier(), carrier);
  }
}

TEST(YarpCarrier, APlugInThatWouldRunHereIsRefused) {
  for (const YarpCarrier carrier : {YarpCarrier::kTcp, YarpCarrier::kFastTcp, YarpCarrier::kUdp,
                                    YarpCarrier::kText, YarpCarrier::kTextAck}) {
    YarpReader reader;
    const YarpInput hello = reader.Next(YarpHello(carrier, "/me (recv portmonitor) (type dll)"));
    EXPECT_EQ(hello.kind, Kind::kBroken);
    EXPECT_THAT(hello.text, testing::HasSubstr("connect without +recv"));
  }
}

TEST(YarpCarrier, OtherCarriersAreRefused) {
  YarpReader reader;
  EXPECT_EQ(reader.Next(Hex("'YA' 631e0000 'RP' 06000000 '/c3/w_'")).kind, Kind::kBroken);  // shmem
}

TEST(YarpCarrier, AFrameHasItsCommandAndPayload) {
  YarpReader reader;
  reader.Next(kTcpHello);
  for (std::size_t size = 0; size < kData.size(); ++size)
    ASSERT_EQ(reader.Next(std::string_view(kData).substr(0, size)).kind, Kind::kNeedMore) << size;
  const YarpInput data = reader.Next(kData + kQuit);
  EXPECT_EQ(data.kind, Kind::kCommand);
  EXPECT_EQ(data.text, "D");
  EXPECT_EQ(data.payload, Hex("0100000002000000"));
  EXPECT_EQ(data.consumed, kData.size());
  EXPECT_EQ(reader.Next(kQuit).text, "q");
}

TEST(YarpCarrier, AnEnvelopeIsPartOfTheCommand) {
  YarpReader reader;
  reader.Next(kTcpHello);
  const YarpInput data =
      reader.Next(kIndex + Hex("0101 ffffffffffffffff 12000000 00000000 09000000 7e000001 'D 7 12.5_' ff"));
  EXPECT_EQ(data.text, "D");
  EXPECT_EQ(data.envelope, "7 12.5");
  EXPECT_EQ(data.payload, "\xff");
}

TEST(YarpCarrier, FramesThatDoNotAddUpAreRefused) {
  const std::string kBad[] = {
      "GET / HTTP/1.1\r\n\r\n",                                                   // no frame
      Hex("'YA' 0b000000 'RP' 0000"),                                             // another index
      kIndex + Hex("0101 ffffffffffffffff ffffffff 00000000"),                    // negative size
      kIndex + Hex("0101 ffffffffffffffff ffffff7f 00000000"),                    // too large
      kIndex + Hex("0101 ffffffffffffffff 08000000 00000000 00000000 00440001"),  // no '~'
      kIndex + Hex("0101 ffffffffffffffff 02000000 00000000 0000"),               // too short
      kIndex + Hex("0101 ffffffffffffffff 08000000 00000000 ff000000 7e000001"),  // a command beyond the end
  };
  for (const std::string& bytes : kBad) {
    YarpReader reader;
    reader.Next(kTcpHello);
    EXPECT_EQ(reader.Next(bytes).kind, Kind::kBroken) << bytes;
  }
}

TEST(YarpCarrier, TextMessagesEndWhenTheirListsDo) {
  YarpReader reader;
  reader.Next("CONNECT /me\r\n");
  EXPECT_EQ(reader.Next("d\r\n").kind, Kind::kNeedMore);
  EXPECT_EQ(reader.Next("d\r\nset (1\r\n").kind, Kind::kNeedMore);
  const YarpInput data = reader.Next("d\r\nset (1\r\n2)\r\nq\r\n");
  EXPECT_EQ(data.text, "d");
  EXPECT_EQ(data.payload, "set (1 2)");
  EXPECT_EQ(reader.Next("q\r\n").text, "q");
  EXPECT_EQ(reader.Next("D 3 1.5\r\nx\r\n").envelope, "3 1.5");
}

TEST(YarpCarrier, ALongTextMessageTakesTimeInProportionToItsLength) {
  const auto read = [](std::size_t lines) {
    YarpReader reader;
    reader.Next("CONNECT /me\r\n");
    const std::string text = "d\r\n(" + std::string(lines, '\n');
    for (std::size_t size = 1000; size < text.size(); size += 1000) reader.Next(text.substr(0, size));
    EXPECT_EQ(reader.Next(text + ")\r\n").kind, Kind::kCommand);
  };
  ExpectLinear(read, 20'000);
}

TEST(YarpCarrier, AnEndlessTextMessageIsRefused) {
  YarpReader reader;
  reader.Next("CONNECT /me\r\n");
  EXPECT_EQ(reader.Next("d\r\n(" + std::string(kMaxRequestBytes, ' ')).kind, Kind::kBroken);
}

TEST(YarpCarrier, AcknowledgementsAreThoseOfTheCarrier) {
  EXPECT_EQ(YarpAck(YarpCarrier::kTcp), Hex("'YA' 00000000 'RP'"));
  EXPECT_EQ(YarpAck(YarpCarrier::kTextAck), "<ACK>\r\n");
  EXPECT_EQ(YarpAck(YarpCarrier::kFastTcp), "");
  EXPECT_EQ(YarpAck(YarpCarrier::kText), "");
  EXPECT_EQ(YarpWelcome(YarpCarrier::kTcp, "/c3/w", 11060), Hex("'YA' 342b0000 'RP'"));
  EXPECT_EQ(YarpWelcome(YarpCarrier::kTextAck, "foo", 1), "Welcome foo\r\n");
}

TEST(YarpCarrier, WhoOpensAConnectionSaysItsName) {
  EXPECT_EQ(YarpHello(YarpCarrier::kTcp, "/fake3/state:o"),
            Hex("'YA' e41e0000 'RP' 0f000000 '/fake3/state:o' 00"));
  EXPECT_EQ(YarpHello(YarpCarrier::kTextAck, "/a"), "CONNACK /a\r\n");
  for (const YarpCarrier carrier : {YarpCarrier::kTcp, YarpCarrier::kFastTcp, YarpCarrier::kUdp,
                                    YarpCarrier::kText, YarpCarrier::kTextAck}) {
    EXPECT_EQ(CarrierNamed(CarrierName(carrier)), carrier);
    YarpReader reader;
    EXPECT_EQ(reader.Next(YarpHello(carrier, "/me (send portmonitor)")).text, "/me");
    EXPECT_EQ(reader.carrier(), carrier);
    const std::string welcome = YarpWelcome(carrier, "/me", 11064);
    EXPECT_EQ(WelcomeBytes(carrier, welcome + "more"), welcome.size());
    EXPECT_EQ(WelcomeBytes(carrier, welcome.substr(0, 4)), 0u);
    EXPECT_FALSE(WelcomeBytes(carrier, "HTTP/1.1 400 Bad Request\r\n"));
  }
  EXPECT_EQ(WelcomePort(Hex("'YA' 382b0000 'RP'")), 11064);
  EXPECT_EQ(CarrierNamed("mcast"), YarpCarrier::kOther);
  EXPECT_EQ(CarrierNamed("unknown"), YarpCarrier::kOther);
}

TEST(YarpCarrier, WhatIsWrittenIsRead) {
  for (const YarpCarrier carrier : {YarpCarrier::kFastTcp, YarpCarrier::kText}) {
    YarpReader reader;
    reader.Next(YarpHello(carrier, "/me"));
    std::string bytes;
    AppendYarpMessage(carrier, "D 3598 12.5", "1 2", bytes);
    AppendYarpMessage(carrier, "q", "", bytes);
    const YarpInput data = reader.Next(bytes);
    EXPECT_EQ(data.text, "D");
    EXPECT_EQ(data.envelope, "3598 12.5");
    EXPECT_EQ(data.payload, "1 2");
    EXPECT_EQ(reader.Next(bytes.substr(data.consumed)).text, "q");
  }
}

}  // namespace
}  // namespace coopdyn
