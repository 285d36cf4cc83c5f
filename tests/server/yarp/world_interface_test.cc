// SPDX-License-Identifier: MIT
#include "server/yarp/world_interface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

using std::numbers::pi;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

auto Near(std::vector<double> values) {
  return Pointwise(DoubleNear(1e-12), std::move(values));
}

// Crate and robot look along y.
constexpr const char* kWorld = R"({"scenario": "s", "undo": 0, "redo": 0, "floor": {},
  "things": [{"id": 1, "name": "WALL_1", "type": "box", "size": [4, 0.2, 1], "position": [0, 3, 0.5],
              "quaternion": [1, 0, 0, 0], "mass": 0},
             {"id": 2, "name": "crate", "type": "box", "size": [0.1, 0.2, 0.5], "position": [1, 2, 0.25],
              "quaternion": [0.7071067811865476, 0, 0, 0.7071067811865476], "mass": 2.5},
             {"id": 3, "name": "pillar", "type": "cylinder", "size": [0.2, 0.2, 1], "position": [1, 0, 0.5],
              "quaternion": [1, 0, 0, 0], "mass": 0},
             {"id": 4, "name": "lost", "type": "sphere", "size": [0.2], "position": [null, 0, 0],
              "quaternion": [1, 0, 0, 0], "mass": 1}],
  "robots": [{"id": 1000001, "name": "robot1", "type": "coopbot", "position": [5, 0, 0],
              "quaternion": [0.7071067811865476, 0, 0, 0.7071067811865476]}],
  "targets": [{"id": 2000001, "name": "red_target_1", "color_name": "red", "position": [3, 4, 0]}],
  "lights": []})";

class WorldInterfaceTest : public ::testing::Test {
 protected:
  Decoded Decode(const std::string& text) { return world_->Decode(*ParseBottle(text)); }
  /// The module's first request.
  Message First(const std::string& text) {
    const Decoded decoded = Decode(text);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << text << ": " << decoded.message.text;
    return decoded.message;
  }
  /// The next request, after the reply with the world's objects.
  std::optional<Message> Second(const std::string& text) {
    EXPECT_EQ(First(text).command, command::kListWorld) << text;
    return world_->Next(Standing());
  }
  YarpAnswer AnswerTo(const Message& reply) {
    EXPECT_EQ(world_->Next(reply), std::nullopt);
    return world_->Reply(reply);
  }
  std::string TextOf(const Message& reply) { return BottleText(AnswerTo(reply).bottle); }
  /// The reply to a request that needs only the world's objects.
  YarpAnswer Told(const std::string& text) {
    EXPECT_EQ(Second(text), std::nullopt) << text;
    return world_->Reply(Standing());
  }
  std::string Refused(const std::string& text) {
    const Decoded decoded = Decode(text);
    EXPECT_EQ(decoded.status, DecodeStatus::kBad) << text;
    return BottleText(world_->Reply(decoded.message).bottle);
  }
  static Message Standing() { return ReplyTo(command::kListWorld, kWorld); }
  static Message Edited(std::vector<std::int32_t> ids, std::string names) {
    Message reply = ReplyTo(command::kInsert, std::move(names));
    reply.params = std::move(ids);
    return reply;
  }
  static Message Overlap() {
    return ErrorReply(command::kInsert, Error::kNotPossible, "box_1 would stand in WALL_1");
  }
  void Make(std::int32_t id, const std::string& name) {
    First("makeSphere 0.1 0 0 1 0 0 0 0 0 0");
    AnswerTo(Edited({id}, name));
  }
  static std::vector<double> Numbers(const Bottle& bottle) {
    std::vector<double> numbers;
    for (const BottleValue& value : bottle) numbers.push_back(NumberOf(value).value_or(-1));
    return numbers;
  }

  const std::shared_ptr<YarpMadeThings> made_ = std::make_shared<YarpMadeThings>();
  const std::unique_ptr<YarpTranslator> world_ = MakeWorldTranslator(made_);
};

