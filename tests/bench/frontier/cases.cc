// SPDX-License-Identifier: MIT
#include "tests/bench/frontier/cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace coopdyn::frontier {
namespace {

using std::numbers::pi;
constexpr double kG = 9.81;  // m/s²

double Energy_j(const Setup& setup, const std::vector<Motion>& motions) {
  double sum_j = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Body& body = setup.bodies[i];
    const Vector3 w_B = motions[i].q_W.conjugate() * motions[i].w_W;
    sum_j += body.mass_kg * (setup.gravity_m_s2 * motions[i].p_W.z() + motions[i].v_W.squaredNorm() / 2) +
             w_B.dot(InertiaOf(body).cwiseProduct(w_B)) / 2;
  }
  return sum_j;
}

/// The greatest deviation of the energy, averaged over a second, from that at the start; % of `span_j`.
double EnergyError(const Setup& setup, const Film& film, double span_j) {
  const auto second = static_cast<std::size_t>(1 / kSample_s);
  const double start_j = Energy_j(setup, film[0]);
  double worst_j = 0;
  for (std::size_t at = 1; at + second <= film.size(); at += second) {
    double sum_j = 0;
    for (std::size_t i = at; i < at + second; ++i) sum_j += Energy_j(setup, film[i]);
    const double error_j = std::abs(sum_j / static_cast<double>(second) - start_j);
    if (!(error_j <= worst_j)) worst_j = error_j;  // nan, too
  }
  return 100 * worst_j / span_j;
}

Vector3 Spin(const Body& body, const Motion& motion) {
  return motion.q_W * InertiaOf(body).cwiseProduct(motion.q_W.conjugate() * motion.w_W);
}

/// A horizontal chain of limp links with a total of 2.4 m and 1.2 kg.
Setup Chain(int links, double damping = 0) {
  Setup setup;
  const double length_m = 2.4 / links, mass_kg = 1.2 / links;
  for (int i = 0; i < links; ++i) {
    Body body{.X_W = {{(i + 0.5) * length_m, 0, 3}, Quaternion::Identity()}, .mass_kg = mass_kg};
    body.inertia_kg_m2 = Vector3::Constant(mass_kg * length_m * length_m / 12);
    setup.bodies.push_back(body);
    setup.joints.push_back({.parent = i - 1, .p_W = {i * length_m, 0, 3}, .damping = damping});
  }
  return setup;
}

Case ChainEnergy(const char* name, const char* title, int links, double duration_s) {
  const Setup setup = Chain(links);
  return {name, title, "% of energy", 0.01, duration_s, setup, [setup](const Film& film) {
            return EnergyError(setup, film, 1.2 * kG * 1.2);
          }};
}

/// The final position of the last link, compared with MuJoCo's RK4 in steps of 20 µs, or 100 for 50 links.
/// All engines converge to it for small steps.
Case ChainPath(const char* name, const char* title, const Setup& setup, double duration_s,
               const Vector3& end_W) {
  return {name, title, "mm of the end's way", 0.01, duration_s, setup, [end_W](const Film& film) {
            return 1000 * (film.back().back().p_W - end_W).norm();
          }};
}

Case TumblingBox() {
  Body box{Box{{0.1, 0.2, 0.4}}, {{0, 0, 3}, Quaternion::Identity()}, 2};
  box.w_W = 20 * Vector3(0.1, 0.9, 0.3).normalized();
  const Setup setup{.bodies = {box}, .gravity_m_s2 = 0};
  return {"tumbling_box",
          "Box, 20 rad/s, 12 s",
          "% of energy or spin",
          0.01,
          12,
          setup,
          [setup](const Film& film) {
            const Body& of = setup.bodies[0];
            const Vector3 before = Spin(of, film.front()[0]), after = Spin(of, film.back()[0]);
            return std::max(EnergyError(setup, film, Energy_j(setup, film[0])),
                            100 * (after - before).norm() / before.norm());
          }};
}

Case TumblingRobot() {
  Setup setup{.gravity_m_s2 = 0};
  const auto add = [&](const Vector3& p_W, double mass_kg, const Vector3& inertia_kg_m2) {
    Body body{.X_W = {p_W, Quaternion::Identity()}, .mass_kg = mass_kg};
    body.inertia_kg_m2 = inertia_kg_m2;
    setup.bodies.push_back(body);
  };
  add({0, 0, 3}, 1, {0.01, 0.02, 0.03});
  add({0.3, 0, 3.1}, 0.5, Vector3::Constant(0.004));
  add({0.3, 0.2, 3.1}, 0.2, Vector3::Constant(0.001));
  setup.joints = {{Joint::Kind::kFree},
                  {.parent = 0, .p_W = {0.1, 0, 3}},
                  {.parent = 1, .p_W = {0.3, 0.1, 3.1}, .axis_W = Vector3::UnitX()}};
  Vector3 middle_W = Vector3::Zero();
  for (const Body& body : setup.bodies) middle_W += body.mass_kg / 1.7 * body.X_W.p;
  for (Body& body : setup.bodies) {
    body.w_W = {3, 18, 8};
    body.v_W = body.w_W.cross(body.X_W.p - middle_W);
  }
  return {"tumbling_robot",
          "Two limp limbs, 20 rad/s, 30 s",
          "% of energy",
          0.01,
          30,
          setup,
          [setup](const Film& film) { return EnergyError(setup, film, Energy_j(setup, film[0])); }};
}

