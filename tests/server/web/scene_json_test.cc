// SPDX-License-Identifier: MIT
#include "server/web/scene_json.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <memory>
#include <string>

namespace coopdyn {
namespace {

Texture TextureOf(std::string name, std::uint8_t grey) {
  Texture texture;
  texture.name = std::move(name);
  texture.image = std::make_shared<const Image>(Image{1, 1, {grey, grey, grey}});
  return texture;
}

TEST(SceneJsonTest, PicturesOfTheSameNameAreFoundByNamesOfTheirOwn) {
  auto scenario = std::make_shared<Scenario>();
  scenario->floor.texture = TextureOf("checker", 1);
  for (const std::uint8_t grey : {2, 1, 2}) {
    WorldObject box;
    box.shape = Box{{1, 1, 1}};
    box.texture = TextureOf("checker", grey);
    scenario->objects.push_back(box);
  }
  Frame frame;
  frame.scene = MakeScene(std::move(scenario));
  const auto json = boost::json::parse(SceneJson(frame, 1));
  const auto name = [&json](const std::string& of) {
    return std::string(json.at_pointer("/" + of + "/texture/name").as_string());
  };
  EXPECT_EQ(name("floor"), "checker");
  EXPECT_EQ(name("things/0"), "checker#2");
  EXPECT_EQ(name("things/1"), "checker");
  EXPECT_EQ(name("things/2"), "checker#2");
  EXPECT_EQ(FindTextureImage(*frame.scene, "checker")->rgb[0], 1);
  EXPECT_EQ(FindTextureImage(*frame.scene, "checker#2")->rgb[0], 2);
  EXPECT_EQ(FindTextureImage(*frame.scene, "checker#3"), nullptr);
}

}  // namespace
}  // namespace coopdyn
