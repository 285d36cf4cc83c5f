// SPDX-License-Identifier: MIT
// Samples of sensors, in the bytes of YARP's multipleAnalogSensors and odometry.
#include "server/yarp/sensor_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/server/yarp/sensor_readings.h"

namespace coopdyn::yarp_sensors {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

// The order of the lists of multipleAnalogSensors.
constexpr std::size_t kGyroscopes = 0, kAccelerometers = 1, kOrientations = 3, kForcesAndTorques = 5,
                      kContactLoads = 6, kEncoderArrays = 7, kPositions = 9, kLinearVelocities = 10;

using Measured = std::map<std::size_t, std::vector<double>>;

/// A measurement of each kind of sensor, at 12.5 s.
Measured MeasuresIn(const std::string& bytes) {
  const Bottle kinds = ItemsOf(bytes);
  EXPECT_EQ(kinds.size(), 12u);
  Measured measured;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    const Bottle* const sensors = kinds[kind].As<Bottle>();
    if (sensors != nullptr && sensors->empty()) continue;
    const Bottle* const sensor =
        sensors != nullptr && sensors->size() == 1 ? sensors->front().As<Bottle>() : nullptr;
    const Bottle* const values =
        sensor != nullptr && sensor->size() == 2 ? (*sensor)[0].As<Bottle>() : nullptr;
    if (values == nullptr) {
      ADD_FAILURE() << "kind " << kind << " of " << BottleText(kinds);
      continue;
    }
    EXPECT_EQ(NumberOf((*sensor)[1]), 12.5);
    measured[kind] = NumbersIn(*values);
  }
  return measured;
}
Measured MeasuresOf3(const Message& reading) {
  return MeasuresIn(SampleBytes(YarpSample::kMeasures, reading));
}

TEST(MeasuresSample, HasTheBytesOfYarp3) {
  EXPECT_EQ(SampleBytes(YarpSample::kMeasures, WrenchReading()),
            Hex("00010000 0c000000"
                "00010000 00000000 00010000 00000000 00010000 00000000 00010000 00000000 00010000 00000000"
                "00010000 01000000 00010000 02000000 0a010000 06000000"
                "000000000000f03f 0000000000000040 0000000000000840"
                "0000000000001040 0000000000001440 0000000000001840 0a000000 0000000000002940"
                "00010000 00000000 00010000 00000000 00010000 00000000"
                "00010000 00000000 00010000 00000000 00010000 00000000"));
}

TEST(MeasuresSample, HasTheBytesOfYarp4) {
  EXPECT_EQ(SampleBytes(YarpSample::kMeasures, WrenchReading(), YarpDialect::k4),
            Hex("00010000 0c000000"
                "00010000 00000000 00010000 00000000 00010000 00000000 00010000 00000000 00010000 00000000"
                "00010000 01000000 00010000 02000000 14010000 06000000"
                "000000000000f03f 0000000000000040 0000000000000840"
                "0000000000001040 0000000000001440 0000000000001840 14000000 0000000000002940"
                "00010000 00000000 00010000 00000000 00010000 00000000"
                "00010000 00000000 00010000 00000000 00010000 00000000"));
}

TEST(MeasuresSample, OfAnImuIsInDegrees) {
  EXPECT_THAT(MeasuresOf3(ImuReading()),
              ElementsAre(::testing::Pair(kGyroscopes, AllAbout({180, -90, 1})),
                          ::testing::Pair(kAccelerometers, AllAbout({1, -2, 9.81})),
                          ::testing::Pair(kOrientations, AllAbout({30, 40, 50}))));
}

TEST(MeasuresSample, OfAnImuThatLooksStraightDownIsFinite) {
  Message imu = ImuReading();
  const double half = 0.70710678118654757;  // its square exceeds one half
  for (const auto& [at, value] : {std::pair(0, half), {1, 0.0}, {2, half}, {3, 0.0}}) imu.data[at] = value;
  ASSERT_GT(2 * half * half, 1);
  EXPECT_NEAR(MeasuresOf3(imu)[kOrientations].at(1), 90, 1e-6);
}

