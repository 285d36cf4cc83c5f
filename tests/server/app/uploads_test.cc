// SPDX-License-Identifier: MIT
#include "server/app/uploads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "server/app/gallery.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kWorld = "[FLOOR]\nsize 4 4 0.1\n";

struct UploadsTest : testing::Test {
  fs::path folder = Uploads::ChooseFolder();
  SearchPath path{{folder}};
  Uploads uploads{folder, path};
};

TEST_F(UploadsTest, NamesWithFoldersOrOddSignsAreRefused) {
  for (const char* name : {"../x.world", "a/b.world", "/etc/x.world", "..", ".world", "a b.world",
                           "a\n.world", "-x.world", "x.so", "x", "x.scenario", "x.xml", "<script>.world"}) {
    EXPECT_EQ(uploads.Keep(name, kWorld).status, 400U) << name;
  }
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(UploadsTest, AWorldIsFoundOnThePath) {
  const Upload upload = uploads.Keep("my.world", kWorld);
  EXPECT_EQ(upload.kind, "world");
  EXPECT_EQ(path.FindWorld(upload.name, {}), upload.file);
}

TEST_F(UploadsTest, WhatHasATakenNameGetsAnother) {
  uploads.Keep("my.world", kWorld);
  EXPECT_EQ(uploads.Keep("my.world", kWorld).name, "my_2.world");
}

TEST_F(UploadsTest, AModelBecomesARobotsType) {
  const Upload upload = uploads.Keep("arm.sdf", "<sdf version=\"1.9\"><model name=\"arm\"/></sdf>");
  EXPECT_EQ(upload.kind, "robot");
  EXPECT_EQ(path.FindRobot("arm"), upload.file);
  uploads.Remove(upload);
  EXPECT_FALSE(path.FindRobot("arm"));
}

TEST_F(UploadsTest, XacroIsRefused) {
  const std::string text = "<robot name=\"r\"><xacro:include filename=\"/etc/hostname\"/></robot>";
  const Upload upload = uploads.Keep("r.urdf", text);
  EXPECT_EQ(upload.status, 400U);
  EXPECT_THAT(upload.text, HasSubstr("send what 'xacro FILE' writes"));
  EXPECT_TRUE(uploads.Scratch("r.urdf", text).empty());
  EXPECT_EQ(uploads.Keep("s.urdf", "<robot name=\"s\"><!-- <xacro:a/> --></robot>").status, 200U);
}

TEST_F(UploadsTest, MuJoCosFilesAreRefused) {
  const std::string text = "<!-- a --><mujoco><include file=\"/etc/hostname\"/></mujoco>";
  for (const char* name : {"r.xml", "r.sdf", "r.world"}) {
    for (const std::string& start : {std::string(), std::string("\xEF\xBB\xBF")}) {  // a byte-order mark
      const Upload upload = uploads.Keep(name, start + text);
      EXPECT_EQ(upload.status, 400U);
      EXPECT_THAT(upload.text, HasSubstr("MuJoCo's files that are sent are not read here"));
    }
  }
}

TEST_F(UploadsTest, TheFolderIsForThisUserAloneAndGoesAtTheEnd) {
  {
    Uploads kept(folder, path);
    kept.Keep("my.world", kWorld);
    EXPECT_EQ(fs::status(folder).permissions() & fs::perms::all, fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(UploadsTest, ThereAreOnlySoMany) {
  for (std::size_t i = 0; i < Uploads::kMaxFiles; ++i)
    ASSERT_EQ(uploads.Keep("w" + std::to_string(i) + ".world", kWorld).status, 200U);
  EXPECT_EQ(uploads.Keep("more.world", kWorld).status, 413U);
}

TEST(GalleryTitles, AreTheFirstSentenceOfTheFirstComment) {
  EXPECT_EQ(Gallery::TitleOf("# Two walls\n# and a door. More.\n[WALL_1]\n"), "Two walls and a door.");
  EXPECT_EQ(Gallery::TitleOf("# The room of Fig. 4 of the paper.\n"), "The room of Fig. 4 of the paper.");
  EXPECT_EQ(Gallery::TitleOf("<?xml?>\n<!-- SPDX-License -->\n<!-- A ball. It rolls. -->"), "A ball.");
  EXPECT_EQ(Gallery::TitleOf("[WALL_1]\n# not this\n"), "");
}

TEST_F(UploadsTest, TheGalleryHasExperimentsAmongItsScenarios) {
  fs::create_directories(folder / "scenarios");
  std::ofstream(folder / "scenarios" / "fall.xml")
      << "<!-- A ball falls. It stops. -->\n<rosiml version=\"1.0\"><environment><sphere name=\"b\" "
         "radius=\"0.1\" mass=\"1\"><pose z=\"1\"/></sphere></environment><movables/></rosiml>";
  std::ofstream(folder / "scenarios" / "package.xml") << "<package/>";
  Gallery gallery(path, nullptr);
  const std::string list = gallery.List();
  EXPECT_THAT(list, HasSubstr("\"name\":\"fall\",\"title\":\"A ball falls.\""));
  EXPECT_THAT(list, testing::Not(HasSubstr("package")));
  EXPECT_THAT(gallery.TextOf("scenario", "fall").value_or(""), HasSubstr("<rosiml"));
}

TEST_F(UploadsTest, TheGalleryShowsNoFilesOutsideItsLists) {
  uploads.Keep("my.world", kWorld);
  Gallery gallery(path, nullptr);
  EXPECT_THAT(gallery.List(), HasSubstr("\"name\":\"my\""));
  for (const char* name : {"../my", "/etc/passwd", "", "my.world"})
    EXPECT_TRUE(gallery.Thumb("world", name).is_unknown) << name;
}

}  // namespace
}  // namespace coopdyn
