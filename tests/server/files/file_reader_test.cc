// SPDX-License-Identifier: MIT
// Files that crash or hang the libraries that read them: each is an error, and the next file is still read.
#include "server/files/file_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "server/base/sanitizers.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
// Body of a PLY, after its format.
const std::string kPlyElements =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyNumbers = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string ColladaOf(const std::string& corners) {
  return R"(<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries>
<geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         corners + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

class FileReaderTest : public ::testing::Test {
 protected:
  std::optional<MeshAnswer> Read(const std::string& name, const std::string& bytes) {
    why_.clear();
    return reader_.ReadMesh(
        {name, bytes, {1, 1, 1}, ""},
        [this](bool, const std::string& wanted, std::string& why) -> std::optional<std::string> {
          if (const auto found = others_.find(wanted); found != others_.end()) return found->second;
          why = "there is no '" + wanted + "'";
          return std::nullopt;
        },
        why_);
  }
  /// Kills the child as the system does when memory runs out. Its end of the socket is then closed, but
  /// nobody has waited for it yet.
  static void EndHelper() {
    const auto own = std::to_string(getpid());
    for (const auto& entry : std::filesystem::directory_iterator("/proc/" + own + "/task")) {
      std::ifstream children(entry.path() / "children");
      for (pid_t child = 0; children >> child;) {
        kill(child, SIGKILL);
        siginfo_t ended{};
        waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
      }
    }
  }
  void ExpectNextIsRead() {
    const auto mesh = Read("next.obj", kTriangle);
    ASSERT_TRUE(mesh) << why_;
    EXPECT_EQ(mesh->parts.triangles.size(), 1u);
  }

  FileReader reader_{{.cpu_s = 1, .memory_mib = 512}};
  std::map<std::string, std::string> others_;
  std::string why_;
};

TEST_F(FileReaderTest, AColladaFileIsRead) {
  const auto mesh = Read("a.dae", ColladaOf("0 1 2"));
  ASSERT_TRUE(mesh) << why_;
  EXPECT_EQ(mesh->parts.triangles.size(), 1u);
}

TEST_F(FileReaderTest, AMeshIsReadWithItsScale) {
  const auto mesh = reader_.ReadMesh({"a.obj", kTriangle, {2, 3, 1}, ""}, {}, why_);
  ASSERT_TRUE(mesh) << why_;
  ASSERT_EQ(mesh->parts.vertices.size(), 3u);
  double x = 0, y = 0;
  for (const Vector3& v : mesh->parts.vertices) {
    x = std::max(x, v.x());
    y = std::max(y, v.y());
  }
  EXPECT_EQ(x, 2);
  EXPECT_EQ(y, 3);
}

TEST_F(FileReaderTest, AFileThatCrashesTheLibraryIsAnError) {
  EXPECT_FALSE(Read("cut.ply", "ply\nformat binary_little_endian 1.0\n" + kPlyElements));
  EXPECT_THAT(why_, HasSubstr("the library that reads it crashed: the file is damaged"));
  ExpectNextIsRead();
}

TEST_F(FileReaderTest, ATextureBeforeTheFirstMaterialIsAnError) {
  others_["m.mtl"] = "map_Kd wood.png\nnewmtl red\nKd 1 0 0\n";
  EXPECT_FALSE(Read("m.obj", "mtllib m.mtl\n" + kTriangle));
  EXPECT_THAT(why_, HasSubstr("crashed"));
  ExpectNextIsRead();
}

TEST_F(FileReaderTest, AFileThatKeepsTheLibraryBusyIsGivenUp) {
  std::string elements = kPlyElements;
  elements.replace(elements.find("end_header"), 10, "endheader");
  EXPECT_FALSE(Read("endless.ply", "ply\nformat ascii 1.0\n" + elements + kPlyNumbers));
  EXPECT_THAT(why_, HasSubstr("reading it takes more than 1 s of CPU time: simplify it"));
  ExpectNextIsRead();
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they have no memory limit
TEST_F(FileReaderTest, AFileThatTakesMuchMemoryIsGivenUp) {
  EXPECT_FALSE(Read("word.dae", ColladaOf("0 one 2")));
  EXPECT_THAT(why_, HasSubstr("reading it takes more than 512 MiB of memory: simplify it"));
  ExpectNextIsRead();
}
#endif

TEST_F(FileReaderTest, AProcessThatSomebodyEndedIsStartedAgain) {
  ExpectNextIsRead();
  EndHelper();
  ExpectNextIsRead();
}

TEST_F(FileReaderTest, APictureThatIsNoneSaysWhatIsTaken) {
  EXPECT_EQ(reader_.ReadTexture("no picture", why_), nullptr);
  EXPECT_THAT(why_, HasSubstr("pictures are read from .png and .jpg"));
  EXPECT_FALSE(reader_.ReadHeights("no picture", why_));
  ExpectNextIsRead();
}

}  // namespace
}  // namespace coopdyn
