// SPDX-License-Identifier: MIT
// Requests to sensors as sent by the network clients of YARP 3.12 and 4.0, the resulting requests to the
// module, and the reply bytes.
#include "server/yarp/device_rpc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/yarp/device_rpc_fixture.h"

namespace coopdyn::device_rpc {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Four columns from -90 degrees on, 45 apart, and ranges from 0.1 to 5 m.
class LidarRpcTest : public DeviceRpcTest {
 protected:
  LidarRpcTest()
      : DeviceRpcTest(
            YarpTalk::kLidar, "/robot1/lidar/rpc:i", LidarTable(),
            ReplyWith(command::kGetScanGeometry, {-kHalfTurn / 2, kHalfTurn / 4, 0.1, 5, 1, 4, 0, 0})) {}
};

TEST_F(LidarRpcTest, AsksTheModuleForItsGeometryAndTellsItNothing) {
  Ask("getScanLimits_RPC");
  EXPECT_EQ(asked_, [] {
    Message ask;
    ask.command = command::kGetScanGeometry;
    return ask;
  }());
  EXPECT_TRUE(told_.empty());
}

TEST_F(LidarRpcTest, AnswersAsYarp3) {
  EXPECT_EQ(Bytes("getDistanceRange_RPC"),
            Hex("00010000 03000000 01000000 00000000 0a000000 9a999999 9999b93f 0a000000 00000000 00001440"));
  EXPECT_EQ(Bytes("getDeviceStatus_RPC"), Hex("00010000 02000000 01000000 00000000 09000000 01000000"));
  EXPECT_EQ(Bytes("getScanLimits_RPC"),
            Hex("00010000 03000000 01000000 00000000 0a000000 00000000008056c0 0a000000 0000000000805640"));
  EXPECT_EQ(Bytes("getHorizontalResolution_RPC"),
            Hex("00010000 02000000 01000000 00000000 0a000000 0000000000804640"));
  EXPECT_EQ(Bytes("getDeviceInfo_RPC"),
            Hex("00010000 02000000 01000000 00000000 04000000 12000000 'a lidar of coopdyn'"));
}

TEST_F(LidarRpcTest, AnswersAsYarp4) {
  device_->set_dialect(YarpDialect::k4);
  EXPECT_EQ(Bytes("getDistanceRange_RPC"), Hex("00010000 03000000 00010000 01000000 09000000 6f6b0000"
                                               "14000000 9a99999999 99b93f 14000000 0000000000001440"));
  EXPECT_EQ(Bytes("getDeviceStatus_RPC"),
            Hex("00010000 02000000 00010000 01000000 09000000 6f6b0000 09000000 01000000"));
}

TEST_F(LidarRpcTest, AnswersAsYarp4AfterTheQuestionForItsVersion) {
  EXPECT_EQ(Bytes(kAskVersion), Hex("00010000 01000000 00000400 00000000"));
  EXPECT_EQ(Bytes("getHorizontalResolution_RPC"),
            Hex("00010000 02000000 00010000 01000000 09000000 6f6b0000 14000000 0000000000804640"));
}

TEST_F(LidarRpcTest, AnswersTheSameInWords) {
  for (const YarpDialect dialect : {YarpDialect::k3, YarpDialect::k4}) {
    device_->set_dialect(dialect);
    const std::string code = dialect == YarpDialect::k3 ? "0" : "([ok])";
    EXPECT_EQ(Text("getDistanceRange_RPC"), code + " 0.1 5.0");
    EXPECT_EQ(Text("getScanLimits_RPC"), code + " -90.0 90.0");
    EXPECT_EQ(Text("getDeviceInfo_RPC"), code + " \"a lidar of coopdyn\"");
  }
  EXPECT_EQ(Text("setScanRate_RPC 10.0"), "[err2]");
  device_->set_dialect(YarpDialect::k3);
  EXPECT_EQ(Text("setScanRate_RPC 10.0"), "2");
}

TEST_F(LidarRpcTest, TakesNamesAsThriftSplitsThem) {
  for (const std::string call : {"getDistanceRange", "getScanLimits", "getHorizontalResolution",
                                 "getScanRate", "getDeviceStatus", "getDeviceInfo"}) {
    const std::string whole = Bytes(call + "_RPC");
    EXPECT_THAT(whole, StartsWith(Hex("00010000"))) << call;
    EXPECT_EQ(Bytes(call + " [RPC]"), whole) << call;
    EXPECT_EQ(Bytes(call + " RPC"), whole) << call;
  }
  EXPECT_EQ(Bytes("setScanLimits [RPC] -10.0 10.0"), Hex("01000000 02000000"));
}

TEST_F(LidarRpcTest, RefusesInTheShapeOfTheAnswer) {
  EXPECT_EQ(Bytes("setScanRate_RPC 10.0"), Hex("01000000 02000000"));
  EXPECT_EQ(Bytes("setDistanceRange_RPC 0.5 2.0"), Hex("01000000 02000000"));
  EXPECT_EQ(Bytes("getScanRate_RPC"), Hex("00010000 02000000 01000000 02000000 0a000000 0000000000000000"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(LidarRpcTest, RefusesInTheShapeOfTheAnswerOfYarp4) {
  device_->set_dialect(YarpDialect::k4);
  EXPECT_EQ(Bytes("setScanRate_RPC 10.0"), Hex("00010000 01000000 09000000 'err2'"));
  EXPECT_EQ(Bytes("getScanRate_RPC"),
            Hex("00010000 02000000 00010000 01000000 09000000 'err2' 14000000 0000000000000000"));
}

TEST_F(LidarRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request : {"", "bogus", "bogus_RPC", "getScanLimits", "get", "set", "5 _RPC",
                                    "(1 2)", "set a scan of all [RPC]"}) {
    ExpectNoSuchRequest(request);
    EXPECT_THAT(Text(request), HasSubstr("getScanLimits_RPC")) << request;
  }
}

TEST_F(LidarRpcTest, SaysWhyTheModuleRefuses) {
  reading_ = Refused(command::kGetScanGeometry);
  EXPECT_EQ(Text("getScanLimits_RPC"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_EQ(Text("bogus"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_EQ(Text(kAskVersion), "[fail] \"robot1 is driven by ana\"");
}

TEST_F(LidarRpcTest, FailsWithoutAGeometry) {
  reading_.data[5] = 0;
  EXPECT_THAT(Text("getScanLimits_RPC"), StartsWith("[fail]"));
  reading_.data.clear();
  EXPECT_THAT(Text("getScanLimits_RPC"), StartsWith("[fail]"));
}

/// 64 x 48 pixels with a field of view of 90 degrees across and 60 down.
class CameraRpcTest : public DeviceRpcTest {
 protected:
  CameraRpcTest()
      : DeviceRpcTest(
            YarpTalk::kCamera, "/robot1/camera/rpc", CameraTable(),
            ReplyWith(command::kGetCamera, {64, 48, 32, 24 * std::numbers::sqrt3, 31.5, 23.5, 0.1, 10, 25})) {
  }

  /// The two numbers at the end of a reply.
  std::pair<double, double> LastTwo(const std::string& request) {
    const Bottle answer = Ask(request).bottle;
    if (answer.size() < 2) return {};
    return {NumberOf(answer[answer.size() - 2]).value_or(0), NumberOf(answer.back()).value_or(0)};
  }
};

constexpr const char* kLens =
    "((physFocalLength 0.0) (focalLengthX 32.0) (focalLengthY 41.569219381653056) (principalPointX 31.5) "
    "(principalPointY 23.5) (k1 0.0) (k2 0.0) (k3 0.0) (t1 0.0) (t2 0.0) (distortionModel none) (stamp "
    "12.5))";

TEST_F(CameraRpcTest, AsksTheModuleForItsSizeAndTellsItNothing) {
  Ask("[visr] [get] [w]");
  EXPECT_EQ(asked_.command, command::kGetCamera);
  EXPECT_TRUE(told_.empty());
}

TEST_F(CameraRpcTest, AnswersAsYarp3) {
  EXPECT_EQ(Bytes("[visr] [get] [w]"),
            Hex("00010000 04000000 09000000 76697372 09000000 77000000 09000000 69730000 01000000 40000000"));
  EXPECT_EQ(Bytes("[fgi] [get] [h]"),
            Hex("00010000 04000000 09000000 66676900 09000000 68000000 09000000 69730000 01000000 30000000"));
}

TEST_F(CameraRpcTest, TellsItsSizeInWords) {
  EXPECT_EQ(Text("visr get w"), "[visr] [w] [is] 64");
  EXPECT_EQ(Text("[visr] [get] [h]"), "[visr] [h] [is] 48");
  EXPECT_EQ(Text("[visr] [get] [res]"), "[visr] [res] [is] 64 48");
  EXPECT_EQ(Text("[fgi] [get] [w]"), "[fgi] [w] [is] 64");
  EXPECT_EQ(Text("[visr] [get] [conf]"), "[visr] [conf] [is] 1 64 48 25.0 [rgb]");
  EXPECT_EQ(Text("[visr] [get] [mirr]"), "[visr] [mirr] [is] 0");
}

TEST_F(CameraRpcTest, TellsOfItsDistancesInWords) {
  EXPECT_EQ(Text("visd get w"), "[visd] [w] [is] 64");
  EXPECT_EQ(Text("[visd] [get] [h]"), "[visd] [h] [is] 48");
  EXPECT_EQ(Text("[visd] [get] [clip]"), "[visd] [clip] [is] 0.1 10.0");
  EXPECT_EQ(Text("[visd] [get] [acrc]"), "[visd] [acrc] [is] 0.0");
  EXPECT_EQ(Text("[visd] [get] [mirr]"), "[visd] [mirr] [is] 0");
  EXPECT_EQ(Text("[visd] [get] [intp]"), std::string("[visd] [intp] [is] ") + kLens);
  EXPECT_EQ(Text("[rgdb] [get] [prot]"), "[rgdb] [prot] [is] 1 0");
  EXPECT_EQ(Text("[rgdb] [get] [stat]"), "[rgdb] [stat] [is] 2");
  EXPECT_EQ(Text("[rgdb] [get] [mess]"), "[rgdb] [mess] [is] \"\"");
  EXPECT_EQ(Text("[rgdb] [get] [ext]"),
            "[rgdb] [ext] [is] 4 4 (1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0)");
  for (const char* const request : {"[visd] [get] [res]", "[visd] [set] [clip] 1.0 2.0",
                                    "[visr] [get] [clip]", "[rgdb] [get]", "[rgdb] [set] [ext] 1", "[rgdb]"})
    ExpectNoSuchRequest(request);
}

TEST_F(CameraRpcTest, TellsOfItsDistancesToYarp4) {
  const std::string ok = "00010000 01000000 09000000 6f6b0000";
  Ask(kAskVersion);
  EXPECT_EQ(Bytes("getDepthResolutionRPC"),
            Hex("00010000 03000000" + ok + "01000000 40000000 01000000 30000000"));
  EXPECT_EQ(Bytes("getSensorStatusRPC"), Hex("00010000 02000000" + ok + "01000000 02000000"));
  EXPECT_EQ(Bytes("getLastErrorMsgRPC"), Hex("00010000 03000000" + ok +
                                             "04000000 00000000 00010000 02000000 01000000 00000000 14000000 "
                                             "0000000000002940"));
  EXPECT_THAT(Bytes("getExtrinsicParamRPC"),
              StartsWith(Hex("00010000 02000000" + ok +
                             "00010000 03000000 01000000 04000000 01000000 04000000 "
                             "14010000 10000000 000000000000f03f 0000000000000000")));
  EXPECT_EQ(Text("getDepthClipPlanesRPC"), "([ok]) 0.1 10.0");
  EXPECT_EQ(Text("getDepthAccuracyRPC"), "([ok]) 0.0");
  EXPECT_EQ(Text("getDepthMirroringRPC"), "([ok]) [fail]");
  EXPECT_EQ(Text("getDepthIntrinsicParamRPC"), std::string("([ok]) ") + kLens);
  EXPECT_EQ(Text("setDepthClipPlanesRPC 1.0 2.0"), "[err2]");
  ExpectNoSuchRequest("getDepthRPC");
}

TEST_F(CameraRpcTest, TellsInDegreesWhatItSees) {
  EXPECT_THAT(Text("[visr] [get] [fov]"), StartsWith("[visr] [fov] [is] "));
  for (const char* const request :
       {"[visr] [get] [fov]", "[visd] [get] [fov]", "getRgbFOVRPC", "getDepthFOVRPC"}) {
    const auto [across_deg, down_deg] = LastTwo(request);
    EXPECT_NEAR(across_deg, 90, 1e-9) << request;
    EXPECT_NEAR(down_deg, 60, 1e-9) << request;
  }
}

TEST_F(CameraRpcTest, TellsOfItsLens) {
  EXPECT_EQ(Text("[visr] [get] [intp]"), std::string("[visr] [intp] [is] ") + kLens);
  Ask(kAskVersion);
  EXPECT_EQ(Text("getRgbIntrinsicParamRPC"), std::string("([ok]) ") + kLens);
}

TEST_F(CameraRpcTest, AnswersAsYarp4) {
  EXPECT_EQ(Bytes(kAskVersion), Hex("00010000 01000000 00000400 00000000"));
  const std::string ok = "00010000 01000000 09000000 6f6b0000 ";
  EXPECT_EQ(Bytes("getRgbWidthRPC"), Hex("00010000 02000000 " + ok + "01000000 40000000"));
  EXPECT_EQ(Bytes("getRgbHeightRPC"), Hex("00010000 02000000 " + ok + "01000000 30000000"));
  EXPECT_EQ(Bytes("getRgbResolutionRPC"),
            Hex("00010000 03000000 " + ok + "01000000 40000000 01000000 30000000"));
  EXPECT_EQ(Bytes("getRgbMirroringRPC"), Hex("00010000 02000000 " + ok + "09000000 'fail'"));
  EXPECT_THAT(Bytes("getRgbFOVRPC"), StartsWith(Hex("00010000 03000000 " + ok + "14000000")));
  EXPECT_EQ(Bytes("getRgbSupportedConfigurationsRPC"),
            Hex("00010000 02000000 " + ok +
                "00010000 01000000 00010000 04000000 01000000 40000000 01000000 30000000 "
                "14000000 00000000 00003940 01000000 'rgb_'"));
  EXPECT_EQ(Bytes("getWidthRPC"), Bytes("getRgbWidthRPC"));
  EXPECT_EQ(Bytes("getHeightRPC"), Bytes("getRgbHeightRPC"));
}

TEST_F(CameraRpcTest, RefusesToBeChanged) {
  EXPECT_EQ(Bytes("setRgbResolutionRPC 320 240"), Hex("01000000 02000000"));
  Ask(kAskVersion);
  EXPECT_EQ(Bytes("setRgbResolutionRPC 320 240"), Hex("00010000 01000000 09000000 'err2'"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(CameraRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request :
       {"", "bogus", "[visr]", "[visr] [get]", "[visr] [get] [bogus]", "[visr] [set] [w] 320",
        "[fgi] [get] [res]", "[fgi] [get] [fgi]", "[bogus] [get] [w]", "[visr] 1 [w]", "getBogusRPC"}) {
    ExpectNoSuchRequest(request);
    EXPECT_THAT(Text(request), HasSubstr("visr get w")) << request;
  }
}

TEST_F(CameraRpcTest, HasNoFeatureAndTellsNone) {
  EXPECT_EQ(Text("[fgc] [has] [feat] 0"), "[fgc] [has] [feat] 0 0");
  for (const char* const request : {"[fgc] [get] [feat] 0", "[fgc] [set] [feat] 0 0.5", "[fgc] [get] [camd]"})
    EXPECT_THAT(Text(request), StartsWith("[fail] \"this camera has no features")) << request;
  Ask("getRemoteProtocolVersion");  // YARP 4
  EXPECT_EQ(Text("hasFeatureRPC 0"), "([ok]) [fail]");
  EXPECT_EQ(Text("getFeature1RPC 0"), "([err2]) 0.0");
  EXPECT_EQ(Text("getFeature2RPC 0"), "([err2]) 0.0 0.0");
}

TEST_F(CameraRpcTest, FailsWithoutASize) {
  reading_.data.erase(reading_.data.begin(), reading_.data.begin() + 3);  // eight numbers
  EXPECT_THAT(Text("[visr] [get] [w]"), StartsWith("[fail]"));
  reading_ = ReplyTo(command::kGetCamera);
  EXPECT_THAT(Text("[visr] [get] [w]"), StartsWith("[fail]"));
  reading_ = Refused(command::kGetCamera);
  EXPECT_EQ(Text("[visr] [get] [w]"), "[fail] \"robot1 is driven by ana\"");
}

class MetadataRpcTest : public DeviceRpcTest {
 protected:
  MetadataRpcTest()
      : DeviceRpcTest(YarpTalk::kMetadata, "/robot1/left_foot/rpc:o", WrenchTable(),
                      ReplyTo(command::kPing)) {}
};

TEST_F(MetadataRpcTest, NamesItsSensorByTheModule) {
  EXPECT_EQ(Bytes("getMetadata"), MeasuresMetadata("wrench", "left_foot"));
  EXPECT_EQ(Text("getMetadata"), "() () () () () ((left_foot left_foot \"\")) () () () () () ()");
  EXPECT_EQ(asked_.command, command::kPing);
  EXPECT_TRUE(told_.empty());
}

TEST_F(MetadataRpcTest, IsTheSameForBothVersions) {
  const std::string three = Bytes("getMetadata");
  EXPECT_EQ(Bytes(kAskVersion), Hex("00010000 01000000 00000400 00000000"));
  EXPECT_EQ(Bytes("getMetadata"), three);
}

TEST_F(MetadataRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request : {"", "bogus", "getMetadata_RPC", "1 getMetadata"})
    ExpectNoSuchRequest(request);
}

TEST(MetadataRpc, EachKindOfModuleHasItsOwn) {
  for (const CommandTable& table : {ImuTable(), ContactTable(), JointsTable(), PoseTable()}) {
    const auto device = MakeDeviceTranslator(YarpTalk::kMetadata, "/robot1/mine/rpc:o", table);
    device->Decode(*ParseBottle("getMetadata"));
    EXPECT_EQ(device->Reply(ReplyTo(command::kPing)).bytes, MeasuresMetadata(table.module(), "mine"))
        << table.module();
  }
}

class AnalogRpcTest : public DeviceRpcTest {
 protected:
  AnalogRpcTest()
      : DeviceRpcTest(YarpTalk::kAnalog, "/robot1/wrench/analog:o/rpc:i", WrenchTable(),
                      ReplyTo(command::kPing)) {}
};

TEST_F(AnalogRpcTest, CalibratesWithoutAnyChange) {
  EXPECT_EQ(Bytes("[iana] [cal]"), Hex("01010000 01000000 00000000"));
  EXPECT_EQ(Text("[iana] [calc] 2"), "0");
  EXPECT_EQ(Text("iana calc 2 0.5"), "0");
  EXPECT_TRUE(told_.empty());
}

TEST_F(AnalogRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request : {"", "[iana]", "[iana] 1", "[iana] [bogus]", "[cal]", "[bogus] [cal]"})
    ExpectNoSuchRequest(request);
}

class BatteryRpcTest : public DeviceRpcTest {
 protected:
  BatteryRpcTest()
      : DeviceRpcTest(YarpTalk::kBattery, "/robot1/battery/rpc:i", BatteryTable(), ReplyTo(command::kPing)) {}
};

TEST_F(BatteryRpcTest, TellsWhatItIsInBothVersions) {
  EXPECT_EQ(Bytes("getBatteryInfoRPC"),
            Hex("00010000 02000000 01000000 00000000 04000000 14000000 'a battery of coopdyn'"));
  EXPECT_EQ(Bytes(kAskVersion), Hex("00010000 01000000 00000400 00000000"));
  EXPECT_EQ(Text("getBatteryInfoRPC"), "([ok]) \"a battery of coopdyn\"");
}

TEST_F(BatteryRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request : {"", "getBatteryInfo", "bogus_RPC", "(1)", "getBatteryChargeRPC"})
    ExpectNoSuchRequest(request);
}

class OdometryRpcTest : public DeviceRpcTest {
 protected:
  OdometryRpcTest()
      : DeviceRpcTest(YarpTalk::kOdometry, "/robot1/odometry/rpc", OdometryTable(), ReplyTo(command::kPing)) {
  }
};

TEST_F(OdometryRpcTest, RefusesToBeResetInBothVersions) {
  EXPECT_EQ(Bytes("reset_odometry_RPC"), Hex("01000000 02000000"));
  device_->set_dialect(YarpDialect::k4);
  EXPECT_EQ(Bytes("reset_odometry_RPC"), Hex("00010000 01000000 09000000 'err2'"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(OdometryRpcTest, TakesTheNameAsThriftSplitsIt) {
  EXPECT_EQ(Bytes("reset odometry [RPC]"), Hex("01000000 02000000"));
}

TEST_F(OdometryRpcTest, OtherRequestsAreToldWhichThereAre) {
  for (const char* const request : {"", "reset", "reset_odometry", "reset odometry", "bogus_RPC"})
    ExpectNoSuchRequest(request);
}

struct TalkingPort {
  YarpTalk talk;
  const char* port;
  CommandTable table;
  const char* help;
};
std::vector<TalkingPort> DevicePorts() {
  return {{YarpTalk::kMetadata, "/robot1/imu/rpc:o", ImuTable(), "getMetadata"},
          {YarpTalk::kAnalog, "/robot1/wrench/analog:o/rpc:i", WrenchTable(), "[iana] [cal]"},
          {YarpTalk::kLidar, "/robot1/lidar/rpc:i", LidarTable(), "getDistanceRange_RPC"},
          {YarpTalk::kBattery, "/robot1/battery/rpc:i", BatteryTable(), "getBatteryInfoRPC"},
          {YarpTalk::kOdometry, "/robot1/odometry/rpc", OdometryTable(), "reset_odometry_RPC"},
          {YarpTalk::kCamera, "/robot1/camera/rpc", CameraTable(), "visr get w"},
          {YarpTalk::kBase, "/robot1/base/command:i", MotorsTable(), "3 FORWARD"},
          {YarpTalk::kBaseRpc, "/robot1/base/rpc:i", MotorsTable(), "applyVelocityCommandRPC"}};
}

TEST(DeviceTranslator, HelpsByWordsAlsoWhenTheModuleRefuses) {
  for (const TalkingPort& each : DevicePorts()) {
    const auto device = MakeDeviceTranslator(each.talk, each.port, each.table);
    device->Decode(*ParseBottle("help"));
    for (const Message& reply : {ReplyTo(command::kPing), Refused(command::kPing)}) {
      const Bottle answer = device->Reply(reply).bottle;
      EXPECT_EQ(WordAt(answer, 0), "many") << each.port;
      EXPECT_THAT(std::string(WordAt(answer, 1)), StartsWith(each.help)) << each.port;
    }
  }
}

TEST(DeviceTranslator, OtherTalksHaveNone) {
  EXPECT_EQ(MakeDeviceTranslator(YarpTalk::kModule, "/robot1/motors/command:i", MotorsTable()), nullptr);
  EXPECT_EQ(MakeDeviceTranslator(YarpTalk::kBoardRpc, "/robot1/arm/nws/rpc:i", JointsTable()), nullptr);
}

}  // namespace
}  // namespace coopdyn::device_rpc
