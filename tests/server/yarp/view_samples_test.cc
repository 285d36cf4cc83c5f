// SPDX-License-Identifier: MIT
// Samples of lidars and cameras, in the bytes of YARP's devices.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/server/yarp/sensor_readings.h"

namespace coopdyn::yarp_sensors {
namespace {

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

}  // namespace
}  // namespace coopdyn::yarp_sensors
