// SPDX-License-Identifier: MIT
// What sensors send, in the bytes of multipleAnalogSensors, of a lidar, of odometry and of a camera of YARP.
#include "server/yarp/sensor_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

using Measured = std::map<std::size_t, std::vector<double>>;

constexpr double kPi = std::numbers::pi;
constexpr double kNothingInRange = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
// The order of the lists of multipleAnalogSensors.
constexpr std::size_t kGyroscopes = 0, kAccelerometers = 1, kOrientations = 3, kForcesAndTorques = 5,
                      kContactLoads = 6, kEncoderArrays = 7, kPositions = 9, kLinearVelocities = 10;

auto AllAbout(const std::vector<double>& values) {
  return ::testing::Pointwise(::testing::DoubleNear(1e-9), values);
}

/// A push of `reading` at 12.5 s.
Message PushOf(command::Id reading, std::vector<double> data, std::vector<std::int32_t> params = {}) {
  Message push;
  push.command = -reading;
  push.params = std::move(params);
  push.data = std::move(data);
  push.data.insert(push.data.end(), {12.5, 1250});
  return push;
}

/// Turned by 30 degrees about x, then 40 about y, then 50 about z of the world.
const std::vector<double> kTurned = {0.860042173697679, 0.08080468869083995, 0.40219849353410964,
                                     0.30337177447125957};

Message ImuReading() {
  std::vector<double> data = kTurned;
  data.insert(data.end(), {kPi, -kPi / 2, kPi / 180, 1, -2, 9.81});
  return PushOf(command::kGetImu, data);
}
Message WrenchReading() {
  return PushOf(command::kGetWrench, {1, 2, 3, 4, 5, 6});
}
Message PoseReading() {
  std::vector<double> data = {1, 2, 3};
  data.insert(data.end(), kTurned.begin(), kTurned.end());
  data.insert(data.end(), {0.1, 0.2, 0.3, 7, 8, 9});
  return PushOf(command::kGetPose3d, data);
}
/// Of a joint that turns, at 45 degrees, and one that slides, at 0.25 m.
Message BoardReading() {
  std::vector<double> data(34);
  data[0] = kPi / 4;
  data[17] = 0.25;
  Message board = PushOf(command::kGetBoard, data, {0, 1, 1, 1, 1, 1});
  board.text = "elbow lift";
  return board;
}
Message OdometryReading() {
  return PushOf(command::kGetOdometry, {1, -2, kPi / 2, 3, kPi / 4});
}
/// Four columns from -90 degrees on, 45 apart; three rows, of which the middle one is level.
Message Geometry() {
  return PushOf(command::kGetScanGeometry, {-kPi / 2, kPi / 4, 0.1, 5, 3, 4, -0.2, 0.2});
}
Message GeometryWith(std::size_t at, double value) {
  Message geometry = Geometry();
  geometry.data[at] = value;
  return geometry;
}
Message ScanReading() {
  return PushOf(command::kGetScan, {1, 1, 1, 1, 2, kNothingInRange, 0, 2.5, 3, 3, 3, 3});
}
Message ImageReading(std::int32_t width, std::int32_t height, std::string pixels) {
  std::vector<std::int32_t> params = {width, height, static_cast<std::int32_t>(pixels.size())};
  pixels.resize((pixels.size() + 3) / 4 * 4, '\x55');
  params.resize(3 + pixels.size() / 4);
  std::memcpy(&params[3], pixels.data(), pixels.size());
  return PushOf(command::kGetImage, {}, params);
}

std::string SampleBytes(YarpSample sample, const Message& reading, YarpDialect dialect = YarpDialect::k3,
                        const Message& geometry = Geometry()) {
  std::string bytes;
  EXPECT_TRUE(AppendSensorSample(sample, reading, geometry, dialect, bytes));
  return bytes;
}
/// It gives no sample, and writes nothing.
bool IsLeftOut(YarpSample sample, const Message& reading, const Message& geometry = Geometry()) {
  std::string bytes = "before";
  const bool appended = AppendSensorSample(sample, reading, geometry, YarpDialect::k3, bytes);
  return !appended && bytes == "before";
}

Bottle ItemsOf(const std::string& bytes) {
  YarpDialect dialect = YarpDialect::k3;
  const std::optional<Bottle> items = DecodeBottle(bytes, dialect);
  EXPECT_TRUE(items.has_value());
  return items.value_or(Bottle());
}
std::vector<double> NumbersIn(const Bottle& bottle) {
  std::vector<double> numbers;
  for (const BottleValue& item : bottle) numbers.push_back(NumberOf(item).value_or(kNotANumber));
  return numbers;
}

