// SPDX-License-Identifier: MIT
// The short description reads files like the full one.
#include "server/model/sdf_description.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/source_dir.h"

namespace coopdyn {
namespace {

/// libsdformat's result for `text`: its errors, then its content.
std::string ReadBy(sdf::SDFPtr (*describe)(const tinyxml2::XMLElement&), const std::string& text) {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
  const sdf::SDFPtr description = describe(*document.RootElement());
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Errors errors;
  const sdf::ParserConfig config;
  sdf::Root root;
  if (sdf::readString(text, config, description, errors)) {
    const sdf::Errors more = root.Load(description, config);
    errors.insert(errors.end(), more.begin(), more.end());
  }
  std::string result;
  for (const sdf::Error& error : errors) result += error.Message() + "\n";
  return result + description->Root()->ToString("");
}

TEST(SdfDescriptionTest, ItReadsEachShippedRobotAsTheWholeOneDoes) {
  int robots = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceDir() + "/robots")) {
    if (entry.path().extension() != ".sdf") continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(ReadBy(DescriptionFor, text), ReadBy(WholeDescription, text)) << entry.path();
    ++robots;
  }
  EXPECT_GE(robots, 10);
}

TEST(SdfDescriptionTest, ASensorNeedsNoElementOfItsType) {
  for (const char* type :
       {"air_pressure", "altimeter", "camera", "contact", "depth_camera", "force_torque", "gpu_lidar", "imu",
        "lidar", "logical_camera", "magnetometer", "navsat", "rgbd_camera", "sonar", "thermal_camera"}) {
    const std::string text = "<sdf version='" SDF_VERSION
                             "'><model name='m'><link name='l'><sensor name='s' type='" +
                             std::string(type) + "'/></link></model></sdf>";
    EXPECT_EQ(ReadBy(DescriptionFor, text), ReadBy(WholeDescription, text)) << type;
  }
}

TEST(SdfDescriptionTest, AnOlderVersionIsReadByTheWholeOne) {
  const std::string text =
      "<sdf version='1.4'><model name='m'><link name='l'/><link name='k'/><joint name='j' type='revolute'>"
      "<parent>l</parent><child>k</child><axis><xyz>1 0 0</xyz></axis></joint></model></sdf>";
  EXPECT_EQ(ReadBy(DescriptionFor, text), ReadBy(WholeDescription, text));
}

TEST(SdfDescriptionTest, ItLeavesOutWhatIsNotThere) {
  tinyxml2::XMLDocument document;
  document.Parse("<sdf version='" SDF_VERSION "'><model name='m'><link name='l'/></model></sdf>");
  const sdf::ElementPtr model =
      DescriptionFor(*document.RootElement())->Root()->GetElementDescription("model");
  EXPECT_TRUE(model->HasElementDescription("link"));
  EXPECT_TRUE(model->HasElementDescription("static")) << "its default may be asked for";
  EXPECT_FALSE(model->HasElementDescription("joint"));
}

}  // namespace
}  // namespace coopdyn
