// SPDX-License-Identifier: MIT
#include "server/host/class_routes.h"

#include <gtest/gtest.h>

#include "server/host/front_door.h"
#include "server/host/sheet.h"

namespace coopdyn {
namespace {

using Kind = ClassRouteKind;

TEST(ClassRoute, OfASeatKeepsTheQueryForItsDaemon) {
  const ClassRoute route = FindClassRoute("/s/ana/snapshot.png?w=640");
  EXPECT_EQ(route.kind, Kind::kSeat);
  EXPECT_EQ(route.seat, "ana");
  EXPECT_EQ(route.rest, "/snapshot.png?w=640");
}

TEST(ClassRoute, OfASeatWithoutItsSlashHasNoRest) {
  EXPECT_EQ(FindClassRoute("/s/ana").rest, "");
  EXPECT_EQ(FindClassRoute("/s/ana/").rest, "/");
}

TEST(ClassRoute, WhatASeatsPageAsksTheHostIsNotPassedOn) {
  const ClassRoute route = FindClassRoute("/s/ana/class/events?x=1");
  EXPECT_EQ(route.kind, Kind::kSeatAsks);
  EXPECT_EQ(route.rest, "events");
}

TEST(ClassRoute, TheTeacherAtASeatIsNotTheStudent) {
  const ClassRoute route = FindClassRoute("/wall/s/ana/ws");
  EXPECT_EQ(route.kind, Kind::kWallSeat);
  EXPECT_EQ(route.seat, "ana");
  EXPECT_EQ(route.rest, "/ws");
}

TEST(ClassRoute, PagesAndTheirFilesAreAssets) {
  EXPECT_EQ(FindClassRoute("/").rest, "/login.html");
  EXPECT_EQ(FindClassRoute("/wall/").rest, "/wall.html");
  EXPECT_EQ(FindClassRoute("/wall/wall.js").rest, "/wall.js");
  EXPECT_EQ(FindClassRoute("/icon.svg").rest, "/icon.svg");
}

TEST(ClassRoute, OrdersOfTheWallAndLoginsHaveTheirOwn) {
  EXPECT_EQ(FindClassRoute("/wall/class/do").kind, Kind::kWallAsks);
  EXPECT_EQ(FindClassRoute("/wall/login").kind, Kind::kWallLogin);
  EXPECT_EQ(FindClassRoute("/login").kind, Kind::kLogin);
  EXPECT_EQ(FindClassRoute("/l/abc").rest, "abc");
}

TEST(Cookie, IsFoundByItsWholeName) {
  EXPECT_EQ(CookieIn("a=1; coopdyn_ana=secret; b=2", "coopdyn_ana"), "secret");
  EXPECT_EQ(CookieIn("xcoopdyn_ana=no; coopdyn_anabel=no", "coopdyn_ana"), "");
  EXPECT_EQ(CookieIn("", "coopdyn_ana"), "");
}

TEST(SeatLine, HasASeatAPinAndPerhapsALanguage) {
  const auto line = ReadSeatLine("SEAT ana 7305 python\r");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->seat, "ana");
  EXPECT_EQ(line->pin, "7305");
  EXPECT_EQ(line->language, "python");
  EXPECT_TRUE(ReadSeatLine("SEAT ana 7305"));
}

TEST(SeatLine, AnythingElseIsNone) {
  for (const char* bad :
       {"", "SEAT", "SEAT ana", "seat ana 1", "OPEN /x", "SEAT a b c d", "NAME_SERVER list"})
    EXPECT_FALSE(ReadSeatLine(bad)) << bad;
}

TEST(Sheet, ShowsNamesAsTextAndACodeForEach) {
  Roll roll;
  const RandomDigits digits{[](std::size_t n) { return std::string(n, 'a'); },
                            [](std::size_t n) { return std::string(n, '7'); }};
  roll.Add({.name = "<b>Ana & Co"}, digits);
  const std::string page = SheetPage(roll, "http://lab:10001/");
  EXPECT_NE(page.find("&lt;b&gt;Ana &amp; Co"), std::string::npos);
  EXPECT_EQ(page.find("<b>Ana"), std::string::npos);
  EXPECT_NE(page.find("http://lab:10001/l/aaaaaaaaaaaaaaaaaaaaaaaa"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
}

TEST(Sheet, ACodeTooLongIsLeftOut) {
  EXPECT_EQ(QrSvg(std::string(5000, 'x')), "");
}

TEST(FindClassRoute, ProgramsBelongToTheirSeat) {
  ClassRoute route = FindClassRoute("/s/ana/class/program?x");
  EXPECT_EQ(route.kind, ClassRouteKind::kProgram);
  EXPECT_EQ(route.seat + "|" + route.rest, "ana|");
  route = FindClassRoute("/s/ana/class/program/output/12");
  EXPECT_EQ(route.kind, ClassRouteKind::kProgram);
  EXPECT_EQ(route.seat + "|" + route.rest, "ana|output/12");
  EXPECT_EQ(FindClassRoute("/s/ana/class/programs").kind, ClassRouteKind::kSeatAsks);
}

TEST(FindClassRoute, TheTeacherAsksForProgramsOnTheWall) {
  ClassRoute route = FindClassRoute("/wall/class/programs/ana");
  EXPECT_EQ(route.kind, ClassRouteKind::kWallProgram);
  EXPECT_EQ(route.seat + "|" + route.rest, "ana|");
  route = FindClassRoute("/wall/class/programs/ana/stop");
  EXPECT_EQ(route.kind, ClassRouteKind::kWallProgram);
  EXPECT_EQ(route.seat + "|" + route.rest, "ana|stop");
}

}  // namespace
}  // namespace coopdyn
