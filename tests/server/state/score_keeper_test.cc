// SPDX-License-Identifier: MIT
// Scores of runs with hand-made frames, against values computed by hand.
#include "server/state/score_keeper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/state/world_change.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

constexpr double kTolerance = 1e-12;

/// Two robots and a ball, placed by hand, step by step.
class ScoreKeeperTest : public testing::Test {
 protected:
  /// Begins a run with these scores (without their heads).
  void Begin(const std::vector<std::string>& scores) {
    std::string text =
        "[FLOOR]\nsize 10 10\n[BALL]\ntype sphere\nsize 0.2\nposition 0 4\nmass 1\n[WALL_1]\ntype box\nsize "
        "0.2 8 1\n"
        "position 4 0\n[TARGET]\nred 2 0\n[ROBOT_1]\ntype minibot\nname ana\nposition 0 0\nfidelity "
        "rolling\n[ROBOT_2]\ntype "
        "minibot\nname eva\nposition 0 2\nfidelity rolling\n";
    for (std::size_t i = 0; i < scores.size(); ++i)
      text += "[SCORE_" + std::to_string(i + 1) + "]\n" + scores[i] + "\n";
    scene_ = MakeScene(Good(text));
    frame_ = Make(0);
    keeper_.Begin(*frame_);
  }
  std::shared_ptr<Frame> Make(std::uint64_t step) {
    auto frame = std::make_shared<Frame>();
    frame->scene = scene_;
    frame->step = step;
    frame->time = static_cast<Nanoseconds>(step) * 100'000'000;
    frame->step_length = 100'000'000;
    frame->bodies.resize(scene_->body_ids.size());
    frame->channels.resize(scene_->channels.size());
    Put(*frame, 0, robots_[0]);
    Put(*frame, 1, robots_[1]);
    Write(*frame, scene_->objects[0].body, ball_);
    return frame;
  }
  void Step() {
    frame_ = Make(frame_->step + 1);
    frame_->contacts = contacts_;
    keeper_.AddTo(*frame_);
  }
  double Value(std::size_t score = 0) const { return frame_->scores.at(score).value; }
  int radius_index() const { return 0; }
  double radius_m() const { return scene_->robots[0].entry.model->footprint_radius_m; }

  static void Write(Frame& frame, int body, const Pose& X_WB) {
    BodyState& state = frame.bodies[static_cast<std::size_t>(body)];
    state.p_WB = X_WB.p;
    state.q_WB = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = X_WB.q.toRotationMatrix();
    std::copy(R.data(), R.data() + 9, state.R_WB.begin());
  }
  void Put(Frame& frame, std::size_t robot, const Pose& X_WR) const {
    const SceneRobot& of = scene_->robots[robot];
    Write(frame, of.first_body, X_WR * of.X_BR.Inverse());
  }

  std::shared_ptr<const Scene> scene_;
  std::array<Pose, 2> robots_ = {Pose{Vector3(0, 0, 0)}, Pose{Vector3(0, 2, 0)}};
  Pose ball_{Vector3(0, 4, 0.1)};
  std::vector<Contact> contacts_;
  std::shared_ptr<Frame> frame_;
  ScoreKeeper keeper_;
};

TEST_F(ScoreKeeperTest, WithoutScoresThereAreNone) {
  Begin({});
  Step();
  EXPECT_TRUE(frame_->scores.empty());
  EXPECT_TRUE(keeper_.Save().empty());
}

TEST_F(ScoreKeeperTest, ReachCountsWhoHasBeenThere) {
  Begin({"kind reach\ntarget red\nwithin 0.5\nuntil all"});
  EXPECT_EQ(Value(), 0);
  robots_[0].p.x() = 1.5;
  Step();
  EXPECT_EQ(Value(), 1);
  EXPECT_FALSE(frame_->scores[0].met);
  robots_[0].p.x() = 0;  // it has been there before
  robots_[1].p = Vector3(2, 0.51, 0);
  Step();
  EXPECT_EQ(Value(), 1);
  robots_[1].p = Vector3(2, 0.5, 0);
  Step();
  EXPECT_EQ(Value(), 2);
  EXPECT_TRUE(frame_->scores[0].met);
  EXPECT_EQ(EndingScore(*frame_), 0);
}

