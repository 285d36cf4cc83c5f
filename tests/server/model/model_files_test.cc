// SPDX-License-Identifier: MIT
// Files that models name: heightmaps, textures, materials; and malformed ones: each is refused with file,
// line and cure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "server/geometry/mesh.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

struct FilesAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

FilesAnswer ReadIn(const TempFolder& folder, const std::string& name) {
  Diagnostics diagnostics;
  FilesAnswer answer;
  answer.robot = ReadRobotModel(folder.path() / name, {}, diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}

/// A PNG of `pixels`, one or three bytes each.
std::string PngOf(unsigned width, unsigned height, const std::vector<unsigned char>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = pixels.size() == width * height ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, pixels.data(), 0, nullptr);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

std::string FixedModel(const std::string& shapes, const std::string& fixed = "<static>true</static>") {
  return "<sdf version=\"1.9\"><model name=\"rig\">" + fixed + "\n<link name=\"ground\">\n" + shapes +
         "</link></model></sdf>";
}
std::string HeightmapOf(const std::string& inside) {
  return "<collision name=\"c\"><geometry>\n<heightmap>" + inside + "</heightmap></geometry></collision>\n";
}

TEST(HeightmapTest, ItsPointsStandAsHighAsThePictureIsBright) {
  const TempFolder folder;
  // The brightest point is at the right end of the upper row.
  folder.Write("h.png", PngOf(3, 2, {0, 100, 200, 0, 0, 0}));
  folder.Write("model.sdf", FixedModel(HeightmapOf("<uri>h.png</uri><size>4 2 3</size><pos>1 0 0.5</pos>")));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 1u);
  const LinkShape& shape = robot->links[0].collisions[0];
  const MeshData& mesh = *std::get<Mesh>(shape.shape).data;
  EXPECT_EQ(mesh.triangles.size(), 4u);
  double highest = -1;
  Vector3 top = Vector3::Zero();
  for (const Vector3& v : mesh.vertices) {
    const Vector3 p = shape.X_LG * v;
    if (p.z() > highest) {
      highest = p.z();
      top = p;
    }
  }
  EXPECT_NEAR((top - Vector3(3, 1, 3.5)).norm(), 0, 1e-6);
  // All triangles face upwards.
  for (const auto& t : mesh.triangles) {
    const Vector3& a = mesh.vertices[t[0]];
    EXPECT_GT((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).z(), 0);
  }
}

TEST(HeightmapTest, OneThatIsTooFineIsTakenAtFewerPointsAndSaid) {
  const TempFolder folder;
  folder.Write("h.png", PngOf(400, 400, std::vector<unsigned char>(400 * 400, 9)));
  folder.Write("model.sdf", FixedModel(HeightmapOf("<uri>h.png</uri><size>4 4 1</size>")));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("model.sdf:4: warning: the heightmap has 400 x 400 points, and 257 x 257"));
}

TEST(HeightmapTest, MistakesSayLineAndWhatToDo) {
  const TempFolder folder;
  folder.Write("h.png", PngOf(2, 2, {0, 1, 2, 3}));
  folder.Write("bad.png", "no picture");
  const auto said = [&](const std::string& model) {
    folder.Write("model.sdf", model);
    return ReadIn(folder, "model.sdf").messages;
  };
  EXPECT_THAT(said(FixedModel(HeightmapOf("<uri>none.png</uri>"))),
              HasSubstr("model.sdf:4: error: heightmap: there is no 'none.png'"));
  EXPECT_THAT(said(FixedModel(HeightmapOf("<uri>bad.png</uri>"))),
              HasSubstr("model.sdf:4: error: heightmap: 'bad.png': pictures are read from .png and .jpg"));
  EXPECT_THAT(said(FixedModel(HeightmapOf("<uri>h.png</uri><size>0 1 1</size>"))),
              HasSubstr("model.sdf:4: error: heightmap: <size> and <pos> are three numbers"));
  EXPECT_THAT(said(FixedModel(HeightmapOf("<uri>../h.png</uri>"))),
              HasSubstr("model.sdf:4: error: heightmap:"));
  EXPECT_THAT(said(FixedModel(HeightmapOf("<uri>h.png</uri>") +
                                  "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>"
                                  "</inertia></inertial>",
                              "")),
              HasSubstr("model.sdf:2: error: link 'ground' moves, and its <heightmap> cannot: fix the link"));
}

