// SPDX-License-Identifier: MIT
#include "server/web/page_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

PageCall ReadCall(std::string_view json) {
  const PageRead read = ReadPageMessage(json);
  EXPECT_EQ(read.error, "");
  return read.message ? std::get<PageCall>(*read.message) : PageCall{};
}

TEST(PageCall, HasTheFiveFieldsOfAMessage) {
  const PageCall call = ReadCall(
      R"({"id":7,"module":"/robot1/motors","command":"set_velocity","params":[10],"data":[0.2,-1e-3],"text":"x"})");
  EXPECT_EQ(call.id, 7);
  EXPECT_EQ(call.module, "/robot1/motors");
  EXPECT_EQ(call.command_name, "set_velocity");
  EXPECT_THAT(call.message.params, ElementsAre(10));
  EXPECT_THAT(call.message.data, ElementsAre(0.2, -1e-3));
  EXPECT_EQ(call.message.text, "x");
  EXPECT_FALSE(call.line);
}

TEST(PageCall, TakesTheNumberOfACommand) {
  const PageCall call = ReadCall(R"({"id":"a","module":"robot1/pose","command":40})");
  EXPECT_EQ(call.id, "a");
  EXPECT_EQ(call.module, "/robot1/pose");
  EXPECT_EQ(call.message.command, 40);
}

TEST(PageCall, TakesNumbersThatAreNotFiniteAsStrings) {
  const PageCall call = ReadCall(R"({"module":"/m","command":0,"data":["inf","-inf","nan"]})");
  ASSERT_EQ(call.message.data.size(), 3U);
  EXPECT_EQ(call.message.data[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(call.message.data[1], -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(call.message.data[2]));
}

TEST(PageCall, TakesALine) {
  const PageCall call = ReadCall(R"({"id":1,"module":"/robot1/motors","line":"set_velocity 0.2 0"})");
  EXPECT_EQ(call.line, "set_velocity 0.2 0");
}

struct BadCase {
  const char* json;
  const char* complaint;
};

TEST(PageMessage, SaysWhatIsWrong) {
  const std::vector<BadCase> cases = {
      {"", "not a JSON object"},
      {"[]", "not a JSON object"},
      {"{\"id\":1", "not a JSON object"},
      {R"({"id":1,"command":"run"})", "which module"},
      {R"({"id":1,"module":"/m"})", "which command"},
      {R"({"id":1.5,"module":"/m","command":1})", "\"id\""},
      {R"({"id":1,"module":3,"command":1})", "\"module\" must be a string"},
      {R"({"id":1,"module":"/m","command":1.5})", "which command"},
      {R"({"id":1,"module":"/m","command":1,"params":[1.5]})", "whole numbers"},
      {R"({"id":1,"module":"/m","command":1,"params":[2147483648]})", "whole numbers"},
      {R"({"id":1,"module":"/m","command":1,"params":7})", "list of numbers"},
      {R"({"id":1,"module":"/m","command":1,"data":["seven"]})", "list of numbers"},
      {R"({"id":1,"module":"/m","command":1,"text":"a\u0000b"})", "UTF-8"},
      {R"({"id":1,"module":"/m","command":1,"line":"stop"})", "not both"},
      {R"({"id":1,"module":"/m","line":"stop\nstop"})", "one line"},
      {R"({"type":"dance"})", "unknown type"},
      {R"({"type":"view","width":640})", "pixels"},
      {R"({"type":"view","width":640,"height":480,"eye":[1,2]})", "three numbers"},
      {R"({"type":"view","width":640,"height":99999})", "pixels"},
  };
  for (const BadCase& bad : cases) {
    const PageRead read = ReadPageMessage(bad.json);
    EXPECT_FALSE(read.message) << bad.json;
    EXPECT_THAT(read.error, HasSubstr(bad.complaint)) << bad.json;
  }
}

TEST(PageMessage, DeepNestingIsRefused) {
  EXPECT_FALSE(ReadPageMessage(R"({"data":)" + std::string(100000, '[')).message);
}

TEST(PageMessage, ABadCallIsAnsweredWithItsId) {
  EXPECT_EQ(ReadPageMessage(R"({"id":12,"module":"/m"})").id, 12);
}

TEST(PageView, SaysWhereTheCameraStands) {
  const PageRead read = ReadPageMessage(
      R"({"type":"view","width":320,"height":240,"eye":[1,2,3],"look":[0,0,0.5],"rays":true})");
  ASSERT_TRUE(read.message);
  const ImageRequest request = std::get<PageView>(*read.message).request.value();
  EXPECT_EQ(request.width, 320);
  EXPECT_EQ(request.eye_m, Vector3(1, 2, 3));
  EXPECT_EQ(request.look_m, Vector3(0, 0, 0.5));
  EXPECT_TRUE(request.show_rays);
  EXPECT_EQ(request.format, ImageFormat::kJpeg);
}

TEST(PageView, WithoutWidthEndsThePictures) {
  const PageRead read = ReadPageMessage(R"({"type":"view"})");
  ASSERT_TRUE(read.message);
  EXPECT_FALSE(std::get<PageView>(*read.message).request);
}

TEST(PageReply, IsJsonWhateverItHolds) {
  PageReply reply;
  reply.id = 3;
  reply.module = "/<b>";
  reply.message = {.error = 0, .text = "\"</script>", .command = 20, .params = {1, -2}, .data = {0.1, 1e300}};
  reply.message.data.push_back(std::numeric_limits<double>::infinity());
  reply.message.data.push_back(std::numeric_limits<double>::quiet_NaN());
  const std::string json = WritePageReply(reply);
  EXPECT_THAT(json, HasSubstr(R"("id":3,)"));
  EXPECT_THAT(json, HasSubstr(R"("params":[1,-2],"data":[0.1,1e+300,"inf","nan"])"));
  EXPECT_THAT(json, testing::Not(HasSubstr("<")));
}

TEST(PageReply, APushHasNoId) {
  PageReply push;
  push.module = "/m";
  EXPECT_THAT(WritePageReply(push), testing::StartsWith(R"({"push":true,"module":"/m")"));
}

TEST(PageSensors, HaveARate) {
  const PageRead read = ReadPageMessage(R"({"type":"sensors","rate":15})");
  ASSERT_TRUE(read.message);
  EXPECT_EQ(std::get<PageSensors>(*read.message).rate_hz, 15);
  EXPECT_THAT(ReadPageMessage(R"({"type":"sensors"})").error, HasSubstr(R"({"type":"sensors","rate":30})"));
}

}  // namespace
}  // namespace coopdyn
