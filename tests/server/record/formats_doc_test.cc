// SPDX-License-Identifier: MIT
// The written files agree with docs/formats.md's description of run files.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include "record_fixture.h"
#include "server/record/run_tables.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

/// The section "Run files" of docs/formats.md.
std::string RunFilesSection() {
  std::ifstream stream(SourceDir() + "/docs/formats.md");
  std::stringstream text;
  text << stream.rdbuf();
  const std::string all = text.str();
  const std::size_t start = all.find("\n## Run files\n");
  EXPECT_NE(start, std::string::npos);
  if (start == std::string::npos) return {};
  return all.substr(start, all.find("\n## ", start + 1) - start);
}

std::string PythonBlock() {
  const std::string section = RunFilesSection(), fence = "```python\n";
  const std::size_t start = section.find(fence);
  EXPECT_NE(start, std::string::npos);
  if (start == std::string::npos) return {};
  const std::size_t code = start + fence.size();
  return section.substr(code, section.find("```", code) - code);
}

/// The output of a Python program.
std::string Python(const std::string& file) {
  std::FILE* output = ::popen(("python3 " + file).c_str(), "r");
  EXPECT_NE(output, nullptr);
  std::string text;
  std::array<char, 4096> buffer{};
  while (const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), output)) {
    text.append(buffer.data(), read);
  }
  EXPECT_EQ(::pclose(output), 0) << text;
  return text;
}

TEST(FormatsDocTest, ThePythonOfTheDocsReadsABodysTrack) {
  TempFolder folder;
  const std::string file = folder.File("lesson1.run");
  FrameMaker maker(RecordScene());
  std::vector<FramePtr> frames;
  const SavedStatePtr start = maker.Start();
  frames.push_back(start->frame);
  const auto writer = MakeWriter(file, *start);
  for (std::uint64_t step = 1; step <= 5; ++step) {
    const auto frame = maker.Make(step);
    frame->bodies[0].p_WB.x() = step < 4 ? -1 : 100;  // then in units of 2 µm
    frames.push_back(frame);
    ASSERT_TRUE(writer->AddStep(*frame));
  }
  std::string remark;
  ASSERT_TRUE(writer->Close(remark));
  const std::string script = folder.File("track.py");
  std::ofstream(script) << PythonBlock() << "\nfor name in ('BOX_1', 'robot3'):\n"
                        << "    for point in track('" << file << "', name):\n"
                        << "        print(*map(repr, point))\n";
  std::istringstream printed(Python(script));
  const std::size_t box = 0, robot = maker.scene()->body_ids.size() - 1;
  for (const std::size_t body : {box, robot}) {
    for (const FramePtr& frame : frames) {
      double time_s = 0;
      Vector3 p;
      ASSERT_TRUE(printed >> time_s >> p.x() >> p.y() >> p.z());
      EXPECT_DOUBLE_EQ(time_s, frame->time_s());
      EXPECT_LE((p - frame->bodies[body].p_WB).cwiseAbs().maxCoeff(), 1.001e-6);
    }
  }
  std::string rest;
  EXPECT_FALSE(printed >> rest) << rest;
}

TEST(FormatsDocTest, EveryTableColumnAndMetaKeyIsDescribed) {
  TempFolder folder;
  const std::string file = folder.File("lesson1.run");
  FrameMaker maker(RecordScene());
  std::string remark;
  ASSERT_TRUE(MakeWriter(file, *maker.Start())->Close(remark));
  std::string error;
  const auto database = Database::Open(file, Database::Access::kReadOnly, error);
  ASSERT_NE(database, nullptr) << error;
  Statement rows = database->Prepare(
      "SELECT m.name, c.name FROM sqlite_schema m, pragma_table_info(m.name) c WHERE m.type = 'table' "
      "UNION ALL SELECT 'meta', key FROM meta");
  const std::string section = RunFilesSection();
  int described = 0;
  while (rows.Step()) {
    const std::string table = rows.text(0), column = rows.text(1);
    const std::size_t start = section.find("\n| `" + table + "` |");
    ASSERT_NE(start, std::string::npos) << table;
    const std::string line = section.substr(start, section.find('\n', start + 1) - start);
    const bool found = line.find("`" + column + "`") != std::string::npos ||
                       line.find("`" + column + " ") != std::string::npos ||
                       line.find(" " + column + "`") != std::string::npos ||
                       line.find(" " + column + " ") != std::string::npos;
    EXPECT_TRUE(found) << table << "." << column;
    ++described;
  }
  EXPECT_GT(described, 50);
}

}  // namespace
}  // namespace coopdyn