TEST(TextureTest, APictureTooLargeIsRefusedBeforeItIsUnpacked) {
  const TempFolder folder;
  std::string bomb = PngOf(1, 1, {0});
  // Width and height in the header, and its checksum.
  bomb.replace(16, 8, std::string("\x00\x01\x86\xa0\x00\x01\x86\xa0", 8));
  std::uint32_t crc = 0xffffffff;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<unsigned char>(bomb[i]);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
  }
  crc = ~crc;
  for (std::size_t i = 0; i < 4; ++i) bomb[29 + i] = static_cast<char>(crc >> (24 - 8 * i));
  folder.Write("h.png", bomb);
  folder.Write("model.sdf", FixedModel(HeightmapOf("<uri>h.png</uri>")));
  EXPECT_THAT(
      ReadIn(folder, "model.sdf").messages,
      HasSubstr("model.sdf:4: error: heightmap: 'h.png': the picture has 100000 x 100000 points, at most"));
}

std::string VisualOf(const std::string& geometry, const std::string& map) {
  return "<visual name=\"v\"><geometry>" + geometry + "</geometry><material>\n<pbr><metal><albedo_map>" +
         map + "</albedo_map></metal></pbr></material></visual>\n";
}

TEST(TextureTest, ABoxHasTheAlbedoMapOfItsMaterial) {
  const TempFolder folder;
  folder.Write("red.png", PngOf(1, 2, {255, 0, 0, 0, 0, 255}));
  folder.Write("model.sdf", FixedModel(VisualOf("<box><size>1 2 3</size></box>", "red.png")));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkShape& visual = robot->links[0].visuals.at(0);
  const MeshData& mesh = *std::get<Mesh>(visual.shape).data;
  ASSERT_NE(mesh.skin, nullptr);
  ASSERT_NE(mesh.skin->materials.at(0).texture, nullptr);
  EXPECT_EQ(mesh.skin->materials[0].texture->height, 2);
  EXPECT_EQ(mesh.half_m, Vector3(0.5, 1, 1.5));
  EXPECT_DOUBLE_EQ(visual.color.r, 0.5);  // the mean
  EXPECT_DOUBLE_EQ(visual.color.b, 0.5);
}

TEST(TextureTest, WhereATextureIsNotDrawnIsSaid) {
  const TempFolder folder;
  folder.Write("red.png", PngOf(1, 1, {255, 0, 0}));
  folder.Write("model.sdf", FixedModel(VisualOf("<sphere><radius>1</radius></sphere>", "red.png")));
  EXPECT_THAT(ReadIn(folder, "model.sdf").messages,
              HasSubstr("model.sdf:4: warning: textures are drawn on meshes and boxes, and not on <sphere>"));
}

TEST(TextureTest, AMaterialThatNamesNoColorLeavesTheShapeGrey) {
  const TempFolder folder;
  folder.Write("model.sdf",
               FixedModel("<visual name=\"v\"><geometry><box><size>1 2 3</size></box></geometry><material>"
                          "<script><name>Mine/Wood</name></script></material></visual>\n"));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].visuals.at(0).color, Color());
}

