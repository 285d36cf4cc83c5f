// SPDX-License-Identifier: MIT
#include "server/web/http_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using testing::HasSubstr;

HttpRequestHead Get(std::string_view target) {
  HttpRequestHead head;
  head.method = "GET";
  head.target = target;
  head.hosts = {"127.0.0.1:10001"};
  return head;
}

HttpRequestHead PostCall() {
  HttpRequestHead head = Get("/api/call");
  head.method = "POST";
  head.content_type = "application/json";
  return head;
}

unsigned StatusOf(const HttpRequestHead& head) {
  const HttpRoute route = FindRoute(head, {"labserver"});
  return route.kind == HttpRouteKind::kRefused ? route.refusal.status : 200;
}

TEST(Routes, LeadToWhatIsAskedFor) {
  const std::vector<std::pair<const char*, HttpRouteKind>> routes = {
      {"/", HttpRouteKind::kAsset},
      {"/app.js", HttpRouteKind::kAsset},
      {"/?token=x", HttpRouteKind::kAsset},
      {"/snapshot.png", HttpRouteKind::kSnapshot},
      {"/view.mjpg", HttpRouteKind::kStream},
      {"/api/status", HttpRouteKind::kStatus},
      {"/api/costs", HttpRouteKind::kCosts},
      {"/api/modules", HttpRouteKind::kModules},
      {"/api/scenarios", HttpRouteKind::kNames},
      {"/api/worlds", HttpRouteKind::kNames},
      {"/api/robots", HttpRouteKind::kNames},
      {"/api/gallery", HttpRouteKind::kGallery},
      {"/thumb/robot/coopbot.png", HttpRouteKind::kThumb}};
  for (const auto& [target, kind] : routes) EXPECT_EQ(FindRoute(Get(target), {}).kind, kind) << target;
  EXPECT_EQ(FindRoute(PostCall(), {}).kind, HttpRouteKind::kCall);
  for (const auto& [target, kind] :
       {std::pair("/api/check", HttpRouteKind::kCheck), std::pair("/api/upload", HttpRouteKind::kUpload)}) {
    HttpRequestHead head = PostCall();
    head.target = target;
    EXPECT_EQ(FindRoute(head, {}).kind, kind) << target;
  }
  HttpRequestHead socket = Get("/ws");
  socket.upgrade = true;
  EXPECT_EQ(FindRoute(socket, {}).kind, HttpRouteKind::kSocket);
}

TEST(Routes, TextsAreTakenFromTheOwnPageAsJsonOnly) {
  for (const char* target : {"/api/check", "/api/upload"}) {
    HttpRequestHead head = PostCall();
    head.target = target;
    head.origin = "http://evil.example";
    EXPECT_EQ(StatusOf(head), 403U) << target;
    head.origin = "http://127.0.0.1:10001";
    EXPECT_EQ(StatusOf(head), 200U) << target;
    head.content_type = "text/plain";
    EXPECT_EQ(StatusOf(head), 415U) << target;
    head.method = "GET";
    EXPECT_EQ(StatusOf(head), 405U) << target;
  }
}

TEST(Routes, ThumbsHaveAKindAndAName) {
  const HttpRoute route = FindRoute(Get("/thumb/world/a%20b.png"), {});
  EXPECT_EQ(route.thumb_kind, "world");
  EXPECT_EQ(route.thumb, "a b");
  for (const char* target :
       {"/thumb/world/.png", "/thumb/planet/x.png", "/thumb/world/x", "/thumb/world/x.jpg"}) {
    EXPECT_EQ(StatusOf(Get(target)), 404U) << target;
  }
}

TEST(Routes, UnknownPathsAre404) {
  for (const char* target : {"/nothing", "/../etc/passwd", "/api", "/app.js/", "//"}) {
    EXPECT_EQ(StatusOf(Get(target)), 404U) << target;
  }
  EXPECT_EQ(StatusOf(Get("http://127.0.0.1:10001/")), 400U);
}

TEST(Routes, WrongMethodsAre405AndSayWhichAreRight) {
  HttpRequestHead head = Get("/");
  head.method = "DELETE";
  const HttpRoute route = FindRoute(head, {});
  EXPECT_EQ(route.refusal.status, 405U);
  EXPECT_THAT(route.refusal.headers, testing::Contains(testing::Pair("Allow", "GET, HEAD")));
  EXPECT_EQ(StatusOf(Get("/api/call")), 405U);
  head.target = "/nothing";
  EXPECT_EQ(StatusOf(head), 404U);
}

TEST(Routes, NamesOfOtherHostsAreRefused) {
  HttpRequestHead head = Get("/");
  head.hosts = {"rebound.example:10001"};
  const HttpRoute route = FindRoute(head, {"labserver"});
  EXPECT_EQ(route.refusal.status, 403U);
  EXPECT_THAT(route.refusal.body, HasSubstr("--advertise rebound.example"));
  head.hosts = {"labserver:10001"};
  EXPECT_EQ(StatusOf(head), 200U);
}

