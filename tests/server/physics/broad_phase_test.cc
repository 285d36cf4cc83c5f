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
    scene = MakeScene(scenario);
    things = MakeThings(*scene);
  }
  std::shared_ptr<const Scene> scene;
  Things things;

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

bool Touch(Collider& collider, const Actor& a, const Actor& b) {
  for (std::size_t i = 0; i < a.parts().size(); ++i) {
    for (std::size_t j = 0; j < b.parts().size(); ++j) {
      if (Collide(collider, a.Place(i), b.Place(j), 0).count > 0) return true;
    }
  }
  return false;
}

TEST(BroadPhase, EveryContactThatAllPairsFindIsFound) {
  int touching = 0;
  Collider collider;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const RandomScene random(seed);
    const Things& things = random.things;
    BroadPhase broad_phase(things, things.bodies);
    for (std::size_t i = things.first_robot; i < things.first_static; ++i) {
      const Actor actor = things.ActorOf(i, things.bodies);
      broad_phase.spaces()[i - things.first_robot] = SpaceOf(actor.thing, *actor.bodies, 0);
    }
    const auto& list = broad_phase.FindPairs(std::vector<std::uint8_t>(things.first_static, 1));
    const std::set<std::pair<std::uint32_t, std::uint32_t>> pairs(list.begin(), list.end());
    EXPECT_EQ(pairs.size(), list.size()) << "a pair came twice";
    for (std::uint32_t a = 0; a < things.first_static; ++a) {
      for (std::uint32_t b = a + 1; b < things.all.size(); ++b) {
        const Actor actor_a = things.ActorOf(a, things.bodies), actor_b = things.ActorOf(b, things.bodies);
        if (!Touch(collider, actor_a, actor_b)) continue;
        ++touching;
        ASSERT_TRUE(pairs.contains({a, b})) << "seed " << seed << " pair " << a << " " << b;
        std::vector<FoundContact> found;
        FindContacts(collider, actor_a, actor_b, 0, found);
        ASSERT_FALSE(found.empty()) << "quick rejection lost all contacts";
      }
    }
  }
  EXPECT_GT(touching, 300);
}

}  // namespace
}  // namespace coopdyn
