// SPDX-License-Identifier: MIT
// Lights and textures of scenarios and worlds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

TEST(LightsTest, ALight) {
  const auto scenario = Good(
      "[LIGHT_1]\nposition 1 2 300cm\ncolor 1 0.5 0\npower 2.5\nshadows no\n[LIGHT_2]\nposition 0 0 1\n");
  ASSERT_EQ(scenario->lights.size(), 2u);
  EXPECT_EQ(scenario->lights[0].name, "LIGHT_1");
  EXPECT_EQ(scenario->lights[0].p_WP, Vector3(1, 2, 3));
  EXPECT_EQ(scenario->lights[0].color, (Color{1, 0.5, 0}));
  EXPECT_EQ(scenario->lights[0].power, 2.5);
  EXPECT_FALSE(scenario->lights[0].casts_shadows);
  EXPECT_EQ(scenario->lights[1].color, (Color{1, 1, 1}));
  EXPECT_EQ(scenario->lights[1].power, 1);
  EXPECT_TRUE(scenario->lights[1].casts_shadows);
  EXPECT_THAT(Summary(*scenario), HasSubstr("2 lights"));
}

TEST(LightsTest, WrongLights) {
  EXPECT_THAT(Read("[LIGHT]\npower 1\n").messages,
              HasSubstr("test.scenario:1: error: [LIGHT] needs 'position', for example: position 2 0 1.5"));
  EXPECT_THAT(Read("[LIGHT]\nposition 1 2\n").messages, HasSubstr("test.scenario:2: error:"));
  EXPECT_THAT(Read("[LIGHT]\nposition 1 2 3\npower -1\n").messages, HasSubstr("test.scenario:3: error:"));
  EXPECT_THAT(Read("[LIGHT]\nposition 1 2 3\nshadow no\n").messages, HasSubstr("did you mean 'shadows'?"));
  EXPECT_THAT(Read("[LIGHT_3]\ntype box\nsize 1 1 1\nposition 1 2 3\n").messages,
              HasSubstr("[LIGHT_3] is a lamp"));
  std::string many;
  for (int i = 0; i < 101; ++i) many += "[LIGHT_" + std::to_string(i) + "]\nposition 0 0 1\n";
  EXPECT_THAT(Read(many).messages, HasSubstr("a scenario has at most 100 lights"));
}

TEST(LightsTest, AmbientLightOfTheSimulationCountsBeforeThatOfTheFloor) {
  EXPECT_EQ(Good("")->ambient_light, 0);
  EXPECT_EQ(Good("[FLOOR]\nambient_light 0.2\n")->ambient_light, 0.2);
  EXPECT_EQ(Good("[FLOOR]\nambient_light 0.2\n[SIMULATION]\nambient_light 0.3\n")->ambient_light, 0.3);
}

TEST(LightsTest, AWorldsLightsComeFirst) {
  const TempFolder folder;
  folder.Write("room.world", "[FLOOR]\nambient_light 0.1\ntexture grid\n[LIGHT_1]\nposition 0 0 1\n");
  const auto file = folder.Write("room.scenario", "[WORLD]\nfile room.world\n[LIGHT_2]\nposition 0 0 2\n");
  RobotLibrary library(SearchPath{});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario(file, library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  ASSERT_EQ(scenario->lights.size(), 2u);
  EXPECT_EQ(scenario->lights[1].p_WP.z(), 2);
  EXPECT_EQ(scenario->ambient_light, 0.1);
  EXPECT_NE(scenario->floor.texture.image, nullptr);
  const auto world = LoadScenario((folder.path() / "room.world").string(), library, diagnostics);
  ASSERT_NE(world, nullptr);
  EXPECT_EQ(world->lights.size(), 1u);
  EXPECT_EQ(world->ambient_light, 0.1);
}

TEST(LightsTest, PointLightsOfSdfWorlds) {
  const TempFolder folder;
  const auto file = folder.Write(
      "w.sdf",
      "<sdf version=\"1.6\"><world name=\"w\"><scene><ambient>0.3 0.3 0.3 1</ambient></scene><light "
      "name=\"a\" type=\"point\"><pose>1 2 3 0 0 0</pose><diffuse>1 0 0 1</diffuse>"
      "<attenuation><range>10</range><constant>0.5</constant><linear>0.5</linear><quadratic>1</quadratic></"
      "attenuation><cast_shadows>1</cast_shadows></light>"
      "<light name=\"sun\" type=\"directional\"/></world></sdf>");
  RobotLibrary library(SearchPath{});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario(file, library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  ASSERT_EQ(scenario->lights.size(), 1u);
  EXPECT_EQ(scenario->lights[0].p_WP, Vector3(1, 2, 3));
  EXPECT_EQ(scenario->lights[0].color, (Color{1, 0, 0}));
  EXPECT_DOUBLE_EQ(scenario->lights[0].power, 0.5);
  EXPECT_TRUE(scenario->lights[0].casts_shadows);
  EXPECT_DOUBLE_EQ(scenario->ambient_light, 0.3);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("warning: <light> in <world> is not used by coopdyn"));
}

// --- textures

/// A red and a blue pixel side by side.
std::string TwoPoints() {
  const std::vector<unsigned char> points = {255, 0, 0, 0, 0, 255};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 2;
  image.height = 1;
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  EXPECT_TRUE(png_image_write_to_memory(&image, nullptr, &size, 0, points.data(), 0, nullptr));
  std::string bytes(size, '\0');
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, points.data(), 0, nullptr));
  return bytes;
}