TEST_F(ScoreKeeperTest, ReachKnowsLights) {
  Begin({"kind reach\ntarget light_1\n[LIGHT_1]\nposition 3 0 2"});
  robots_[0].p = Vector3(2, 0, 0);
  Step();
  EXPECT_EQ(Value(), 0);
  robots_[0].p = Vector3(2.8, 0, 0);
  Step();
  EXPECT_EQ(Value(), 1);
}

TEST_F(ScoreKeeperTest, ALinkCountsByItsOwnPlace) {
  Begin({"kind travelled\nof ana", "name wheel\nkind travelled\nof ana/left_wheel"});
  robots_[0] = {Vector3(1, 0, 0), FromRollPitchYaw(0, 0, M_PI / 2)};
  Step();
  const RobotModel& model = *scene_->robots[0].entry.model;
  const auto wheel = std::ranges::find(model.frames, "left_wheel", &FrameModel::name);
  ASSERT_NE(wheel, model.frames.end());
  EXPECT_NEAR(Value(0), 1, kTolerance);
  EXPECT_NEAR(Value(1), 1 - wheel->X_RF.p.y() - wheel->X_RF.p.x(), kTolerance);
}

TEST_F(ScoreKeeperTest, AThingReachesAThing) {
  Begin({"kind reach\nof BALL\ntarget wall_1\nwithin 1\nuntil >= 1"});
  ball_.p = Vector3(3.2, 0, 0.1);
  Step();
  EXPECT_EQ(Value(), 1);
}

TEST_F(ScoreKeeperTest, TimeIsThatOfTheRun) {
  Begin({"kind time\nuntil >= 0.3"});
  Step();
  Step();
  EXPECT_EQ(EndingScore(*frame_), -1);
  Step();
  EXPECT_NEAR(Value(), 0.3, kTolerance);
  EXPECT_EQ(EndingScore(*frame_), 0);
}

TEST_F(ScoreKeeperTest, DistanceIsTheMeanPath) {
  Begin({"kind distance", "kind distance\nname of_ana\nof ana"});
  robots_[0].p = Vector3(0.3, 0.4, 0);
  Step();
  robots_[0].p = Vector3(0, 0, 0);
  Step();
  EXPECT_NEAR(Value(0), 0.5, kTolerance);
  EXPECT_NEAR(Value(1), 1, kTolerance);
}

TEST_F(ScoreKeeperTest, TravelledIsTheMeanWayAlongX) {
  Begin({"kind travelled"});
  robots_[0].p = Vector3(3, 1, 0);
  robots_[1].p = Vector3(-1, 5, 0);
  Step();
  EXPECT_NEAR(Value(), 1, kTolerance);
}

TEST_F(ScoreKeeperTest, CollisionsCountBeginningsButNotTheFloor) {
  Begin({"kind collisions\nof ana"});
  EXPECT_TRUE(scene_->measures_contacts);
  Contact wall, floor, others;
  wall.a.robot = 0;
  wall.b.object = 1;
  floor.a.robot = 0;
  others.a.robot = 1;
  others.b.object = 0;
  contacts_ = {wall, wall, floor, others};  // two points of one contact
  Step();
  EXPECT_EQ(Value(), 1);
  Step();
  EXPECT_EQ(Value(), 1) << "it goes on";
  contacts_ = {floor};
  Step();
  contacts_ = {wall};
  Step();
  EXPECT_EQ(Value(), 2);
}

TEST_F(ScoreKeeperTest, NearestIsTheLeastDistanceSoFar) {
  Begin({"kind nearest\nof ana"});
  EXPECT_NEAR(Value(), 2 - 2 * radius_m(), kTolerance) << "to eva";
  robots_[0].p.x() = 3;
  Step();
  EXPECT_NEAR(Value(), 0.9 - radius_m(), kTolerance) << "to the wall";
  robots_[0].p.x() = 0;
  Step();
  EXPECT_NEAR(Value(), 0.9 - radius_m(), kTolerance) << "so far";
}