TEST(TextureTest, AnObjHasTheMaterialsOfItsMtl) {
  const TempFolder folder;
  folder.Write("red.png", PngOf(1, 1, {255, 0, 0}));
  folder.Write("two.mtl", "newmtl a\nKd 0 1 0\nnewmtl b\nmap_Kd red.png\n");
  folder.Write(
      "two.obj",
      "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 "
      "3/3\nusemtl b\nf 1/1 2/2 4/3\n");
  folder.Write("model.sdf",
               FixedModel("<visual name=\"v\"><geometry><mesh><uri>two.obj</uri></mesh></geometry>"
                          "</visual>\n"));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  const MeshData& mesh = *std::get<Mesh>(robot->links[0].visuals.at(0).shape).data;
  ASSERT_NE(mesh.skin, nullptr);
  ASSERT_EQ(mesh.skin->materials.size(), 2u);
  EXPECT_EQ(mesh.skin->materials[0].color, (std::array<double, 3>{0, 1, 0}));
  EXPECT_NE(mesh.skin->materials[1].texture, nullptr);
  EXPECT_EQ(mesh.skin->corners.size(), mesh.vertices.size());
  // A recording stores all of it.
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  const MeshData& kept = *std::get<Mesh>(again->links[0].visuals.at(0).shape).data;
  ASSERT_NE(kept.skin, nullptr);
  EXPECT_EQ(kept.skin->materials[1].color, (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(kept.id, mesh.id);
  ASSERT_NE(kept.skin->materials[1].texture, nullptr);
  EXPECT_EQ(kept.skin->materials[1].texture->rgb, (std::vector<std::uint8_t>{255, 0, 0}));
  EXPECT_EQ(kept.skin->materials[0].texture, nullptr);
  EXPECT_TRUE(std::ranges::equal(kept.skin->corners, mesh.skin->corners, {}, &MeshSkin::Corner::uv,
                                 &MeshSkin::Corner::uv));
}

TEST(TextureTest, ARecordingCarriesAPictureOfSeveralMeshesOnceAndWhatDoesNotFitIsRefused) {
  const TempFolder folder;
  folder.Write("red.png", PngOf(2, 1, {255, 0, 0, 0, 9, 255}));
  std::string second = VisualOf("<box><size>2 2 3</size></box>", "red.png");
  second.replace(second.find("\"v\""), 3, "\"w\"");
  folder.Write("model.sdf", FixedModel(VisualOf("<box><size>1 2 3</size></box>", "red.png") + second));
  const auto [robot, messages] = ReadIn(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  const std::string mark = "<!--coopdyn:mesh texture ";
  const std::size_t at = robot->text.find(mark);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(robot->text.find(mark, at + 1), std::string::npos);
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  for (std::size_t i = 0; i < 2; ++i) {
    const MeshData& kept = *std::get<Mesh>(again->links[0].visuals.at(i).shape).data;
    EXPECT_EQ(kept.skin->materials.at(0).texture->rgb, (std::vector<std::uint8_t>{255, 0, 0, 0, 9, 255}));
  }
  std::string without = robot->text;
  without.erase(at, without.find('\n', at) + 1 - at);
  EXPECT_EQ(ReadRobotModelText(without, "model.sdf", "rig", diagnostics), nullptr);
}

TEST(TextureTest, OneThatIsMissingOrOutsideIsAWarning) {
  const TempFolder folder;
  const auto said = [&](const std::string& map) {
    folder.Write("model.sdf", FixedModel(VisualOf("<box><size>1 2 3</size></box>", map)));
    const FilesAnswer answer = ReadIn(folder, "model.sdf");
    EXPECT_NE(answer.robot, nullptr);
    return answer.messages;
  };
  EXPECT_THAT(said("none.png"),
              HasSubstr("model.sdf:4: warning: the texture 'none.png' is not drawn: there is no"));
  EXPECT_THAT(said("/etc/hostname"), HasSubstr("4: warning: the texture '/etc/hostname' is not drawn"));
}

TEST(MalformedModelTest, InertiasAndNumbersThatCannotBeAreErrorsWithTheirLine) {
  const auto said = [](const std::string& mass, const std::string& moment) {
    const TempFolder folder;
    folder.Write("model.sdf",
                 "<sdf version=\"1.9\"><model name=\"rig\">\n<link name=\"base\">\n<inertial><mass>" + mass +
                     "</mass><inertia><ixx>" + moment + "</ixx><iyy>1</iyy><izz>1</izz>" +
                     "</inertia></inertial></link></model></sdf>");
    return ReadIn(folder, "model.sdf").messages;
  };
  EXPECT_THAT(said("-1", "1"),
              HasSubstr("model.sdf:3: error: the mass of link 'base' must be a positive number"));
  EXPECT_THAT(said("1", "-1"),
              HasSubstr("model.sdf:3: error: the inertia of link 'base' is not that of a body"));
  EXPECT_THAT(said("0", "1"), HasSubstr("model.sdf:3: warning: link 'base' has no mass: it gets 10 g"));
  EXPECT_THAT(said("1", "0"), HasSubstr("that of its first shape is taken"));
  EXPECT_THAT(said("nan", "1"), HasSubstr("model.sdf:3: error: <mass> needs finite numbers, not 'nan'"));
  EXPECT_THAT(said("1", "inf"), HasSubstr("model.sdf:3: error: <ixx> needs finite numbers, not 'inf'"));
}

TEST(MassTest, ALinkWithoutInertiaIsASolidOfItsShape) {
  const TempFolder folder;
  folder.Write(
      "model.sdf",
      "<sdf version=\"1.9\"><model name=\"rig\"><link name=\"base\">\n<inertial><mass>6</mass></inertial>"
      "<visual name=\"v\"><geometry><box><size>1 2 3</size></box></geometry></visual>"
      "</link></model></sdf>");
  const FilesAnswer answer = ReadIn(folder, "model.sdf");
  EXPECT_THAT(answer.messages, HasSubstr("model.sdf:2: warning: link 'base' needs <inertia>: that of its "
                                         "first shape is taken, as a solid of this mass"));
  ASSERT_NE(answer.robot, nullptr);
  EXPECT_TRUE(answer.robot->links[0].inertia_kg_m2.isApprox(Vector3(6.5, 5, 2.5), 1e-9));
}

TEST(MalformedModelTest, JointsThatJoinNothingAreErrorsWithTheirLine) {
  const auto said = [](const std::string& joint) {
    const TempFolder folder;
    std::string links;
    for (const char* name : {"base", "arm"})
      links += "<link name=\"" + std::string(name) +
               "\"><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
               "</link>";
    folder.Write("model.sdf",
                 "<sdf version=\"1.9\"><model name=\"rig\">" + links + "\n" + joint + "</model></sdf>");
    return ReadIn(folder, "model.sdf").messages;
  };
  const auto joint = [](const std::string& type, const std::string& parent, const std::string& child,
                        const std::string& axis = "0 0 1") {
    return "<joint name=\"j\" type=\"" + type + "\"><parent>" + parent + "</parent>\n<child>" + child +
           "</child>\n<axis><xyz>" + axis + "</xyz></axis></joint>";
  };
  EXPECT_THAT(
      said(joint("revolute", "base", "arn")),
      HasSubstr("model.sdf:3: error: <child> of joint 'j' names no link of this model: 'arn'; did you "
                "mean 'arm'?"));
  EXPECT_THAT(said(joint("revolute", "arm", "arm")),
              HasSubstr("model.sdf:2: error: joint 'j' joins link 'arm' to itself"));
  EXPECT_THAT(said(joint("hinge", "base", "arm")),
              HasSubstr("model.sdf:2: error: joint 'j' cannot be of type 'hinge': write one of"));
  EXPECT_THAT(said(joint("revolute", "base", "arm", "0 0 0")),
              HasSubstr("model.sdf:4: error: the <xyz> of joint 'j' is the direction of its axis"));
  EXPECT_THAT(said(joint("revolute", "base", "arm") + joint("fixed", "base", "arm")),
              HasSubstr("model.sdf:4: error: there are two called 'j': give this <joint> another name"));
}

TEST(MalformedModelTest, ALoopOfJointsInUrdfIsAnErrorWithItsLine) {
  const TempFolder folder;
  folder.Write("rig.urdf",
               "<robot name=\"rig\"><link name=\"a\"/><link name=\"b\"/>\n"
               "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>\n"
               "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint></robot>");
  const std::string messages = ReadIn(folder, "rig.urdf").messages;
  EXPECT_THAT(messages,
              HasSubstr("rig.urdf:3: error: joint 'k': link 'a' hangs on itself by a loop of joints"));
}

TEST(MalformedModelTest, EntitiesThatGrowAreNotExpanded) {
  const TempFolder folder;
  folder.Write("model.sdf",
               "<?xml version=\"1.0\"?><!DOCTYPE b [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n"
               "<sdf version=\"1.9\"><model name=\"rig\"><link name=\"&b;\"/></model></sdf>");
  const FilesAnswer answer = ReadIn(folder, "model.sdf");
  EXPECT_EQ(answer.messages.find("aaaaaaaaaaaa"), std::string::npos) << answer.messages;
}

TEST(MalformedModelTest, AMeshOfTenMillionTrianglesIsRefusedByItsHeader) {
  const TempFolder folder;
  std::string stl(84, '\0');
  const std::uint32_t count = 10'000'000;
  std::memcpy(stl.data() + 80, &count, sizeof(count));
  folder.Write("big.stl", stl);
  folder.Write("model.sdf", FixedModel("<collision name=\"c\"><geometry>\n<mesh><uri>big.stl</uri></mesh>"
                                       "</geometry></collision>\n"));
  EXPECT_THAT(
      ReadIn(folder, "model.sdf").messages,
      HasSubstr("model.sdf:4: error: mesh 'big.stl': the mesh has 10000000 triangles, at most 2000000 are "
                "read: simplify it"));
}

TEST(MalformedModelTest, AMeshThatIsAPipeIsNotWaitedFor) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "pipe.stl").c_str(), 0600), 0);
  folder.Write("model.sdf", FixedModel("<collision name=\"c\"><geometry>\n<mesh><uri>pipe.stl</uri></mesh>"
                                       "</geometry></collision>\n"));
  EXPECT_THAT(ReadIn(folder, "model.sdf").messages,
              HasSubstr("model.sdf:4: error: mesh 'pipe.stl': it cannot be read"));
}