TEST_F(WorldInterfaceTest, ABoxIsASectionOfAScenario) {
  const Message insert = First("makeBox 0.1 0.2 0.3 1.0 0.0 0.5 0 0 0 255 0 51");
  EXPECT_EQ(insert.command, command::kInsert);
  EXPECT_EQ(insert.text,
            "[box_*]\ntype box\nsize 0.1 0.2 0.3\nposition 1.0 0.0 0.5\nquaternion 1.0 0.0 0.0 0.0\n"
            "color 1.0 0.0 0.2\n");
  EXPECT_EQ(TextOf(Edited({7}, "box_1")), "box_1");
}

TEST_F(WorldInterfaceTest, RadiiBecomeDiameters) {
  EXPECT_THAT(First("makeSphere 0.1 0 0 1 0 0 0 0 0 0").text,
              HasSubstr("[sphere_*]\ntype sphere\nsize 0.2\n"));
  EXPECT_THAT(First("makeCylinder 0.1 0.5 0 0 1 0 0 0 0 0 0").text,
              HasSubstr("[cylinder_*]\ntype cylinder\nsize 0.2 0.2 0.5\n"));
}

TEST_F(WorldInterfaceTest, AThingWithGravityWeighsWhatWoodDoes) {
  const std::string box = "makeBox 0.5 0.5 0.5 0 0 1 0 0 0 0 0 0 ";
  EXPECT_THAT(First(box + "\"\" crate 1").text, HasSubstr("[crate]"));
  EXPECT_THAT(First(box + "\"\" crate 1").text, HasSubstr("\nmass 62.5\n"));
  EXPECT_THAT(First(box + "\"\" crate true").text, HasSubstr("\nmass 62.5\n"));
  for (const char* const off : {"\"\" crate", "\"\" crate 0 1", "\"\" crate fail ok", ""}) {
    EXPECT_THAT(First(box + off).text, Not(HasSubstr("mass"))) << off;
  }
  EXPECT_THAT(First("makeSphere 0.0001 0 0 1 0 0 0 0 0 0 \"\" \"\" 1").text, HasSubstr("\nmass 1e-06\n"));
}

TEST_F(WorldInterfaceTest, AProgramsRequestIsRead) {
  // As written by code that yarpidl_thrift 3.12 has generated.
  const std::string bytes =
      Hex("00010000 11000000 04000000 07000000 'makeBox'"
          "0a000000 9a9999999999b93f 0a000000 9a9999999999c93f 0a000000 333333333333d33f"
          "0a000000 000000000000f03f 0a000000 0000000000000040 0a000000 000000000000e03f"
          "0a000000 0000000000000000 0a000000 0000000000000000 0a000000 0000000000000000"
          "40000000 ff00 40000000 0000 40000000 ff00 04000000 00000000 04000000 05000000 'crate'"
          "09000000 'fail' 09000000 'ok__'");
  YarpDialect dialect = YarpDialect::k3;
  const Decoded decoded = world_->Decode(DecodeBottle(bytes, dialect).value());
  EXPECT_EQ(decoded.message.text,
            "[crate]\ntype box\nsize 0.1 0.2 0.3\nposition 1.0 2.0 0.5\nquaternion 1.0 0.0 0.0 0.0\n"
            "color 1.0 0.0 1.0\n");
}

TEST_F(WorldInterfaceTest, StructsMayBeLists) {
  EXPECT_EQ(First("setPose crate (1 2 0.5 0 0 0) \"\"").data, (std::vector<double>{1, 2, 0.5, 1, 0, 0, 0}));
  EXPECT_EQ(First("changeColor crate (255 0 51)").text, "crate color 1.0 0.0 0.2\n");
}

