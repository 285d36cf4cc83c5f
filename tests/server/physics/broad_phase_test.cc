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
    const auto model = TestRobot();
    for (int i = 0; i < 15; ++i) {
      RobotEntry entry;
      entry.model = model;
      entry.X_WR = AnyPose();
      scenario->robots.push_back(entry);
    }
    scene = MakeScene(scenario, 1);
    ode = BuildOdeWorld(*scene);
  }
  std::shared_ptr<const Scene> scene;
  std::unique_ptr<OdeWorld> ode;

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

int ContactsOf(const OdeWorld& ode, const Owner& a, const Owner& b) {
  int contacts = 0;
  for (int i = 0; i < a.part_count; ++i) {
    for (int j = 0; j < b.part_count; ++j) {
      contacts += Collide(ode.parts[static_cast<std::size_t>(a.first_part + i)],
                          ode.parts[static_cast<std::size_t>(b.first_part + j)])
                      .count;
    }
  }
  return contacts;
}

TEST(BroadPhase, EveryContactThatAllPairsFindIsFound) {
  int touching = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    RandomScene random(seed);
    OdeWorld& ode = *random.ode;
    BroadPhase broad_phase(ode);
    const auto& list = broad_phase.FindPairs(ode);
    const std::set<std::pair<std::uint32_t, std::uint32_t>> pairs(list.begin(), list.end());
    EXPECT_EQ(pairs.size(), list.size()) << "a pair came twice";
    for (std::uint32_t a = 0; a < static_cast<std::uint32_t>(ode.first_static); ++a) {
      for (std::uint32_t b = a + 1; b < ode.owners.size(); ++b) {
        const int contacts = ContactsOf(ode, ode.owners[a], ode.owners[b]);
        if (contacts == 0) continue;
        ++touching;
        ASSERT_TRUE(pairs.contains({a, b})) << "seed " << seed << " pair " << a << " " << b;
        ASSERT_GE(AddContacts(ode, ode.owners[a], ode.owners[b]), contacts)
            << "quick rejection lost a contact";
        dJointGroupEmpty(ode.contacts.get());
      }
    }
  }
  EXPECT_GT(touching, 300);
}

}  // namespace
}  // namespace coopdyn