TEST(MalformedModelTest, ADamagedMeshIsReadOnceForAllItsUses) {
  const TempFolder folder;
  folder.Write("bad.stl", "no mesh");
  const std::string mesh = "<geometry>\n<mesh><uri>bad.stl</uri></mesh></geometry>";
  folder.Write("model.sdf", FixedModel("<collision name=\"a\">" + mesh +
                                       "</collision><collision name=\"b\">" + mesh + "</collision>\n"));
  const std::string messages = ReadIn(folder, "model.sdf").messages;
  EXPECT_THAT(messages, HasSubstr("model.sdf:4: error: mesh 'bad.stl': "));
  EXPECT_THAT(messages, HasSubstr("model.sdf:5: error: 'bad.stl' cannot be used, as is said above"));
}

TEST(MalformedModelTest, AMeshThatIsNotThereIsSaidWithWhereToPutIt) {
  const TempFolder folder;
  folder.Write("model.sdf", FixedModel("<collision name=\"c\"><geometry>\n<mesh><uri>none.stl</uri></mesh>"
                                       "</geometry></collision>\n"));
  EXPECT_THAT(
      ReadIn(folder, "model.sdf").messages,
      HasSubstr("model.sdf:4: warning: mesh: there is no 'none.stl' in the model's folder or on the search "
                "path: add it"));
}

TEST(MalformedModelTest, ALoopOfFixedJointsIsAnErrorWithItsLine) {
  const TempFolder folder;
  folder.Write("model.sdf",
               "<sdf version=\"1.9\"><model name=\"rig\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n"
               "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>b</child></joint>\n"
               "<joint name=\"k\" type=\"fixed\"><parent>b</parent><child>a</child></joint>\n</model></sdf>");
  EXPECT_THAT(ReadIn(folder, "model.sdf").messages,
              HasSubstr("model.sdf:2: error: link 'a' hangs in a loop of fixed joints: remove one of them"));
}

}  // namespace
}  // namespace coopdyn
