// SPDX-License-Identifier: MIT
// <include merge="true">: the parts of a model become parts of another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

struct MergeAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};
/// A model that includes another with these attributes and elements.
MergeAnswer ReadMerged(const std::string& attributes, const std::string& inside) {
  const TempFolder folder;
  folder.Write("part/model.sdf",
               "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"part\"><link "
               "name=\"body\"><pose>0 0 0.5 0 0 "
               "0</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>"
               "<izz>0.01</izz></inertia></inertial><collision "
               "name=\"c\"><geometry><sphere><radius>0.1</radius></sphere>"
               "</geometry></collision></link><coopdyn:module type=\"compass\"/></model></sdf>");
  const auto file =
      folder.Write("whole/model.sdf",
                   "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"whole\">\n"
                   "<include " +
                       attributes + "><uri>model://part</uri>" + inside +
                       "</include><coopdyn:module type=\"pose\"/></model></sdf>");
  Diagnostics diagnostics;
  MergeAnswer answer;
  answer.robot = ReadRobotModel(file, SearchPath{{folder.path()}}, diagnostics);
  answer.messages = folder.Strip(diagnostics.ToString());
  return answer;
}

TEST(IncludeMergeTest, LinksKeepTheirNamesAndOurElementsCount) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.messages, "");
  EXPECT_EQ(answer.robot->links.at(0).name, "body");
  EXPECT_NE(answer.robot->Find<CompassModel>(), nullptr);
  EXPECT_NE(answer.robot->Find<PoseModel>(), nullptr);
}

TEST(IncludeMergeTest, WithoutItTheyAreAModelInside) {
  const MergeAnswer answer = ReadMerged("", "");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(answer.robot->links.at(0).name, "part::body");
}

TEST(IncludeMergeTest, WithAPoseItIsSaidThatItIsNotUsed) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "<pose>0 0 1 0 0 0</pose>");
  EXPECT_THAT(answer.messages,
              HasSubstr("model.sdf:2: warning: merge of an <include> with <pose> or <static> is not used"));
}

TEST(IncludeMergeTest, ARecordingsTextNeedsNoFiles) {
  const MergeAnswer answer = ReadMerged("merge=\"true\"", "");
  ASSERT_NE(answer.robot, nullptr);
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(answer.robot->text, "whole.sdf", "whole", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->modules().size(), answer.robot->modules().size());
}

}  // namespace
}  // namespace coopdyn