TEST_F(WorldInterfaceTest, AnglesTurnAboutTheFixedAxesOfTheWorld) {
  const std::vector<double> roll_then_yaw = First(
                                                "setPose crate 1 2 0.5 1.5707963267948966 0 "
                                                "1.5707963267948966")
                                                .data;
  EXPECT_THAT(roll_then_yaw, Near({1, 2, 0.5, 0.5, 0.5, 0.5, 0.5}));
}

TEST_F(WorldInterfaceTest, AThingIsMovedByItsName) {
  const Message move = First("setPose crate 1 2 0.5 0 0 0");
  EXPECT_EQ(move.command, command::kSetPose);
  EXPECT_EQ(move.text, "crate");
  EXPECT_EQ(TextOf(Edited({2}, "crate")), "[ok]");
}

TEST_F(WorldInterfaceTest, APoseIsToldInTheWorld) {
  EXPECT_THAT(Numbers(Told("getPose Crate").bottle), Near({1, 2, 0.25, 0, 0, pi / 2}));
  EXPECT_THAT(Numbers(Told("getPose red_target_1").bottle), Near({3, 4, 0, 0, 0, 0}));
}

TEST_F(WorldInterfaceTest, AFrameIsAThingOrARobot) {
  EXPECT_THAT(Numbers(Told("getPose crate robot1").bottle), Near({2, 4, 0.25, 0, 0, 0}));
  EXPECT_THAT(Second("setPose WALL_1 1 0 0 0 0 0 crate::link")->data,
              Near({1, 3, 0.25, std::sqrt(0.5), 0, 0, std::sqrt(0.5)}));
  EXPECT_THAT(Second("makeSphere 0.1 0 1 0.5 0 0 0 0 0 0 robot1")->text, HasSubstr("\nposition 4.0 "));
  EXPECT_EQ(First("getPose crate world").command, command::kListWorld);
}

TEST_F(WorldInterfaceTest, LinksOfRobotsAndUnknownNamesAreNoFrames) {
  EXPECT_THAT(BottleText(Told("getPose crate robot1::chassis").bottle), HasSubstr("robot1 is the frame"));
  EXPECT_THAT(BottleText(Told("setPose crate 1 0 0 0 0 0 moon").bottle), HasSubstr("no frame moon"));
}

TEST_F(WorldInterfaceTest, AStraightPitchIsToldWithoutYaw) {
  for (const bool up : {false, true}) {
    const std::string pitch = up ? "-1.5707963267948966" : "1.5707963267948966";
    const std::vector<double> q = First("setPose a 0 0 0 0.3 " + pitch + " 0.5").data;
    std::string list = R"({"things": [{"id": 1, "name": "a", "position": [0, 0, 0], "quaternion": [)";
    for (std::size_t i = 3; i < q.size(); ++i) AppendDouble(q[i], list += i == 3 ? "" : ", ");
    First("getPose a");
    EXPECT_EQ(world_->Next(ReplyTo(command::kListWorld, list + "]}]}")), std::nullopt);
    const std::vector<double> pose = Numbers(world_->Reply(Standing()).bottle);
    EXPECT_THAT(pose, Near({0, 0, 0, up ? 0.8 : -0.2, up ? -pi / 2 : pi / 2, 0}));
  }
}

TEST_F(WorldInterfaceTest, GravityIsMass) {
  EXPECT_EQ(Second("enableGravity crate 0")->text, "crate mass 0.0\n");
  EXPECT_THAT(Second("enableGravity pillar 1")->text, HasSubstr("pillar mass 15.70796326"));
  EXPECT_EQ(TextOf(Edited({3}, "pillar")), "[ok]");
}

TEST_F(WorldInterfaceTest, GravityThatIsThereAlreadyChangesNothing) {
  EXPECT_EQ(BottleText(Told("enableGravity crate 1").bottle), "[ok]");
  EXPECT_EQ(BottleText(Told("enableGravity WALL_1 0").bottle), "[ok]");
  EXPECT_EQ(BottleText(Told("enableGravity robot1 ok").bottle), "[ok]");
  EXPECT_THAT(BottleText(Told("enableGravity robot1 0").bottle), HasSubstr("of things only"));
}

