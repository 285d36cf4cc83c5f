// SPDX-License-Identifier: MIT
// The laws of contacts in piles against their numeric derivatives.
#include "server/physics/contact_law.h"

#include <gtest/gtest.h>

#include <random>

namespace coopdyn {
namespace {

class ContactLawTest : public testing::Test {
 protected:
  double Any() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vector3 AnyVector() { return {Any(), Any(), Any()}; }

  /// A law in any state; `is_cone`: of a contact, else of rolling friction.
  ContactLaw Law(bool is_cone) {
    ContactLaw law;
    law.is_cone = is_cone;
    if (is_cone) law.friction = 1 + Any(), law.slip = 0.2 * (1 + Any());
    law.bound = Vector3::Ones() + AnyVector();
    law.target = AnyVector();
    law.hardness = 3 + Any();
    law.rate = AnyVector();
    law.change = AnyVector();
    law.Push();
    return law;
  }
  /// The law's impulse after this change of its rates.
  static Vector3 ImpulseAfter(ContactLaw law, const Vector3& change) {
    law.rate += change;
    law.Push();
    return law.impulse;
  }
  /// −∂impulse/∂rate by differences of the impulses.
  static Matrix3 NumericStiffness(const ContactLaw& law) {
    Matrix3 stiffness;
    for (int i = 0; i < 3; ++i) {
      const Vector3 step = 1e-6 * Vector3::Unit(i);
      stiffness.col(i) = (ImpulseAfter(law, -step) - ImpulseAfter(law, step)) / 2e-6;
    }
    return stiffness;
  }
  static StepSlope SlopeAt(const ContactLaw& law, double share) {
    StepSlope slope;
    LawAlongStep(law).AddTo(slope, share);
    return slope;
  }

  std::mt19937 random_{1};
};

TEST_F(ContactLawTest, TheSlopeAlongAStepIsTheImpulseAgainstTheChange) {
  for (int i = 0; i < 1000; ++i) {
    const ContactLaw law = Law(i % 2 == 0);
    const double share = Any();
    EXPECT_NEAR(SlopeAt(law, share).value, -ImpulseAfter(law, share * law.change).dot(law.change), 1e-12)
        << i;
  }
}

TEST_F(ContactLawTest, TheRiseOfTheSlopeIsItsDerivative) {
  int corners = 0;  // within a difference of which a law changes its state
  for (int i = 0; i < 1000; ++i) {
    const ContactLaw law = Law(i % 2 == 0);
    const double share = Any();
    const double numeric = (SlopeAt(law, share + 1e-6).value - SlopeAt(law, share - 1e-6).value) / 2e-6;
    if (std::abs(SlopeAt(law, share).rise - numeric) > 1e-4) ++corners;
  }
  EXPECT_LE(corners, 2);
}

TEST_F(ContactLawTest, TheSpringsOfAConeAreTheDerivativeOfItsImpulse) {
  int corners = 0, closed = 0;
  for (int i = 0; i < 1000; ++i) {
    const ContactLaw law = Law(true);
    if (law.state == ContactLaw::State::kOpen) continue;
    Matrix3 stiffness = Matrix3::Zero();
    for (const auto& [axis, k] : law.Springs()) stiffness += k * axis * axis.transpose();
    ++closed;
    if ((stiffness - NumericStiffness(law)).norm() > 1e-4) ++corners;
  }
  EXPECT_GT(closed, 300);
  EXPECT_LE(corners, 2);
}

TEST_F(ContactLawTest, TheStiffnessOfABoundedLawIsTheDerivativeOfItsImpulse) {
  int corners = 0;
  for (int i = 0; i < 1000; ++i) {
    const ContactLaw law = Law(false);
    const Matrix3 stiffness = law.Stiffness(false).asDiagonal();
    if ((stiffness - NumericStiffness(law)).norm() > 1e-4) ++corners;
  }
  EXPECT_LE(corners, 2);
}

TEST_F(ContactLawTest, TheSecantStiffnessReachesTheBound) {
  for (int i = 0; i < 1000; ++i) {
    const ContactLaw law = Law(false);
    const Vector3 impulse = law.Stiffness(true).cwiseProduct(law.target - law.rate);
    EXPECT_LT((impulse - law.impulse).norm(), 1e-12) << i;
  }
}

TEST_F(ContactLawTest, ALawWithoutHardnessChangesNothing) {
  ContactLaw law = Law(false);
  law.hardness = 0;
  const StepSlope slope = SlopeAt(law, 0.5);
  EXPECT_EQ(slope.value, 0);
  EXPECT_EQ(slope.rise, 0);
}

}  // namespace
}  // namespace coopdyn