Case Gyroscope() {
  constexpr double kSpin_rad_s = 100, kRate_rad_s = kG * 0.1 / (0.0025 * kSpin_rad_s);
  Body disc{.X_W = {{0.1, 0, 3}, Quaternion::Identity()}, .mass_kg = 1};
  disc.inertia_kg_m2 = {0.0025, 0.00125, 0.00125};
  disc.w_W = {kSpin_rad_s, 0, kRate_rad_s};
  disc.v_W = disc.w_W.cross(Vector3(0.1, 0, 0));
  const Setup setup{{disc}, {{.kind = Joint::Kind::kBall, .p_W = {0, 0, 3}}}};
  return {
      "gyroscope", "Gyroscope, 100 rad/s, 10 s", "% of precession", 0.01, 10, setup, [](const Film& film) {
        double angle_rad = 0, last_rad = 0;
        for (const auto& motions : film) {
          const double now_rad = std::atan2(motions[0].p_W.y(), motions[0].p_W.x());
          angle_rad += std::remainder(now_rad - std::exchange(last_rad, now_rad), 2 * pi);
        }
        return 100 * std::abs(angle_rad / 10 / kRate_rad_s - 1);
      }};
}

Case Thrown() {
  Body box{Box{{0.1, 0.2, 0.4}}, {{0, 0, 3}, Quaternion::Identity()}, 2};
  box.v_W = {1, 2, 60};
  return {"parabola", "Thrown box, 12 s", "mm", 0.01, 12, {.bodies = {box}}, [](const Film& film) {
            return 1000 * (film.back()[0].p_W - Vector3(12, 24, 3 + 60 * 12 - kG * 72)).norm();
          }};
}

/// 2 kg on a rail, 0.1 m from rest.
Setup Spring(double damping_ratio) {
  Body body{.X_W = {{0, 0, 3}, Quaternion::Identity()}, .mass_kg = 2};
  body.inertia_kg_m2 = Vector3::Constant(0.01);
  const double rate_rad_s = 2 * pi;
  return {{body},
          {{.kind = Joint::Kind::kSlider,
            .p_W = {0, 0, 3},
            .axis_W = Vector3::UnitX(),
            .stiffness = 2 * rate_rad_s * rate_rad_s,
            .damping = 2 * damping_ratio * 2 * rate_rad_s,
            .rest = 0.1}}};
}

std::vector<Case> Springs() {
  const auto amplitude = [](const Film& film) {
    double sum_m = 0;
    for (std::size_t i = film.size() - 100; i < film.size(); ++i) {
      sum_m += std::hypot(film[i][0].p_W.x() - 0.1, film[i][0].v_W.x() / (2 * pi)) / 100;
    }
    return 100 * std::abs(sum_m / 0.1 - 1);
  };
  const auto way = [](const Film& film) {
    constexpr double kZeta = 0.1, kRate_rad_s = 2 * pi;
    const double damped_rad_s = kRate_rad_s * std::sqrt(1 - kZeta * kZeta);
    double worst_m = 0;
    for (std::size_t i = 0; i < film.size(); ++i) {
      const double t_s = static_cast<double>(i) * kSample_s;
      const double exact_m = 0.1 - 0.1 * std::exp(-kZeta * kRate_rad_s * t_s) *
                                       (std::cos(damped_rad_s * t_s) +
                                        kZeta * kRate_rad_s / damped_rad_s * std::sin(damped_rad_s * t_s));
      worst_m = std::max(worst_m, std::abs(film[i][0].p_W.x() - exact_m));
    }
    return 100 * worst_m / 0.1;
  };
  return {{"spring", "Spring of 1 Hz, 20 s", "% of amplitude", 0.01, 20, Spring(0), amplitude},
          {"damped_spring", "Spring, damped by 0.1, 3 s", "% of the way", 0.01, 3, Spring(0.1), way}};
}