TEST_F(WorldInterfaceTest, ThingsAlwaysTouchEachOther) {
  EXPECT_EQ(BottleText(Told("enableCollision crate 1").bottle), "[ok]");
  EXPECT_THAT(Refused("enableCollision crate 0"), HasSubstr("always touch"));
  EXPECT_THAT(Refused("makeSphere 0.1 0 0 1 0 0 0 0 0 0 \"\" \"\" 0 0"), HasSubstr("always touch"));
}

TEST_F(WorldInterfaceTest, AModelIsARobotThatLockstepDoesNotWaitFor) {
  EXPECT_EQ(First("loadModelFromFile coopbot").text, "[ROBOT_*]\ntype coopbot\nposition 0 0\nsync no\n");
  EXPECT_EQ(First("loadModelFromFileWithPose model://coopbot/model.sdf 1 2 0 0 0 0 ana 2.0").text,
            "[ROBOT_*]\ntype coopbot\nname ana\nposition 1.0 2.0 0.0\nquaternion 1.0 0.0 0.0 0.0\nsync no\n");
  EXPECT_EQ(TextOf(Edited({1000002}, "ana\nmodel.sdf:3: warning: \"one\"")), "ana");
}

TEST_F(WorldInterfaceTest, AModelIsNoPath) {
  for (const char* const path :
       {"/tmp/model.sdf", "../model.sdf", ".hidden", "\"a b\"", "\"\"", "\"a\\n[x]\""}) {
    EXPECT_THAT(Refused(std::string("loadModelFromFile ") + path), HasSubstr("loadModelFromFile coopbot"));
  }
}

TEST_F(WorldInterfaceTest, RemoveAndRenameAreThoseOfTheModule) {
  EXPECT_EQ(First("deleteObject crate").command, command::kRemove);
  EXPECT_EQ(First("deleteObject crate").text, "crate");
  EXPECT_EQ(First("rename crate box").command, command::kRename);
  EXPECT_EQ(First("rename crate box").text, "crate box");
}

TEST_F(WorldInterfaceTest, TheListHasWhatTheCallsHaveMade) {
  EXPECT_EQ(BottleText(Told("getList").bottle), "()");
  Make(2, "crate");
  Make(4, "lost");
  Make(9, "gone since");
  EXPECT_EQ(BottleText(Told("getList").bottle), "(crate lost)");
}

TEST_F(WorldInterfaceTest, TheListIsThatOfAllConnections) {
  Make(2, "crate");
  const std::unique_ptr<YarpTranslator> other = MakeWorldTranslator(made_);
  other->Decode(*ParseBottle("getList"));
  other->Next(Standing());
  EXPECT_EQ(BottleText(other->Reply(Standing()).bottle), "(crate)");
}

TEST_F(WorldInterfaceTest, AThingOfAnotherScenarioWithTheSameIdWasNotMade) {
  Make(1, "crate");
  EXPECT_EQ(BottleText(Told("getList").bottle), "()");
}

TEST_F(WorldInterfaceTest, ANewNameIsKept) {
  Make(2, "box_1");
  First("rename box_1 crate");
  EXPECT_EQ(TextOf(Edited({2}, "crate")), "[ok]");
  EXPECT_EQ(BottleText(Told("getList").bottle), "(crate)");
}

TEST_F(WorldInterfaceTest, DeleteAllLeavesWhatTheCallsHaveNotMade) {
  Make(2, "crate");
  Make(3, "pillar");
  const std::optional<Message> remove = Second("deleteAll");
  ASSERT_TRUE(remove);
  EXPECT_EQ(remove->command, command::kRemove);
  EXPECT_THAT(remove->params, ElementsAre(2, 3));
  EXPECT_EQ(TextOf(Edited({2, 3}, "")), "[ok]");
  EXPECT_EQ(BottleText(Told("deleteAll").bottle), "[ok]");
}