TEST(MeasuresSample, OfAWrenchIsForceAndTorque) {
  EXPECT_THAT(MeasuresOf3(WrenchReading()),
              ElementsAre(::testing::Pair(kForcesAndTorques, AllAbout({1, 2, 3, 4, 5, 6}))));
}

TEST(MeasuresSample, OfContactsIsTheSumOfTheForces) {
  const Message contacts =
      PushOf(command::kGetContacts, {3, 1, 1, 1, 0, 0, 1, 4.5, 2, 2, 2, 0, 1, 0}, {1, 2});
  EXPECT_THAT(MeasuresOf3(contacts), ElementsAre(::testing::Pair(kContactLoads, AllAbout({7.5}))));
}

TEST(MeasuresSample, OfNoContactIsNoLoad) {
  EXPECT_THAT(MeasuresOf3(PushOf(command::kGetContacts, {})),
              ElementsAre(::testing::Pair(kContactLoads, AllAbout({0}))));
}

TEST(MeasuresSample, OfJointsIsInDegreesWhereTheyTurnAndInMetresWhereTheySlide) {
  EXPECT_THAT(MeasuresOf3(BoardReading()),
              ElementsAre(::testing::Pair(kEncoderArrays, AllAbout({45, 0.25}))));
}

TEST(MeasuresSample, OfAPoseIsOrientationPlaceAndLinearVelocity) {
  EXPECT_THAT(MeasuresOf3(PoseReading()),
              ElementsAre(::testing::Pair(kOrientations, AllAbout({30, 40, 50})),
                          ::testing::Pair(kPositions, AllAbout({1, 2, 3})),
                          ::testing::Pair(kLinearVelocities, AllAbout({0.1, 0.2, 0.3}))));
}

TEST(MeasuresSample, OfAReplyIsThatOfAPush) {
  Message reply = WrenchReading();
  reply.command = command::kGetWrench;
  EXPECT_EQ(SampleBytes(YarpSample::kMeasures, reply), SampleBytes(YarpSample::kMeasures, WrenchReading()));
}

TEST(MeasuresSample, OfAReadingOfAnotherLengthIsLeftOut) {
  for (Message reading : {ImuReading(), WrenchReading(), PoseReading(), BoardReading()}) {
    reading.data.insert(reading.data.begin(), 0);
    EXPECT_TRUE(IsLeftOut(YarpSample::kMeasures, reading)) << reading.command;
    reading.data.erase(reading.data.begin(), reading.data.begin() + 2);
    EXPECT_TRUE(IsLeftOut(YarpSample::kMeasures, reading)) << reading.command;
    reading.data = {12.5, 1250};
    EXPECT_TRUE(IsLeftOut(YarpSample::kMeasures, reading)) << reading.command;
  }
}

TEST(MeasuresSample, OfAReadingThatMeasuresNothingOfThatIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kMeasures, OdometryReading()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kMeasures, PushOf(command::kPing, {1, 2, 3, 4, 5, 6})));
}

TEST(InertialSample, IsOrientationAccelerationTurnRatesAndNoMagnetometer) {
  EXPECT_THAT(NumbersIn(ItemsOf(SampleBytes(YarpSample::kInertial, ImuReading()))),
              AllAbout({30, 40, 50, 1, -2, 9.81, 180, -90, 1, 0, 0, 0}));
}

TEST(InertialSample, IsAVectorOfEachVersion) {
  const std::string three = SampleBytes(YarpSample::kInertial, ImuReading()),
                    four = SampleBytes(YarpSample::kInertial, ImuReading(), YarpDialect::k4);
  EXPECT_THAT(three, StartsWith(Hex("0a010000 0c000000")));
  EXPECT_THAT(four, StartsWith(Hex("14010000 0c000000")));
  EXPECT_EQ(three.size(), 8u + 12 * 8);
  EXPECT_EQ(three.substr(8), four.substr(8));
}