TEST_F(ScoreKeeperTest, EnergyIsWhatMotorsTurnOver) {
  Begin({"kind energy"});
  frame_ = Make(1);
  for (ChannelState& channel : frame_->channels) {
    channel.effort = -0.5;
    channel.velocity = 4;
  }
  keeper_.AddTo(*frame_);
  EXPECT_NEAR(Value(), 2 * 0.1 * static_cast<double>(scene_->channels.size()), kTolerance);
}

TEST_F(ScoreKeeperTest, UprightLosesWhoHasFallen) {
  Begin({"kind upright\ntilt 30deg\nuntil all"});
  EXPECT_EQ(Value(), 2);
  robots_[0].q = FromRollPitchYaw(0.6, 0, 1);
  Step();
  EXPECT_EQ(Value(), 1);
  robots_[0].q = Quaternion::Identity();
  Step();
  EXPECT_EQ(Value(), 1) << "it has fallen once";
  EXPECT_FALSE(frame_->scores[0].met);
  robots_[1].q = FromRollPitchYaw(0, -0.6, 0);
  Step();
  EXPECT_TRUE(frame_->scores[0].met) << "all have fallen";
}

TEST_F(ScoreKeeperTest, FormationIsHowFarTheShapeHasChanged) {
  Begin({"kind formation\nof ana eva BALL"});
  for (Pose* pose : {&robots_[0], &robots_[1], &ball_}) pose->p += Vector3(1, -1, 0);  // together
  Step();
  EXPECT_NEAR(Value(), 0, kTolerance);
  robots_[0].p.y() -= 0.3;  // from both others
  Step();
  EXPECT_NEAR(Value(), std::sqrt(2 * 0.09 / 3), 1e-9);
}

TEST_F(ScoreKeeperTest, CoverageIsTheAreaOfCells) {
  Begin({"kind coverage\ncell 0.5"});
  EXPECT_NEAR(Value(), 2 * 0.25, kTolerance);
  robots_[0].p.x() = 0.6;
  Step();
  robots_[0].p.x() = 0;
  Step();
  EXPECT_NEAR(Value(), 3 * 0.25, kTolerance);
  robots_[0].p.x() = 50;  // beside the floor
  Step();
  EXPECT_NEAR(Value(), 3 * 0.25, kTolerance);
}

TEST_F(ScoreKeeperTest, ALimitEndsTheRunUnmet) {
  Begin({"kind reach\ntarget red\nuntil all\nlimit 0.2"});
  Step();
  EXPECT_EQ(EndingScore(*frame_), -1);
  Step();
  EXPECT_EQ(EndingScore(*frame_), 0);
  EXPECT_FALSE(frame_->scores[0].met);
}

TEST_F(ScoreKeeperTest, WhatHoldsAtTheStartDoesNotEndARunAtOnce) {
  Begin({"kind collisions\nuntil < 1"});
  EXPECT_EQ(EndingScore(*frame_), -1);
  Step();
  EXPECT_EQ(EndingScore(*frame_), 0);
}

TEST_F(ScoreKeeperTest, WhatWasSavedGoesOnExactly) {
  Begin({"kind reach\ntarget red\nwithin 0.5", "kind distance", "kind nearest", "kind coverage",
         "kind formation", "kind collisions", "kind travelled", "kind upright"});
  robots_[0].p = Vector3(1.7, 0.1, 0);
  Contact touch;
  touch.a.robot = 0;
  touch.b.object = 0;
  contacts_ = {touch};
  Step();
  const std::vector<double> saved = keeper_.Save();
  const std::shared_ptr<Frame> then = frame_;
  const auto go_on = [this] {
    robots_[0].p = Vector3(-1, 0.3, 0);
    robots_[1].q = FromRollPitchYaw(1, 0, 0);
    Step();
    std::vector<double> values;
    for (const Score& score : frame_->scores) values.push_back(score.value);
    return values;
  };
  const std::vector<double> wanted = go_on();
  robots_ = {Pose{Vector3(1.7, 0.1, 0)}, Pose{Vector3(0, 2, 0)}};
  frame_ = Make(1);
  ScoreKeeper other;
  std::swap(keeper_, other);
  ASSERT_TRUE(keeper_.Restore(*frame_, saved));
  for (std::size_t i = 0; i < then->scores.size(); ++i)
    EXPECT_EQ(frame_->scores[i].value, then->scores[i].value) << i;
  EXPECT_EQ(go_on(), wanted);
}