TEST_F(WorldInterfaceTest, WhatIsNotInTheWorldCannotBe) {
  EXPECT_THAT(Refused("makeFrame 0.1 0 0 1 0 0 0 0 0 0"), HasSubstr("frame without a body"));
  EXPECT_THAT(Refused("attach crate robot1::hand"), HasSubstr("glued"));
  EXPECT_THAT(Refused("detach crate"), HasSubstr("glued"));
}

TEST_F(WorldInterfaceTest, APersonIsToldWhatToWrite) {
  EXPECT_THAT(Refused("makeBox 0.1 0.1 0.1"),
              HasSubstr("write makeBox WIDTH HEIGHT THICKNESS X Y Z ROLL PITCH YAW RED GREEN BLUE [FRAME]"));
  EXPECT_THAT(Refused("setPose crate 1 2"), HasSubstr("write setPose ID X Y Z ROLL PITCH YAW [FRAME]"));
  EXPECT_THAT(Refused("setPose 1 2 3 4 5 6 7"), HasSubstr("write setPose"));
  EXPECT_THAT(Refused("enableGravity crate maybe"), HasSubstr("write enableGravity ID ON"));
  EXPECT_THAT(Refused("getList of things"), HasSubstr("write getList"));
  EXPECT_THAT(Refused("makeSphere 0.1 0 0 nan 0 0 0 0 0 0"), HasSubstr("write makeSphere"));
  EXPECT_THAT(Refused("explode"), HasSubstr("no such call"));
  EXPECT_THAT(Refused(""), HasSubstr("no such call"));
}

TEST_F(WorldInterfaceTest, NamesCannotBreakOutOfTheirLine) {
  const std::string sphere = "makeSphere 0.1 0 0 1 0 0 0 0 0 0 \"\" ";
  for (const char* const name : {"\"a]\\n[b\"", "\"a b\"", "\"a|b\"", "grün"}) {
    EXPECT_THAT(Refused(sphere + name), HasSubstr("letters, digits")) << name;
  }
  EXPECT_THAT(Refused("deleteObject \"\""), HasSubstr("letters, digits"));
  EXPECT_THAT(Refused("changeColor \"a mass 1\" 0 0 0"), HasSubstr("letters, digits"));
}

TEST_F(WorldInterfaceTest, ANameIsNotThatOfAnotherKindOfSection) {
  const std::string sphere = "makeSphere 0.1 0 0 1 0 0 0 0 0 0 \"\" ";
  for (const char* const name : {"Target", "floor", "ROBOT_1", "light_left"}) {
    EXPECT_THAT(Refused(sphere + name), HasSubstr("another kind")) << name;
  }
  EXPECT_THAT(First(sphere + "target_1").text, HasSubstr("[target_1]"));
}

TEST_F(WorldInterfaceTest, ColoursAreBytes) {
  EXPECT_THAT(Refused("changeColor crate 256 0 0"), HasSubstr("0 to 255"));
  EXPECT_THAT(Refused("changeColor crate 0 -1 0"), HasSubstr("0 to 255"));
}

TEST_F(WorldInterfaceTest, APersonHearsWhyTheModuleRefuses) {
  First("makeBox 1 1 1 0 3 0.5 0 0 0 255 0 0");
  const YarpAnswer answer = AnswerTo(Overlap());
  EXPECT_EQ(BottleText(answer.bottle), "[fail] \"box_1 would stand in WALL_1\"");
  EXPECT_EQ(answer.bytes, "");
}

TEST_F(WorldInterfaceTest, AProgramGetsAnEmptyNameInstead) {
  First("makeBox 1 1 1 0 3 0.5 0 0 0 255 0 0 \"\" \"\" [fail] [ok]");
  const YarpAnswer answer = AnswerTo(Overlap());
  EXPECT_EQ(answer.bytes, Hex("04010000 01000000 00000000"));
  EXPECT_EQ(BottleText(answer.bottle), "[fail] \"box_1 would stand in WALL_1\"");
}