/// Seven hinges with springs and dampers that move by half a radian.
Case Arm() {
  Setup setup;
  for (int i = 0; i < 7; ++i) {
    const double mass_kg = 2 - 0.25 * i;
    Body body{Box{{0.06, 0.06, 0.15}}, {{0, 0, 1 + 0.15 * (i + 0.5)}, Quaternion::Identity()}, mass_kg};
    setup.bodies.push_back(body);
    setup.joints.push_back({.parent = i - 1,
                            .p_W = {0, 0, 1 + 0.15 * i},
                            .axis_W = i % 2 == 0 ? Vector3::UnitZ() : Vector3::UnitY(),
                            .stiffness = 200.0 - 25 * i,
                            .damping = 8.0 - i,
                            .rest = 0.5});
  }
  return {"arm", "Arm of 7 joints on springs, 1 s", "mm", 0.01, 1, setup, [](const Film& film) {
            // By MuJoCo's RK4 in steps of 20 µs; all engines converge to these for small steps.
            const Vector3 early_W(0.472716045, 0.496387266, 1.455410697),
                end_W(0.445508345, 0.482390132, 1.513495722);
            return 1000 *
                   std::max((film[20].back().p_W - early_W).norm(), (film.back().back().p_W - end_W).norm());
          }};
}

/// On a slope of `angle_rad` that falls towards +x.
struct Slope {
  Slope(double angle_rad, const Vector3& size_m, double mass_kg, double friction, bool ball)
      : q(FromRollPitchYaw(0, angle_rad, 0)),
        start_W(Vector3(0, 0, 6) + q * Vector3(-6, 0, 0.1 + size_m.z() / 2)) {
    const Shape shape = ball ? Shape(Sphere{size_m.z() / 2}) : Shape(Box{size_m});
    setup.bodies = {{shape, {start_W, q}, mass_kg, friction}, {Box{{16, 2, 0.2}}, {{0, 0, 6}, q}}};
  }
  Quaternion q;
  Vector3 start_W;
  Setup setup;
};

std::vector<Case> Slopes() {
  const double steep_rad = pi / 6;
  const Slope slide(steep_rad, {0.3, 0.3, 0.1}, 1, 0.3, false),
      stand(steep_rad, {0.3, 0.3, 0.1}, 10, 0.7, false), roll(0.2, {0.2, 0.2, 0.2}, 2, 1, true);
  return {
      {"slide", "Slide down 30°, friction 0.3, 2 s", "% of speed", 0.01, 2, slide.setup,
       [=](const Film& film) {
         const double exact_m_s = 2 * kG * (std::sin(steep_rad) - 0.3 * std::cos(steep_rad));
         return 100 * std::abs((slide.q.conjugate() * film.back()[0].v_W).x() / exact_m_s - 1);
       }},
      {"stand", "Box on 30°, friction 0.7, 30 s", "mm of creep", 0.01, 31, stand.setup,
       [](const Film& film) { return 1000 * (film.back()[0].p_W - film[100][0].p_W).norm(); }},
      {"roll", "Ball rolls down 0.2 rad, 2 s", "% of the way", 0.01, 2, roll.setup, [=](const Film& film) {
         const double exact_m = 5.0 / 7 * kG * std::sin(0.2) * 2;
         return 100 * std::abs((roll.q.conjugate() * (film.back()[0].p_W - roll.start_W)).x() / exact_m - 1);
       }}};
}

Case Skid() {
  Body box{Box{{0.3, 0.3, 0.1}}, {{0, 0, 0.05}, Quaternion::Identity()}, 1, 0.4};
  box.v_W = 2 * Vector3(std::cos(pi / 8), std::sin(pi / 8), 0);
  const Vector3 stop_W = box.v_W * 2 / (2 * 0.4 * kG);
  return {"skid",
          "Box skids at 22.5° until it stops",
          "% of the way",
          0.01,
          1,
          {.bodies = {box}},
          [stop_W](const Film& film) {
            const Vector3 off_W = film.back()[0].p_W - stop_W;
            return 100 * off_W.head<2>().norm() / stop_W.norm();
          }};
}

/// The greatest displacement of any body since film[from].
double WorstShift_mm(const Film& film, std::size_t from) {
  double worst_m = 0;
  for (std::size_t i = 0; i < film[0].size(); ++i) {
    const double shift_m = (film.back()[i].p_W - film[from][i].p_W).norm();
    if (!(shift_m <= worst_m)) worst_m = shift_m;  // nan, too
  }
  return 1000 * worst_m;
}

Case Stack(const char* name, const char* title, const char* unit, const std::vector<double>& masses_kg,
           int duration_s, std::size_t from) {
  Setup setup;
  for (const double mass_kg : masses_kg) {
    const double z_m = 0.1 + 0.2 * static_cast<double>(setup.bodies.size());
    setup.bodies.push_back({Box{{0.2, 0.2, 0.2}}, {{0, 0, z_m}, Quaternion::Identity()}, mass_kg});
  }
  return {name, title, unit, 0.01, static_cast<double>(duration_s), setup, [from](const Film& film) {
            return WorstShift_mm(film, from);
          }};
}