/// A scenario's file with a texture beside it, and the reader's result.
class TexturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("inside/wood.png", TwoPoints());
    folder_.Write("secret.png", TwoPoints());
  }
  ReadResult Load(const std::string& text) {
    const auto file = folder_.Write("inside/test.scenario", text);
    Diagnostics diagnostics;
    auto scenario = LoadScenario(file, library_, diagnostics);
    return {scenario, folder_.Strip(diagnostics.ToString())};
  }
  TempFolder folder_;
  RobotLibrary library_{SearchPath{}};
};

TEST_F(TexturesTest, PatternsNeedNoFile) {
  const auto scenario = Good(
      "[FLOOR]\ntexture checker\ncolor 1 1 1\n[BOX]\ntype box\nsize 1 1 1\nposition 0 0\ntexture "
      "grid\ntexture_size 20cm 10cm\n");
  const Texture& floor = scenario->floor.texture;
  ASSERT_NE(floor.image, nullptr);
  EXPECT_EQ(floor.width_m, 1);
  EXPECT_EQ(floor.height_m, 1);
  EXPECT_EQ(floor.image->rgb.front(), 255);
  EXPECT_LT(floor.image->rgb[static_cast<std::size_t>(3 * floor.image->width / 2)], 200);
  EXPECT_EQ(scenario->objects[0].texture.width_m, 0.2);
  EXPECT_EQ(scenario->objects[0].texture.height_m, 0.1);
}

TEST_F(TexturesTest, AFileKeepsItsForm) {
  const ReadResult result = Load("[FLOOR]\ntexture wood.png\ntexture_size 2\n");
  ASSERT_NE(result.scenario, nullptr) << result.messages;
  const Texture& texture = result.scenario->floor.texture;
  ASSERT_NE(texture.image, nullptr);
  EXPECT_EQ(texture.width_m, 2);
  EXPECT_DOUBLE_EQ(texture.height_m, 2.0 * texture.image->height / texture.image->width);
}

TEST_F(TexturesTest, ARecordingCarriesIt) {
  const ReadResult result =
      Load("[FLOOR]\ntexture wood.png\n[BOX]\ntype box\nsize 1 1 1\nposition 0 0\ntexture wood.png\n");
  ASSERT_NE(result.scenario, nullptr) << result.messages;
  ASSERT_EQ(result.scenario->sources.size(), 1u);
  EXPECT_EQ(result.scenario->sources[0].kind, "texture");
  RobotLibrary recorded(SearchPath{}, result.scenario->sources);
  Diagnostics diagnostics;
  const auto again = ReadScenario(result.scenario->text, "gone.scenario", recorded, false, diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->floor.texture.image->rgb, result.scenario->floor.texture.image->rgb);
  EXPECT_EQ(again->sources.size(), 1u);
}

TEST_F(TexturesTest, WhatIsNotThereOrLiesOutsideIsRefused) {
  EXPECT_THAT(Load("[FLOOR]\ntexture wod.png\n").messages,
              HasSubstr("test.scenario:2: error: the texture 'wod.png' cannot be read: there is no 'wod.png' "
                        "in the scenario's folder or on the search path"));
  EXPECT_THAT(Load("[FLOOR]\ntexture ../secret.png\n").messages,
              HasSubstr("lies outside the scenario's folder and the search path"));
  EXPECT_THAT(Load("[FLOOR]\ntexture test.scenario\n").messages,
              HasSubstr("test.scenario:2: error: the texture 'test.scenario' cannot be read"));
  EXPECT_THAT(Load("[FLOOR]\ntexture_size 2\n").messages, HasSubstr("is that of a 'texture'"));
}

TEST_F(TexturesTest, OverASocketOnlyBareNamesWillDo) {
  Diagnostics diagnostics;
  EXPECT_EQ(ReadScenario("[FLOOR]\ntexture inside/wood.png\n", "", library_, true, diagnostics), nullptr);
  EXPECT_THAT(diagnostics.ToString(),
              HasSubstr("names a texture by the bare name of a file on the search path"));
}

}  // namespace
}  // namespace coopdyn