TEST_F(WorldInterfaceTest, AProgramThatWaitsForABoolGetsNoMore) {
  First("deleteObject moon");
  const YarpAnswer answer = AnswerTo(ErrorReply(command::kRemove, Error::kNoSuchName, "there is no moon"));
  EXPECT_EQ(answer.bytes, Hex("09010000 01000000 'fail'"));
  EXPECT_EQ(BottleText(answer.bottle), "[fail] \"there is no moon\"");
}

TEST_F(WorldInterfaceTest, AProgramGetsAPoseOfZerosForWhatIsNotThere) {
  const YarpAnswer answer = Told("getPose moon \"\"");
  EXPECT_EQ(answer.bytes, Hex("01010000 06000000") + std::string(24, '\0'));
  EXPECT_EQ(BottleText(answer.bottle), "[fail] \"there is no moon in the world\"");
  EXPECT_EQ(Told("getPose moon").bytes, "");
}

TEST_F(WorldInterfaceTest, WhyTellsTheLastRefusal) {
  EXPECT_EQ(Refused("why"), "\"no call was refused\"");
  First("deleteObject moon");
  AnswerTo(ErrorReply(command::kRemove, Error::kNoSuchName, "there is no moon"));
  EXPECT_EQ(Refused("why"), "\"there is no moon\"");
}

TEST_F(WorldInterfaceTest, AWorldThatCannotBeReadIsAFailure) {
  First("getList");
  const Message refusal = ErrorReply(command::kListWorld, Error::kNotPossible, "not now");
  EXPECT_EQ(AnswerTo(refusal).bytes, Hex("00010000 01000000 00010000 00000000"));
  First("getPose crate");
  EXPECT_EQ(world_->Next(ReplyTo(command::kListWorld, "no JSON")), std::nullopt);
  EXPECT_THAT(BottleText(world_->Reply(Standing()).bottle), HasSubstr("no crate"));
}

TEST_F(WorldInterfaceTest, AFailedEditMakesNothing) {
  First("makeSphere 0.1 0 0 1 0 0 0 0 0 0");
  Message reply = Overlap();
  reply.params = {2};
  AnswerTo(reply);
  EXPECT_FALSE(made_->Has(2, "crate"));
}

TEST_F(WorldInterfaceTest, HelpListsTheCalls) {
  EXPECT_THAT(Refused("help"), HasSubstr("\"getPose ID [FRAME]\""));
  EXPECT_THAT(Refused("[help]"), HasSubstr("\"rename ID NEW_NAME\""));
}

TEST_F(WorldInterfaceTest, TheVersionOfTheProtocolIsThatOfAllPorts) {
  const Decoded decoded = Decode("getRemoteProtocolVersion");
  EXPECT_EQ(world_->Reply(decoded.message).bytes, YarpProtocolVersion().bytes);
}

TEST_F(WorldInterfaceTest, BytesThatAreNoBottleAreRefused) {
  const Message refusal = ErrorReply(command::kUnreadable, Error::kMalformed, "this is no Bottle of YARP");
  EXPECT_EQ(BottleText(world_->Reply(refusal).bottle), "[fail] \"this is no Bottle of YARP\"");
  First("deleteObject moon");
  EXPECT_EQ(world_->Reply(refusal).bytes, "");
}

TEST_F(WorldInterfaceTest, ACallThatIsNoneIsRefusedWhateverTheReason) {
  Decode("makeMoon");
  const Message refusal = ErrorReply(command::kUnreadable, Error::kNotPossible, "no");
  EXPECT_EQ(BottleText(world_->Reply(refusal).bottle), "[fail] no");
}

}  // namespace
}  // namespace coopdyn
