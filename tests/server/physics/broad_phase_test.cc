// SPDX-License-Identifier: MIT
// The broad phase and the narrow phase's quick rejection miss no contact.
#include "server/physics/broad_phase.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "server/physics/contacts.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {
    auto scenario = std::make_shared<Scenario>();
    for (int i = 0; i < 40; ++i) {
      scenario->objects.push_back({"O", AnyShape(), AnyPose(), i % 2 ? 1.0 : 0.0, {}, 1, {}});
    }
    for (int i = 0; i < 24; ++i) {
      RobotEntry entry;
      entry.model = i % 4 < 2 ? TestRobot() : SmallRobot();
      entry.fidelity = i % 2 == 0 ? Fidelity::kFull : Fidelity::kRolling;
      entry.X_WR = AnyPose();
      scenario->robots.push_back(entry);
    }
    scene = MakeScene(scenario, 1);
    ode = BuildOdeWorld(*scene);
  }
  std::shared_ptr<const Scene> scene;
  std::unique_ptr<OdeWorld> ode;

  BodyState BodyOf(const Owner& owner) const {
    if (owner.one_body == nullptr) return ReadBody(ode->bodies[static_cast<std::size_t>(owner.first_body)]);
    const SceneRobot& robot = scene->robots[static_cast<std::size_t>(owner.robot)];
    const Pose X_WB = robot.entry.X_WR * robot.X_BR.Inverse();
    BodyState state;
    state.p_WB = X_WB.p;
    state.q_WB = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(state.R_WB.data()) = X_WB.q.toRotationMatrix();
    return state;
  }

 private:
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Shape AnyShape() {
    switch (random_() % 3) {
      case 0:
        return Box{Vector3(Uniform(0.05, 2), Uniform(0.05, 0.5), Uniform(0.05, 0.5))};
      case 1:
        return Cylinder{Uniform(0.05, 0.4), Uniform(0.05, 1)};
      default:
        return Sphere{Uniform(0.05, 0.4)};
    }
  }
  Pose AnyPose() {
    const bool upright = random_() % 2 == 0;
    const double tilt = upright ? 0 : Uniform(-1.5, 1.5);
    return {{Uniform(-2, 2), Uniform(-2, 2), Uniform(0, 0.5)},
            FromRollPitchYaw(tilt, upright ? 0 : Uniform(-1, 1), Uniform(-3, 3))};
  }
  std::mt19937 random_;
};

bool Touch(const OdeWorld& ode, const Owner& a, const Owner& b) {
  const auto parts_a = ode.PartsOf(a), parts_b = ode.PartsOf(b);
  for (std::size_t i = 0; i < parts_a.size(); ++i) {
    for (std::size_t j = 0; j < parts_b.size(); ++j) {
      if (Collide({parts_a[i], ode.PlaceOf(a, i)}, {parts_b[j], ode.PlaceOf(b, j)}, 0).count > 0) return true;
    }
  }
  return false;
}

TEST(BroadPhase, EveryContactThatAllPairsFindIsFound) {
  int touching = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    RandomScene random(seed);
    OdeWorld& ode = *random.ode;
    BroadPhase broad_phase(ode);
    const std::size_t dynamic = static_cast<std::size_t>(ode.first_static);
    std::vector<BodyState> bodies;
    for (std::size_t i = 0; i < dynamic; ++i) {
      Owner& owner = ode.owners[i];
      if (owner.robot < 0) continue;
      const BodyState body = random.BodyOf(owner);
      if (owner.one_body != nullptr) ode.TakeSlot(owner, body);
      broad_phase.spaces()[static_cast<std::size_t>(owner.robot)] = SpaceOf(owner, body, 0);
    }
    const auto& list = broad_phase.FindPairs(ode, std::vector<std::uint8_t>(dynamic, 1));
    const std::set<std::pair<std::uint32_t, std::uint32_t>> pairs(list.begin(), list.end());
    EXPECT_EQ(pairs.size(), list.size()) << "a pair came twice";
    for (std::uint32_t a = 0; a < dynamic; ++a) {
      for (std::uint32_t b = a + 1; b < ode.owners.size(); ++b) {
        if (!Touch(ode, ode.owners[a], ode.owners[b])) continue;
        ++touching;
        ASSERT_TRUE(pairs.contains({a, b})) << "seed " << seed << " pair " << a << " " << b;
        std::vector<FoundContact> found;
        FindContacts(ode, ode.owners[a], ode.owners[b], 0, found);
        ASSERT_FALSE(found.empty()) << "quick rejection lost all contacts";
      }
    }
  }
  EXPECT_GT(touching, 300);
}

}  // namespace
}  // namespace coopdyn
