// SPDX-License-Identifier: MIT
// The joints in the picture of a model.
#include "server/render/joint_marks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

JointModel JointAt(const Vector3& p_R, JointModel::Kind kind = JointModel::Kind::kHinge) {
  JointModel joint;
  joint.name = "joint";
  joint.kind = kind;
  joint.p_RJ = p_R;
  joint.axis_R = Vector3::UnitZ();
  return joint;
}

std::shared_ptr<RobotModel> With(const std::vector<JointModel>& joints) {
  auto model = SampleRobot();
  model->joints = joints;
  model->actuators.clear();
  return model;
}

const Frustum& View() {
  static const Frustum view(Camera{{-3, 0, 2}, {1, 0, 0.2}}, 1280, 720);
  return view;
}

JointMarks MarksOf(const std::shared_ptr<RobotModel>& model) {
  SampleWorld world;
  world.Robot(At(1, 0.5), model);
  return MarkJoints(*world.MakeFrame(), View());
}

TEST(JointMarksTest, ANamePointsAtItsJointWhereTheRobotStands) {
  const Vector3 p_R(0.1, -0.2, 0.3);
  const JointMarks marks = MarksOf(With({JointAt(p_R)}));
  ASSERT_EQ(marks.names.size(), 1u);
  const ProjectedPoint expected = View().Pixel(At(1, 0.5) * p_R);
  EXPECT_NEAR(marks.names[0].at_px[0], expected.x_px, 0.01);
  EXPECT_NEAR(marks.names[0].at_px[1], expected.y_px, 0.01);
  EXPECT_FALSE(marks.arrows.empty());
}

TEST(JointMarksTest, NamesOfJointsInOnePlaceStandBelowEachOtherInThePicture) {
  const JointMarks marks = MarksOf(With(std::vector<JointModel>(20, JointAt({0, 0, 0.2}))));
  ASSERT_EQ(marks.names.size(), 20u);
  for (const JointName& a : marks.names) {
    EXPECT_GT(a.y_px, 0);
    EXPECT_LT(a.y_px, 720);
    for (const JointName& b : marks.names) {
      if (&a == &b || a.x_px != b.x_px) continue;
      EXPECT_GE(std::abs(a.y_px - b.y_px), 20);
    }
  }
}

TEST(JointMarksTest, IfThereIsNoRoomForAllNamesThoseWithMotorsHaveThem) {
  std::vector<JointModel> joints(200, JointAt({0, 0, 0.2}));
  joints.back().name = "driven";
  auto model = With(joints);
  model->actuators.push_back({"arm", {199}, BoardModel{}});
  const JointMarks marks = MarksOf(model);
  EXPECT_LT(marks.names.size(), 60u);
  EXPECT_EQ(std::ranges::count(marks.names, "driven", &JointName::text), 1);
}

TEST(JointMarksTest, TheLegendHasEachTypeThatIsThereOnceInItsColour) {
  using Kind = JointModel::Kind;
  const JointMarks marks =
      MarksOf(With({JointAt({0, 0, 0}), JointAt({0, 0, 1}), JointAt({0, 1, 0}, Kind::kSlider),
                    JointAt({0, 0, 0}, Kind::kForce)}));
  ASSERT_EQ(marks.legend.size(), 2u);
  EXPECT_EQ(marks.legend[0].text, "hinges");
  EXPECT_EQ(marks.legend[1].text, "sliders");
  EXPECT_NE(marks.legend[0].color.r, marks.legend[1].color.r);
  EXPECT_EQ(marks.names.size(), 3u);  // a thruster is not a joint
}

TEST(JointMarksTest, NamesAreAscii) {
  JointModel joint = JointAt({0, 0, 0});
  joint.name = "\xc3\xa4\x1b[2J";
  EXPECT_EQ(MarksOf(With({joint})).names.at(0).text, "???[2J");
}

}  // namespace
}  // namespace coopdyn