/// What each kind of sensor measures, at 12.5 s.
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
  const double half = 0.70710678118654757;  // whose square is more than a half
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

TEST(LaserSample, HasTheBytesOfYarp3) {
  EXPECT_EQ(SampleBytes(YarpSample::kLaserScan, ScanReading()),
            Hex("00010000 06000000 0a000000 00000000008056c0 0a000000 0000000000805640"
                "0a000000 9a9999999999b93f 0a000000 0000000000001440 0a010000 04000000 0000000000000040"
                "000000000000f07f 0000000000000000 0000000000000440 01000000 01000000"));
}

TEST(LaserSample, HasTheBytesOfYarp4) {
  EXPECT_EQ(SampleBytes(YarpSample::kLaserScan, ScanReading(), YarpDialect::k4),
            Hex("00010000 06000000 14000000 00000000008056c0 14000000 0000000000805640"
                "14000000 9a9999999999b93f 14000000 0000000000001440 14010000 04000000 0000000000000040"
                "000000000000f07f 0000000000000000 0000000000000440 01000000 01000000"));
}

TEST(LaserSample, WithoutAllItsRangesIsLeftOut) {
  Message scan = ScanReading();
  scan.data.erase(scan.data.begin(), scan.data.begin() + 4);
  EXPECT_FALSE(IsLeftOut(YarpSample::kLaserScan, scan));  // the level row is still there
  scan.data.erase(scan.data.begin());
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, scan));
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, PushOf(command::kGetScan, {})));
}

TEST(LaserSample, WithoutAGeometryIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, ScanReading(), Message()));
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, ScanReading(), GeometryWith(5, 0)));
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, ScanReading(), GeometryWith(5, kNotANumber)));
  EXPECT_TRUE(IsLeftOut(YarpSample::kLaserScan, ScanReading(), GeometryWith(5, 1e6)));
}

TEST(ScanGeometry, IsInDegreesAndEndsOneRayAfterTheLast) {
  const std::optional<ScanLimits> limits = ReadScanGeometry(Geometry());
  ASSERT_TRUE(limits);
  EXPECT_DOUBLE_EQ(limits->first_deg, -90);
  EXPECT_DOUBLE_EQ(limits->increment_deg, 45);
  EXPECT_DOUBLE_EQ(limits->end_deg, 90);
  EXPECT_EQ(limits->min_range_m, 0.1);
  EXPECT_EQ(limits->max_range_m, 5);
  EXPECT_EQ(limits->columns, 4u);
}

TEST(ScanGeometry, TheRowIsTheOneNearestToLevel) {
  const auto row = [](double rows, double low, double step) {
    const std::optional<ScanLimits> limits =
        ReadScanGeometry(PushOf(command::kGetScanGeometry, {-kPi / 2, kPi / 4, 0.1, 5, rows, 4, low, step}));
    return limits ? limits->row : 99;
  };
  EXPECT_EQ(row(3, -0.2, 0.2), 1u);
  EXPECT_EQ(row(3, -0.1, 0.3), 0u);
  EXPECT_EQ(row(3, -0.2, 0.3), 1u);
  EXPECT_EQ(row(3, 0.1, 0.1), 0u) << "all look up";
  EXPECT_EQ(row(3, -1, 0.1), 2u) << "all look down";
  EXPECT_EQ(row(1, 0, 0), 0u) << "one row has no step";
  EXPECT_EQ(row(1, -0.5, 0), 0u);
}

TEST(ScanGeometry, OfImpossibleRowsAndColumnsIsNone) {
  for (const std::size_t rows_or_columns : {4, 5}) {
    for (const double value : {0.0, 0.5, -1.0, 1e7, 1e300, kNothingInRange, -kNothingInRange, kNotANumber})
      EXPECT_FALSE(ReadScanGeometry(GeometryWith(rows_or_columns, value))) << rows_or_columns << ' ' << value;
  }
}

TEST(ScanGeometry, OfAnglesThatAreNoNumbersIsNone) {
  EXPECT_FALSE(ReadScanGeometry(GeometryWith(6, kNotANumber)));
  EXPECT_FALSE(ReadScanGeometry(GeometryWith(7, kNotANumber)));
}