TEST(Routes, TheHostHeaderMustBeThereOnce) {
  HttpRequestHead head = Get("/");
  head.hosts = {};
  EXPECT_EQ(StatusOf(head), 400U);
  head.http_1_1 = false;
  EXPECT_EQ(StatusOf(head), 200U);
  head.hosts = {"localhost", "localhost"};
  EXPECT_EQ(StatusOf(head), 400U);
  head.hosts = {"<script>"};
  EXPECT_EQ(StatusOf(head), 400U);
}

TEST(Routes, ChangingRequestsOfOtherPagesAreRefused) {
  for (const char* origin :
       {"http://evil.example", "null", "http://127.0.0.1:8000", "http://localhost:10001"}) {
    HttpRequestHead call = PostCall();
    call.origin = origin;
    EXPECT_EQ(StatusOf(call), 403U) << origin;
    HttpRequestHead socket = Get("/ws");
    socket.upgrade = true;
    socket.origin = origin;
    EXPECT_EQ(StatusOf(socket), 403U) << origin;
  }
  HttpRequestHead own = PostCall();
  own.origin = "http://127.0.0.1:10001";
  EXPECT_EQ(StatusOf(own), 200U);
}

TEST(Routes, CallsMustBeJson) {
  HttpRequestHead call = PostCall();
  for (const char* type : {"", "text/plain", "application/x-www-form-urlencoded", "application/jsonp"}) {
    call.content_type = type;
    EXPECT_EQ(StatusOf(call), 415U) << type;
  }
  call.content_type = "Application/JSON; charset=utf-8";
  EXPECT_EQ(StatusOf(call), 200U);
}

TEST(Routes, ASocketNeedsAnUpgrade) {
  EXPECT_EQ(StatusOf(Get("/ws")), 426U);
}

TEST(ImageQuery, IsReadFromTheUrl) {
  ImageRequest request;
  EXPECT_EQ(ReadImageQuery("w=320&h=200&eye=-3,0,2.5&look=1%2C2%2C0&rays=1", request), "");
  EXPECT_EQ(request.width, 320);
  EXPECT_EQ(request.height, 200);
  EXPECT_EQ(request.eye_m, Vector3(-3, 0, 2.5));
  EXPECT_EQ(request.look_m, Vector3(1, 2, 0));
  EXPECT_TRUE(request.show_rays);
}

TEST(ImageQuery, EmptyMeansTheWholeScene) {
  ImageRequest request;
  EXPECT_EQ(ReadImageQuery("", request), "");
  EXPECT_EQ(request, ImageRequest{});
}

TEST(ImageQuery, SaysWhatIsWrong) {
  for (const char* query : {"w=abc", "w=1e3", "w=0", "h=100000", "w=-5", "eye=1,2", "eye=1,2,3,4",
                            "eye=a,b,c", "eye=", "look=nan,0,0", "look=1e9,0,0", "rays=yes", "zoom=2",
                            "w=%zz", "w=%2", "eye=1,1,1&look=1,1,1", "w=99999999999"}) {
    ImageRequest request;
    EXPECT_NE(ReadImageQuery(query, request), "") << query;
    EXPECT_EQ(StatusOf(Get("/snapshot.png?" + std::string(query))), 400U) << query;
  }
}

TEST(Assets, HaveTypeAndTag) {
  const Asset* page = FindAsset("/");
  ASSERT_NE(page, nullptr);
  const HttpAnswer answer = AnswerAsset(*page, "");
  EXPECT_EQ(answer.type, "text/html; charset=utf-8");
  EXPECT_THAT(answer.body, HasSubstr("<!doctype html>"));
  EXPECT_EQ(FindAsset("/style.css")->path, "/style.css");
  const HttpAnswer again = AnswerAsset(*page, EntityTag(*page));
  EXPECT_EQ(again.status, 304U);
  EXPECT_EQ(again.body, "");
  EXPECT_EQ(AnswerAsset(*page, "\"other\"").status, 200U);
}

TEST(Assets, ThePageNamesNoOtherHost) {
  for (const Asset& asset : Assets()) {
    if (asset.path.ends_with(".zip") || asset.path.ends_with(".py")) continue;
    std::string text(asset.bytes);
    if (const auto at = text.find("http://www.w3.org/2000/svg"); at != std::string::npos) text.erase(at, 7);
    EXPECT_EQ(text.find("http://"), std::string::npos) << asset.path;
    EXPECT_EQ(text.find("https://"), std::string::npos) << asset.path;
    EXPECT_EQ(text.find("innerHTML"), std::string::npos) << asset.path;
  }
}

}  // namespace
}  // namespace coopdyn
