// SPDX-License-Identifier: MIT
#include "server/web/page_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web_fixture.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

constexpr const char* kJson = "Content-Type: application/json\r\n";
constexpr const char* kBody = R"({"name":"a.world","text":"[BOX_1]\n"})";

WebOptions WithFiles() {
  WebOptions options = WebWorld::DefaultOptions();
  options.files.check = [](const WebFile& file, const WebFiles::Done& done) {
    done(JsonAnswer("checked " + file.name + " " + file.text));
  };
  options.files.upload = [](const WebFile& file, const WebFiles::Done& done) {
    done(ErrorAnswer(400, "kept " + file.name));
  };
  options.files.thumb = [](const std::string& kind, const std::string& name, const WebFiles::Done& done) {
    done({.body = kind + " " + name, .type = "image/png"});
  };
  return options;
}

TEST(PageFiles, TextsGoToWhoeverChecksThem) {
  WebWorld world(WithFiles());
  const HttpReply reply = Fetch(world.port, "POST", "/api/check", kBody, kJson);
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "checked a.world [BOX_1]\n\n");
}

TEST(PageFiles, WhatIsNoFileIsRefusedInWords) {
  WebWorld world(WithFiles());
  for (const char* body :
       {"", "[]", "{", R"({"name":"a"})", R"({"name":1,"text":""})", R"({"name":"","text":""})"}) {
    const HttpReply reply = Fetch(world.port, "POST", "/api/check", body, kJson);
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_THAT(reply.body, HasSubstr("\"")) << body;
  }
}

TEST(PageFiles, AnswersOfOthersKeepTheirStatus) {
  WebWorld world(WithFiles());
  EXPECT_EQ(Fetch(world.port, "POST", "/api/upload", kBody, kJson).status, 400);
  const HttpReply thumb = Fetch(world.port, "GET", "/thumb/robot/x.png");
  EXPECT_EQ(thumb.body, "robot x");
  EXPECT_THAT(thumb.header, HasSubstr("image/png"));
}

TEST(PageFiles, WithoutFilesThereIsNothing) {
  WebWorld world;
  EXPECT_EQ(Fetch(world.port, "GET", "/api/gallery").status, 404);
}

}  // namespace
}  // namespace coopdyn
