// SPDX-License-Identifier: MIT
// Contacts and motion of changed things, as encoded in a recording.
#include "server/state/change_codec.h"

#include <gtest/gtest.h>

#include "server/model/mesh_file.h"

namespace coopdyn {
namespace {

WorldChange OneBall() {
  WorldObject ball;
  ball.name = "BALL_1";
  ball.shape = Sphere{0.1};
  ball.mass_kg = 1;
  WorldChange change;
  change.objects.push_back({ObjectId{3}, ball, Placing::kStart});
  return change;
}

int VersionOf(const std::string& text) {
  return static_cast<unsigned char>(FromBase64(text).value().front());
}

TEST(ChangeCodecTest, AChangeKeepsHowThingsTouchAndMove) {
  WorldChange change = OneBall();
  WorldObject& ball = change.objects[0].object;
  ball.restitution = 0.75;
  ball.rolling_friction_m = 1.0 / 3;
  ball.v_WO = {1, 2, 1.0 / 3};
  ball.w_WO = {0, 0, 7};
  const std::string text = EncodeChange(change);
  EXPECT_EQ(VersionOf(text), 4);
  const auto read = DecodeChange(text, {});
  ASSERT_TRUE(read);
  const WorldObject& again = read->objects.at(0).object;
  EXPECT_TRUE(again.IsAlike(ball));
  EXPECT_EQ(again.v_WO, ball.v_WO);
  EXPECT_EQ(again.w_WO, ball.w_WO);
  EXPECT_EQ(EncodeChange(*read), text);
}

TEST(ChangeCodecTest, AChangeOfThingsThatOnlyStandIsWrittenAsItAlwaysWas) {
  const std::string text = EncodeChange(OneBall());
  EXPECT_EQ(VersionOf(text), 1);
  ASSERT_TRUE(DecodeChange(text, {}));
  EXPECT_EQ(DecodeChange(text, {})->objects.at(0).object.restitution, 0);
}

}  // namespace
}  // namespace coopdyn
