// SPDX-License-Identifier: MIT
// A recording with a damaged page, for every page: the exported data are correct and complete, or an error
// names the file.
#include <gtest/gtest.h>

#include "export_fixture.h"
#include "server/replay/export_tables.h"
#include "server/replay/verify.h"
#include "tests/server/record/page_damage.h"

namespace coopdyn {
namespace {

class ExportDamageTest : public ExportTest {
 protected:
  void SetUp() override {
    RunToMake make;
    make.steps = 60;
    make.events = {{5, 0.05, "note", "here it is"}, {50, 0.5, "note", "and there"}};
    Record(make);
    bytes_ = Text(run_);
    std::string error;
    const auto reader = RunReader::Open(run_, error);
    Diagnostics diagnostics;
    scenario_ = reader->LoadScenario(Path(), diagnostics);
  }
  std::string Export(const ExportOptions& options = {}) {
    std::string error;
    const auto reader = RunReader::Open(run_, error);
    if (reader == nullptr) return error;
    reader->UseScenario(scenario_);  // reading it each time is slow
    return ExportCsv(*reader, options, File("run.csv"), nullptr);
  }

  const std::string run_ = File("run.run");
  std::string bytes_;
  std::shared_ptr<const Scenario> scenario_;
};

TEST_F(ExportDamageTest, AnExportIsWholeAndRightOrEndsWithAnError) {
  ASSERT_EQ(Export(), "");
  const std::string rows = Text(File("run.csv")), events = Text(File("run-events.csv"));
  int damaged = 0, whole = 0;
  ForEachDamage(bytes_, run_, [&](const std::string& what) {
    for (const char* file : {"run.csv", "run-events.csv"}) std::filesystem::remove(File(file));
    const std::string error = Export();
    if (error.empty()) {
      ++whole;
      EXPECT_TRUE(Text(File("run.csv")) == rows) << what;
      EXPECT_TRUE(Text(File("run-events.csv")) == events) << what;
      return;
    }
    ++damaged;
    EXPECT_NE(error.find(run_), std::string::npos) << what << ": " << error;
    EXPECT_EQ(Files(), std::vector<std::string>{"run.run"}) << what << ": " << error;
  });
  EXPECT_GT(damaged, 100);
  EXPECT_GT(whole, 0);
}

TEST_F(ExportDamageTest, APartOfTheRunIsWholeAndRightOrEndsWithAnError) {
  ExportOptions part;
  part.from_s = 0.2;
  part.until_s = 0.35;
  ASSERT_EQ(Export(part), "");
  const std::string rows = Text(File("run.csv"));
  int whole = 0;
  ForEachDamage(bytes_, run_, [&](const std::string& what) {
    for (const char* file : {"run.csv", "run-events.csv"}) std::filesystem::remove(File(file));
    if (!Export(part).empty()) return;
    ++whole;
    EXPECT_TRUE(Text(File("run.csv")) == rows) << what;
  });
  EXPECT_GT(whole, 20) << "damage in other parts does no harm";
}

TEST_F(ExportDamageTest, VerifyNeverCallsADamagedFileEqual) {
  SteadyClock clock;
  WorkerPool pool(1);
  const Logger logger = NullLogger();
  const ReplayServices services{clock, logger, pool, {}, Path()};
  const auto verify = [&] {
    std::string error;
    const auto reader = RunReader::Open(run_, error);
    return reader == nullptr ? error : ToString(Verify(*reader, services, nullptr));
  };
  const std::string equal = verify();
  ASSERT_EQ(equal.rfind("equal, 60 steps", 0), 0U) << equal;
  ForEachDamage(bytes_, run_, [&](const std::string& what) {
    const std::string said = verify();
    if (said.rfind("equal", 0) == 0) {
      EXPECT_EQ(said, equal) << what;
    }
  });
}

}  // namespace
}  // namespace coopdyn