TEST(InertialSample, OfAnotherReadingIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kInertial, WrenchReading()));
  Message cut = ImuReading();
  cut.data.erase(cut.data.begin());
  EXPECT_TRUE(IsLeftOut(YarpSample::kInertial, cut));
}

TEST(OdometrySample, HasItsVelocitiesAlsoInTheWorld) {
  EXPECT_THAT(NumbersIn(ItemsOf(SampleBytes(YarpSample::kOdometry, OdometryReading()))),
              AllAbout({1, -2, 90, 3, 0, 45, 0, 3, 45}));
}

TEST(OdometrySample, OfTheTruePoseIsTheSame) {
  Message pose = OdometryReading();
  pose.command = -command::kGetPose;
  EXPECT_EQ(SampleBytes(YarpSample::kOdometry, pose), SampleBytes(YarpSample::kOdometry, OdometryReading()));
}

TEST(OdometrySample, HasATagForEachNumber) {
  const Message ahead = PushOf(command::kGetOdometry, {1, 2, 0, 3, 0});
  const std::string numbers[] = {"000000000000f03f", "0000000000000040", "0000000000000000",
                                 "0000000000000840", "0000000000000000", "0000000000000000",
                                 "0000000000000840", "0000000000000000", "0000000000000000"};
  std::string three = Hex("00010000 09000000"), four = three;
  for (const std::string& number : numbers) {
    three += Hex("0a000000 " + number);
    four += Hex("14000000 " + number);
  }
  EXPECT_EQ(SampleBytes(YarpSample::kOdometry, ahead), three);
  EXPECT_EQ(SampleBytes(YarpSample::kOdometry, ahead, YarpDialect::k4), four);
}

TEST(OdometrySample, OfAnotherLengthIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kOdometry, PushOf(command::kGetOdometry, {})));
  EXPECT_TRUE(IsLeftOut(YarpSample::kOdometry, PushOf(command::kGetOdometry, {1, 2, 3, 4})));
  EXPECT_TRUE(IsLeftOut(YarpSample::kOdometry, WrenchReading()));
}

TEST(BatterySample, HasItsChargeAndNoNumberForWhatIsNotModelled) {
  EXPECT_EQ(SampleBytes(YarpSample::kBattery, BatteryReading()),
            Hex("00010000 05000000 0a000000 0000000000c05240 0a000000 000000000000f87f 0a000000 "
                "000000000000f87f 0a000000 000000000000f87f 01000000 02000000"));
  EXPECT_EQ(SampleBytes(YarpSample::kBattery, BatteryReading(), YarpDialect::k4).substr(8, 12),
            Hex("14000000 0000000000c05240"));
}

TEST(BatterySample, WarnsAsItsChargeGetsLow) {
  const auto status = [](double fraction, double power_w) {
    return NumberOf(ItemsOf(SampleBytes(YarpSample::kBattery, BatteryReading(fraction, power_w))).back());
  };
  EXPECT_EQ(status(1, 0), 0);  // standby
  EXPECT_EQ(status(0.16, 1), 2);
  EXPECT_EQ(status(0.15, 1), 5);
  EXPECT_EQ(status(0.05, 1), 6);
  EXPECT_EQ(status(0, 1), 6);
}

TEST(BatterySample, OfOtherReadingsIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kBattery, WrenchReading()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kBattery, PushOf(command::kGetBattery, {1, 2})));
  EXPECT_TRUE(IsLeftOut(YarpSample::kBattery, PushOf(command::kGetTime, {1, 2, 3})));
}

struct GoodReading {
  YarpSample sample;
  Message reading;
};
std::vector<GoodReading> GoodReadings() {
  return {{YarpSample::kMeasures, ImuReading()},
          {YarpSample::kMeasures, PushOf(command::kGetContacts, {})},
          {YarpSample::kInertial, ImuReading()},
          {YarpSample::kLaserScan, ScanReading()},
          {YarpSample::kOdometry, OdometryReading()},
          {YarpSample::kBattery, BatteryReading()},
          {YarpSample::kImage, ImageReading(1, 1, "rgb")},
          {YarpSample::kDepth, ImageReading(1, 1, "four")}};
}

