// SPDX-License-Identifier: MIT
// Damaged files: a reader reports errors or returns a sane result, and always returns.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

/// `text` with a few bytes changed, cut, duplicated or replaced by harmful words.
std::string Mutate(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : std::size_t{random()} % n; };
  static const std::vector<std::string> kWords = {"nan",  "inf",  "-1",   "1e308", "1e-320", "0",
                                                  "\n",   "[",    "]",    "=",     ",",      "deg",
                                                  "\xFF", "\x80", "1e99", "\r\n",  "[A_1]",  "#"};
  for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(below(12), text.size() - at);
    switch (below(5)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, text.substr(at, length));
        break;
      case 2:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 3:
        text.insert(at, kWords[below(kWords.size())]);
        break;
      default:
        text.replace(at, length, kWords[below(kWords.size())]);
    }
  }
  return text;
}

bool IsFinite(const Pose& pose) {
  return pose.p.allFinite() && pose.q.coeffs().allFinite();
}

TEST(MutationTest, ScenariosNeverCrashAndStayFinite) {
  std::mt19937 random(1);
  const std::vector<std::string> texts = {
      FileText("scenarios/classroom.scenario"), FileText("scenarios/arena20.scenario"),
      FileText("worlds/cluttered.world"), FileText("tests/server/model/data/paper.scenario"),
      "[FLOOR]\nsize 9 9\n[CRATE]\ntype box\nsize 0.3 0.2 10cm\ncount 12\nmass 1kg\narea 1 1 6 5\nseed 4\n"
      "spacing 0.5\n[SWARM_1]\ntype minibot\ncount 9\nfidelity planar\n[ROBOT_1]\ntype coopbot\n"
      "position 3 3\ncontroller diffuse speed=20cm near=0\n"};
  int good = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto result = Read(Mutate(texts[static_cast<std::size_t>(i) % texts.size()], random), true);
    EXPECT_EQ(result.scenario == nullptr, result.messages.find(": error: ") != std::string::npos);
    if (result.scenario == nullptr) continue;
    ++good;
    for (const RobotEntry& robot : result.scenario->robots) ASSERT_TRUE(IsFinite(robot.X_WR));
    for (const WorldObject& object : result.scenario->objects) {
      ASSERT_TRUE(IsFinite(object.X_WO));
      ASSERT_TRUE(std::isfinite(object.mass_kg) && object.mass_kg >= 0);
      ASSERT_GT(Volume(object.shape), 0);
      ASSERT_TRUE(SolidInertia(object.shape, object.mass_kg).allFinite());
    }
    for (const Target& target : result.scenario->targets) ASSERT_TRUE(target.p_WT.allFinite());
  }
  EXPECT_GT(good, 100);  // otherwise the mutations would be too coarse to get past the tokeniser
}

TEST(MutationTest, RobotModelsNeverCrashAndStayFinite) {
  std::mt19937 random(2);
  const std::vector<std::string> texts = {FileText("robots/coopbot/model.sdf"),
                                          FileText("robots/minibot/model.sdf")};
  const TempFolder folder;
  for (int i = 0; i < 150; ++i) {
    const std::string file =
        folder.Write("robot/model.sdf", Mutate(texts[static_cast<std::size_t>(i) % texts.size()], random));
    Diagnostics diagnostics;
    const auto model = ReadRobotModel(file, SearchPath{}, diagnostics);
    EXPECT_EQ(model == nullptr, diagnostics.has_errors());
    if (model == nullptr) continue;
    if (const auto* neighbours = model->Find<NeighboursModel>()) {
      ASSERT_TRUE(std::isfinite(neighbours->range_m) && std::isfinite(neighbours->message_range_m));
      ASSERT_TRUE(neighbours->loss >= 0 && neighbours->loss <= 1);
    }
    for (const LinkModel& link : model->links) {
      ASSERT_TRUE(IsFinite(link.X_RL) && IsFinite(link.X_LI));
      ASSERT_GT(link.mass_kg, 0);
      ASSERT_TRUE(link.inertia_kg_m2.allFinite() && link.inertia_kg_m2.minCoeff() > 0);
    }
  }
}

}  // namespace
}  // namespace coopdyn