TEST_F(ScoreKeeperTest, WhatDoesNotFitBeginsAnew) {
  Begin({"kind coverage", "kind distance"});
  Step();
  const std::vector<double> saved = keeper_.Save();
  for (std::size_t n = 0; n < saved.size(); ++n) {
    EXPECT_FALSE(keeper_.Restore(*frame_, std::span(saved).first(n))) << n;
    EXPECT_EQ(frame_->scores.size(), 2u);
  }
  for (const double wrong : {-1.0, 1e300, std::nan("")}) {
    std::vector<double> bad = saved;
    bad[1] = wrong;
    EXPECT_FALSE(keeper_.Restore(*frame_, bad));
  }
}

TEST_F(ScoreKeeperTest, WhoComesAndGoesByEditsIsKnownByItsId) {
  Begin({"kind distance", "kind reach\ntarget red\nwithin 0.5"});
  robots_[1].p = Vector3(2, 0, 0);
  Step();
  WorldChange change;
  change.gone_robots = {scene_->robots[0].id};
  std::string refusal;
  scene_ = ChangedScene(*scene_, change, refusal);
  ASSERT_NE(scene_, nullptr) << refusal;
  const std::shared_ptr<Frame> now = InScene(*frame_, scene_);
  keeper_.Refit(*now);
  EXPECT_NEAR(now->scores[0].value, std::hypot(2.0, 2.0), kTolerance) << "eva alone";
  EXPECT_EQ(now->scores[1].value, 1);
}

struct WrongScore {
  const char* text;
  const char* said;
};

class WrongScoreTest : public testing::TestWithParam<WrongScore> {};

TEST_P(WrongScoreTest, IsToldWithWhatToWrite) {
  const ReadResult read =
      Read("[TARGET]\nred 2 0\n[ROBOT_1]\ntype minibot\nname ana\nposition 0 0\n[SCORE_1]\n" +
           std::string(GetParam().text) + "\n");
  EXPECT_EQ(read.scenario, nullptr);
  EXPECT_NE(read.messages.find(GetParam().said), std::string::npos) << read.messages;
}

INSTANTIATE_TEST_SUITE_P(
    , WrongScoreTest,
    testing::Values(
        WrongScore{"name a", "[SCORE_1] needs 'kind', for example: kind reach"},
        WrongScore{"kind distanze", "'kind' cannot be 'distanze'; did you mean 'distance'?"},
        WrongScore{"kind reach", "[SCORE_1] needs 'target', for example: target red"},
        WrongScore{"kind reach\ntarget rde",
                   "goes to 'rde', which is no target, thing or light; did you mean 'red'?"},
        WrongScore{"kind distance\nof anna",
                   "is of 'anna', which is not a robot, swarm or thing; did you mean 'ana'?"},
        WrongScore{"kind distance\nof ana/left_weel", "did you mean 'ana/left_wheel'?"},
        WrongScore{"kind distance\nof ana ana/left_wheel", "names 'ana' twice: leave one out"},
        WrongScore{"kind distance\ntarget red", "'target' goes with 'kind reach' only: leave it out"},
        WrongScore{"kind distance\nuntil 3", "'until' begins with <, <=, > or >=, or is 'all', not '3'"},
        WrongScore{"kind distance\nuntil > x", "'until': 'x' is not a number"},
        WrongScore{"kind distance\nuntil all", "'until all' goes with 'kind reach' and 'kind upright' only"},
        WrongScore{"kind distance\nlimit 0", "'limit' must be above 0 s"},
        WrongScore{"kind formation", "'kind formation' is of 2 to 100 robots, not of 1"},
        WrongScore{"kind time\nname 3x", "a score's name is a letter, then letters, digits and _"},
        WrongScore{"kind time\n[SCORE_2]\nkind time", "two scores are called 'time'"}));

}  // namespace
}  // namespace coopdyn