/// Balls of 1 cm at three speeds and six phases of their step, and a wall of 1 cm.
Case Wall() {
  Setup setup{.fast = true};
  for (int ball = 0; ball < 18; ++ball) {
    const double speed_m_s = std::vector{5.0, 20.0, 50.0}[static_cast<std::size_t>(ball / 6)];
    const double start_m = -0.2 - 0.01 * speed_m_s * (ball % 6) / 6;
    Body body{Sphere{0.005}, {{start_m, 0.3 * (ball - 8.5), 1}, Quaternion::Identity()}, 0.01};
    body.v_W = {speed_m_s, 0.5, 0.2};
    setup.bodies.push_back(body);
  }
  setup.bodies.push_back({Box{{0.01, 8, 4}}, {{0, 0, 2}, Quaternion::Identity()}});
  return {"wall", "1 cm balls, 5 to 50 m/s, 1 cm wall", "% go through", 1, 0.3, setup, [](const Film& film) {
            double through = 0;
            for (std::size_t i = 0; i < 18; ++i) through += film.back()[i].p_W.x() < 0 ? 0 : 1;
            return 100 * through / 18;
          }};
}

/// 100 things dropped from a small height, none of which comes to rest in time.
Setup Pile(const Shape& shape) {
  Setup setup;
  for (int i = 0; i < 100; ++i) {
    const Vector3 p_W(0.32 * (i % 5) + 0.02 * (i / 25), 0.32 * (i / 5 % 5), 0.15 + 0.26 * (i / 25));
    setup.bodies.push_back({shape, {p_W, FromRollPitchYaw(0.05, 0.1, 0.3 * i)}, 1, 0.5});
  }
  return setup;
}

std::vector<Case> Piles() {
  const auto corners = [](const Film& film) {
    double deepest_m = 0;
    for (const auto& motions : film) {
      for (const Motion& motion : motions) {
        for (int corner = 0; corner < 8; ++corner) {
          const Vector3 p_B(corner & 1 ? 0.1 : -0.1, corner & 2 ? 0.1 : -0.1, corner & 4 ? 0.1 : -0.1);
          deepest_m = std::max(deepest_m, -(motion.p_W + motion.q_W * p_B).z());
        }
      }
    }
    return 1000 * deepest_m;
  };
  const auto overlaps = [](const Film& film) {
    double deepest_m = 0;
    for (const auto& motions : film) {
      for (std::size_t i = 0; i < motions.size(); ++i) {
        deepest_m = std::max(deepest_m, 0.1 - motions[i].p_W.z());
        for (std::size_t j = 0; j < i; ++j) {
          deepest_m = std::max(deepest_m, 0.2 - (motions[i].p_W - motions[j].p_W).norm());
        }
      }
    }
    return 1000 * deepest_m;
  };
  return {
      {"boxes", "100 boxes fall, 0.5 s", "mm into the floor", 0.01, 0.5, Pile(Box{{0.2, 0.2, 0.2}}), corners},
      {"balls", "100 balls fall, 0.5 s", "mm of overlap", 0.01, 0.5, Pile(Sphere{0.1}), overlaps}};
}

}  // namespace

std::vector<Case> Cases() {
  std::vector<Case> cases = {
      ChainEnergy("double_pendulum", "Double pendulum, 30 s", 2, 30),
      ChainPath("pendulum_path", "Double pendulum, path, 2 s", Chain(2), 2, {-0.706656620, 0, 1.725485135}),
      ChainEnergy("chain6", "Limp chain of 6 links, 30 s", 6, 30),
      ChainEnergy("chain12", "Limp chain of 12 links, 30 s", 12, 30),
      ChainPath("chain_path", "Limp chain of 12 links, path, 1 s", Chain(12), 1,
                {-1.800917512, 0, 1.675877006}),
      ChainEnergy("chain50", "Limp chain of 50 links, 10 s", 50, 10),
      ChainPath("damped_chain", "Damped chain of 50, path, 1 s", Chain(50, 0.02), 1,
                {-1.867090102, 0, 1.648074300}),
      TumblingBox(),
      TumblingRobot(),
      Gyroscope(),
      Thrown()};
  const auto add = [&](std::vector<Case> more) { cases.insert(cases.end(), more.begin(), more.end()); };
  add(Springs());
  cases.push_back(Arm());
  add(Slopes());
  cases.push_back(Skid());
  // Soft contacts settle in the first second.
  cases.push_back(
      Stack("stack", "Stack of 10 boxes, 10 s", "mm of drift", std::vector<double>(10, 1), 10, 100));
  cases.push_back(Stack("heavy", "1000 kg on 1 kg, 5 s", "mm of sink", {1, 1000}, 5, 0));
  cases.push_back(Wall());
  add(Piles());
  return cases;
}

}  // namespace coopdyn::frontier