TEST(ScanGeometry, OfAnErrorOrAnotherLengthIsNone) {
  Message geometry = Geometry();
  geometry.error = static_cast<std::int32_t>(Error::kNotPossible);
  EXPECT_FALSE(ReadScanGeometry(geometry));
  EXPECT_FALSE(ReadScanGeometry(Message()));
  geometry = Geometry();
  geometry.data.pop_back();
  EXPECT_FALSE(ReadScanGeometry(geometry));
  geometry = Geometry();
  geometry.data.push_back(0);
  EXPECT_FALSE(ReadScanGeometry(geometry));
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

TEST(ImageSample, HasTheBytesOfARealCamera) {
  EXPECT_EQ(SampleBytes(YarpSample::kImage,
                        ImageReading(4, 3, std::string(24, '\0') + Hex("ff0000 ff0000 ff0000 ff0000"))),
            Hex("00010000 04000000 09000000 'mat_' 09000000 'rgb_' 01010000 05000000"
                "03000000 30000000 08000000 04000000 03000000 0c000000 30000000"
                "00000000000000000000000000000000 00000000000000000000000000000000"
                "ff0000ff0000ff0000ff0000 00000000"));
}

TEST(ImageSample, FillsEachRowToEightBytes) {
  const std::string bytes = SampleBytes(YarpSample::kImage, ImageReading(1, 2, "rgbRGB"));
  EXPECT_EQ(bytes.substr(60), Hex("'rgb_____RGB_____'"));
  EXPECT_EQ(bytes.substr(36, 4), Hex("10000000"));
}

TEST(ImageSample, FillsNoRowThatNeedsNothing) {
  const std::string pixels = "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuv";  // two rows of eight
  EXPECT_EQ(SampleBytes(YarpSample::kImage, ImageReading(8, 2, pixels)).substr(60), pixels);
}

TEST(ImageSample, OfDepthIsOfFloats) {
  EXPECT_EQ(SampleBytes(YarpSample::kDepth, ImageReading(1, 2, Hex("0000c03f 0000807f"))),
            Hex("00010000 04000000 09000000 'mat_' 09000000 'dec_' 01010000 05000000"
                "04000000 10000000 08000000 01000000 02000000 0c000000 10000000"
                "0000c03f 00000000 0000807f 00000000"));
}

TEST(ImageSample, IsTheSameInBothVersions) {
  const Message image = ImageReading(1, 2, "rgbRGB");
  EXPECT_EQ(SampleBytes(YarpSample::kImage, image, YarpDialect::k4), SampleBytes(YarpSample::kImage, image));
}

TEST(ImageSample, OfAnotherFormatIsLeftOut) {
  EXPECT_TRUE(IsLeftOut(YarpSample::kDepth, ImageReading(1, 2, "rgbRGB")));
  EXPECT_TRUE(IsLeftOut(YarpSample::kImage, ImageReading(1, 2, "depthIN4")));
  EXPECT_TRUE(IsLeftOut(YarpSample::kImage, ImageReading(640, 480, "a JPEG")));
}

TEST(ImageSample, WithoutAllItsBytesIsLeftOut) {
  Message image = ImageReading(1, 2, "rgbRGB");
  image.params.pop_back();
  EXPECT_TRUE(IsLeftOut(YarpSample::kImage, image));
  image.params.resize(2);
  EXPECT_TRUE(IsLeftOut(YarpSample::kImage, image));
  image.params.clear();
  EXPECT_TRUE(IsLeftOut(YarpSample::kImage, image));
}

TEST(ImageSample, OfAnImpossibleSizeIsLeftOut) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::vector<std::int32_t> impossible[] = {{0, 0, 0, 0},
                                                  {0, 4, 0, 0},
                                                  {4, 0, 0, 0},
                                                  {-1, -2, 6, 0, 0},
                                                  {1, -2, -6, 0},
                                                  {-1, 1, -3, 0, 0},
                                                  {1 << 16, 1 << 16, 0, 0},
                                                  {20000, 30000, 1'800'000'000, 0}};
  for (const std::vector<std::int32_t>& params : impossible)
    EXPECT_TRUE(IsLeftOut(YarpSample::kImage, PushOf(command::kGetImage, {}, params))) << params[0];
  for (const YarpSample sample : {YarpSample::kImage, YarpSample::kDepth})
    EXPECT_TRUE(IsLeftOut(sample, PushOf(command::kGetImage, {}, {kMost, kMost, kMost, 0})));
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

/// The kinds that have a sensor.
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
}  // namespace coopdyn
