// SPDX-License-Identifier: MIT
#include "clients/cpp/json.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "clients/cpp/error.h"
#include "protocol/codec.h"
#include "tests/source_dir.h"

namespace coopdyn::client {
namespace {

TEST(Json, ReadsEveryKindOfValue) {
  const Json json =
      Json::Parse(R"( {"a": [1, -2.5e3, true, false, null], "b": {"c": "x\n\u00e9\ud83e\udd16"}} )");
  EXPECT_EQ(json["a"].size(), 5u);
  EXPECT_EQ(json["a"][1].number(), -2500);
  EXPECT_TRUE(json["a"][2].boolean());
  EXPECT_TRUE(json["a"][4].is_null());
  EXPECT_EQ(json["b"]["c"].text(), "x\n\xC3\xA9\xF0\x9F\xA4\x96");
}

TEST(Json, WhatIsNotThereReadsAsNull) {
  const Json json = Json::Parse("{\"a\": []}");
  EXPECT_TRUE(json["a"][3]["b"].is_null());
  EXPECT_EQ(json["zz"].text(), "");
}

TEST(Json, RefusesWhatIsNotJson) {
  for (const char* bad : {"", "{", "[1,]", "{\"a\" 1}", "tru", "\"\\q\"", "\"abc", "1 2", "\"\\u12\"", "nul"})
    EXPECT_THROW(Json::Parse(bad), Error) << bad;
  EXPECT_THROW(Json::Parse(std::string(5000, '[')), Error);
}

std::string FromHex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(Codec, EveryGoldenVectorIsDecodedAndEncodedToItsBytes) {
  std::ifstream file(SourceDir() + "/tests/protocol/vectors/messages.json");
  const Json vectors = Json::Parse(std::string(std::istreambuf_iterator<char>(file), {}));
  ASSERT_GT(vectors.size(), 20u);
  for (const Json& v : vectors.items()) {
    const std::string raw = FromHex(v["binary_hex"].text());
    const Decoded decoded = DecodeBinary(raw, kMaxReplyBytes);
    ASSERT_EQ(decoded.status, DecodeStatus::kMessage) << v["name"].text();
    EXPECT_EQ(decoded.consumed, raw.size());
    EXPECT_EQ(decoded.message.text, v["text"].text());
    EXPECT_EQ(decoded.message.command, v["command"].number());
    std::string again;
    EncodeBinary(decoded.message, again);
    EXPECT_EQ(again, raw) << v["name"].text();
  }
}

}  // namespace
}  // namespace coopdyn::client