TEST(SensorSample, IsAppended) {
  for (const auto& [sample, reading] : GoodReadings()) {
    std::string bytes = "before";
    EXPECT_TRUE(AppendSensorSample(sample, reading, Geometry(), YarpDialect::k3, bytes)) << reading.command;
    EXPECT_EQ(bytes, "before" + SampleBytes(sample, reading)) << reading.command;
  }
}

TEST(SensorSample, OfAnErrorIsLeftOut) {
  for (auto& [sample, reading] : GoodReadings()) {
    Message refused = reading;
    refused.error = static_cast<std::int32_t>(Error::kNotPossible);
    EXPECT_TRUE(IsLeftOut(sample, refused)) << reading.command;
    EXPECT_TRUE(IsLeftOut(sample, ErrorReply(-reading.command, Error::kNotPossible, "no")))
        << reading.command;
  }
}

TEST(SensorSample, WithoutTimeAndStepIsLeftOut) {
  for (auto& [sample, reading] : GoodReadings()) {
    Message cut = reading;
    cut.data = {12.5};
    EXPECT_TRUE(IsLeftOut(sample, cut)) << reading.command;
    cut.data.clear();
    EXPECT_TRUE(IsLeftOut(sample, cut)) << reading.command;
  }
}

TEST(SensorSample, OfKindsThatAreWrittenElsewhereIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kReading, WrenchReading()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kParams, WrenchReading()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kBoard, BoardReading()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kBoardPositions, BoardReading()));
}

TEST(MeasuresMetadata, HasTheLayoutOfARealDevice) {
  const std::string none = Hex("00010000 00000000"),
                    sensor =
                        Hex("00010000 01000000 00010000 03000000 04000000 05000000 'torso'"
                            "04000000 05000000 'torso' 04000000 00000000");
  EXPECT_EQ(MeasuresMetadata("imu", "torso"), Hex("00010000 0c000000") + sensor + sensor + none + sensor +
                                                  none + none + none + none + none + none + none + none);
}

/// The kinds of which `module` has a sensor.
std::vector<std::size_t> KindsNamed(std::string_view module) {
  const Bottle kinds = ItemsOf(MeasuresMetadata(module, "name"));
  EXPECT_EQ(kinds.size(), 12u);
  std::vector<std::size_t> named;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    if (kinds[kind] != BottleValue{Bottle()}) named.push_back(kind);
  }
  return named;
}

TEST(MeasuresMetadata, EachKindOfModuleHasItsSensors) {
  EXPECT_THAT(KindsNamed("imu"), ElementsAre(kGyroscopes, kAccelerometers, kOrientations));
  EXPECT_THAT(KindsNamed("wrench"), ElementsAre(kForcesAndTorques));
  EXPECT_THAT(KindsNamed("contact"), ElementsAre(kContactLoads));
  EXPECT_THAT(KindsNamed("joints"), ElementsAre(kEncoderArrays));
  EXPECT_THAT(KindsNamed("pose"), ElementsAre(kOrientations, kPositions, kLinearVelocities));
}

TEST(MeasuresMetadata, OtherModulesHaveNone) {
  EXPECT_THAT(KindsNamed("camera"), ElementsAre());
  EXPECT_THAT(KindsNamed(""), ElementsAre());
}

TEST(MeasuresMetadata, NamesWhatIsMeasured) {
  const std::pair<std::string_view, Message> modules[] = {{"imu", ImuReading()},
                                                          {"wrench", WrenchReading()},
                                                          {"contact", PushOf(command::kGetContacts, {})},
                                                          {"joints", BoardReading()},
                                                          {"pose", PoseReading()}};
  for (const auto& [module, reading] : modules) {
    std::vector<std::size_t> measured;
    for (const auto& [kind, values] : MeasuresOf3(reading)) measured.push_back(kind);
    EXPECT_EQ(KindsNamed(module), measured) << module;
  }
}

}  // namespace
}  // namespace coopdyn::yarp_sensors
